#include <gnomon/sun_hours.h>

#include "bake/sun_days.h"
#include "bake/sun_hours_map.h"
#include "bake/texel_receivers.h"
#include "bake/thread_limit.h"
#include "base/check.h"
#include "base/parallel.h"
#include "base/part_progress.h"
#include "interval/bake.h"
#include "lightmap/surface.h"
#include "trace/tracer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon {

namespace {

using bake::DayGroup;
using bake::HourSums;
using bake::SunCalendar;
using trace::Receiver;

/// Receivers whose masks are held at a time: at most 128 MiB.
constexpr std::size_t kReceiversPerPart = std::size_t{1} << 18;
constexpr std::size_t kReceiversPerTask = std::size_t{1} << 12;

std::vector<SunHours> count(const Scene& scene, std::span<const Receiver> receivers,
                            const SunCalendar& calendar, bool ignore_alpha, Progress& progress) {
    const interval::Frame frame = interval::frame_around(calendar.pole_ws);
    const interval::Tree tree(scene, frame, ignore_alpha, progress);
    std::vector<SunHours> hours(receivers.size());
    const std::size_t chunks = (receivers.size() + kReceiversPerPart - 1) / kReceiversPerPart;
    const std::size_t parts = chunks * calendar.groups.size();
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        const std::size_t first = chunk * kReceiversPerPart;
        const auto here =
            receivers.subspan(first, std::min(kReceiversPerPart, receivers.size() - first));
        std::vector<HourSums> sums(here.size());
        for (std::size_t g = 0; g < calendar.groups.size(); ++g) {
            const DayGroup& group = calendar.groups[g];
            const auto all = static_cast<double>(parts);
            const auto before = static_cast<double>(chunk * calendar.groups.size() + g);
            PartProgress part(progress, "counting hours of sun", before / all, 1.0 / all);
            interval::DayMasks masks;
            if (!group.to_sun_ws.empty()) {
                masks = interval::bake(tree, interval::DayPath(group.to_sun_ws, frame), here, part,
                                       interval::kChooseTile);
            }
            parallel_for(here.size(), kReceiversPerTask, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    sums[i].add(group, masks.steps > 0 ? masks.mask(i) : interval::Mask());
                }
            });
        }
        for (std::size_t i = 0; i < here.size(); ++i)
            hours[first + i] = sums[i].of_days(calendar.days.sampled);
    }
    return hours;
}

std::vector<Receiver> receivers_at(std::span<const SunSensor> sensors) {
    std::vector<Receiver> receivers;
    receivers.reserve(sensors.size());
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        const SunSensor& sensor = sensors[i];
        const double length = glm::length(sensor.normal_ws);
        const double finite = length + glm::dot(sensor.position_ws, DVec3(1.0));
        if (!std::isfinite(finite) || !(length > 0.0)) {
            fail_input(
                "point {}: ({}, {}, {}), facing ({}, {}, {}); it must be finite and face "
                "somewhere",
                i + 1, sensor.position_ws.x, sensor.position_ws.y, sensor.position_ws.z,
                sensor.normal_ws.x, sensor.normal_ws.y, sensor.normal_ws.z);
        }
        receivers.push_back(
            {Vec3(sensor.position_ws), Vec3(sensor.normal_ws / length), {trace::kNoSurface, 0}});
    }
    return receivers;
}

SunHoursResult begin(const Scene& scene, SunPoints kind, const SunHoursOptions& options) {
    SunHoursResult result;
    result.scene = scene.source();
    result.options = options;
    result.kind = kind;
    return result;
}

SunHoursResult hours_of_sensors(const Scene& scene, SunPoints kind,
                                std::span<const SunSensor> sensors, const SunHoursOptions& options,
                                Progress& progress) {
    const bake::ThreadLimit limit(options.threads);
    SunHoursResult result = begin(scene, kind, options);
    const std::vector<Receiver> receivers = receivers_at(sensors);
    const SunCalendar calendar = bake::make_calendar(options, progress);
    result.days = calendar.days;
    result.points.assign(sensors.begin(), sensors.end());
    result.weights.assign(sensors.size(), 1.0);
    result.hours = count(scene, receivers, calendar, options.ignore_alpha, progress);
    return result;
}

/// Looks straight up from a grid's points, one a pixel; its rows are the grid's from the last to
/// the first.
Camera camera_below(const Scene& scene, const SunGrid& grid) {
    const float height_m = static_cast<float>(grid.spacing_m * grid.size.height);
    const DVec3 center =
        grid.first_ws +
        0.5 * grid.spacing_m * DVec3(grid.size.width - 1.0, 0.0, grid.size.height - 1.0);
    Camera camera;
    camera.view_from_world = glm::mat4(1.0f);
    // Rows: right = +X, up = +Z, backwards = -Y.
    camera.view_from_world[0] = Vec4(1, 0, 0, 0);
    camera.view_from_world[1] = Vec4(0, 0, -1, 0);
    camera.view_from_world[2] = Vec4(0, 1, 0, 0);
    const Vec3 eye(center);
    camera.view_from_world[3] = Vec4(-eye.x, -eye.z, eye.y, 1);
    const float rise_m = std::max(0.0f, scene.bounds().max.y - eye.y);
    camera.near_m = 1e-6f * (1.0f + rise_m);
    camera.ortho_height_m = height_m;
    camera.ortho_depth_m = 1.0f + 2.0f * rise_m;
    return camera;
}

/// Whose materials all have two sides: the backs of others are not seen, and insides show backs.
Scene with_backs(const Scene& scene) {
    SceneData data = scene.data();
    for (Material& material : data.materials)
        material.double_sided = true;
    return Scene(std::move(data));
}

void leave_out_insides(const Scene& scene, const SunGrid& grid, SunHoursResult& result,
                       Progress& progress) {
    const trace::Tracer tracer(with_backs(scene), result.options.ignore_alpha, progress);
    const auto seen = tracer.visible_surfaces(camera_below(scene, grid), grid.size, progress);
    for (unsigned row = 0; row < grid.size.height; ++row) {
        for (unsigned column = 0; column < grid.size.width; ++column) {
            const trace::SurfaceId above =
                seen[std::size_t{grid.size.height - 1 - row} * grid.size.width + column];
            const std::size_t point = std::size_t{row} * grid.size.width + column;
            if (above.instance == trace::kNoReceiver || result.hours[point].mean_h > 0.0f) continue;
            const DVec3 front = trace::world_triangle(scene, above).front_normal_ws();
            if (front.y > 0.0) result.weights[point] = 0.0;
        }
    }
}

}  // namespace

SunHoursResult sun_hours(const Scene& scene, std::span<const SunSensor> sensors,
                         const SunHoursOptions& options, Progress& progress) {
    return hours_of_sensors(scene, SunPoints::sensors, sensors, options, progress);
}

SunHoursResult sun_hours(const Scene& scene, const SunGrid& grid, const SunHoursOptions& options,
                         Progress& progress) {
    SunHoursResult result =
        hours_of_sensors(scene, SunPoints::grid, grid.sensors(), options, progress);
    result.grid = grid;
    leave_out_insides(scene, grid, result, progress);
    return result;
}

SunHoursResult sun_hours(const Scene& scene, double texel_size_m, const SunHoursOptions& options,
                         Progress& progress) {
    const bake::ThreadLimit limit(options.threads);
    SunHoursResult result = begin(scene, SunPoints::texels, options);
    const SunCalendar calendar = bake::make_calendar(options, progress);
    result.days = calendar.days;
    result.texel_size_m = texel_size_m;
    lightmap::Atlas atlas = lightmap::make_atlas(
        scene, {.texel_size_m = texel_size_m, .back_sides = options.back_sides}, progress);
    const lightmap::Texels texels = lightmap::make_texels(scene, atlas, progress);
    const std::vector<Receiver> receivers = bake::texel_receivers(atlas, texels);
    result.hours = count(scene, receivers, calendar, options.ignore_alpha, progress);
    result.points.reserve(receivers.size());
    for (const Receiver& receiver : receivers)
        result.points.push_back({DVec3(receiver.position_ws), DVec3(receiver.normal_ws)});
    result.weights = bake::texel_areas_m2(scene, atlas, texels);
    result.map = std::make_shared<const SunHoursMap>(
        bake::make_map(scene, std::move(atlas), texels, result.hours));
    return result;
}

double choose_texel_size_m(const Scene& scene) {
    constexpr double kTexels = 400'000.0;  // seconds of work, and a picture's pixels
    double area_m2 = 0.0;
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i)
        area_m2 += lightmap::Surface(scene, i, true).area_m2();
    if (!(area_m2 > 0.0)) {
        fail_input("sun hours: the scene \"{}\" has no triangles with an area", scene.source());
    }
    const double wanted_m = std::sqrt(area_m2 / kTexels);
    const double power_m = std::pow(10.0, std::floor(std::log10(wanted_m)));
    const double digit = wanted_m / power_m;
    return power_m * (digit <= 1.0 ? 1.0 : digit <= 2.0 ? 2.0 : digit <= 5.0 ? 5.0 : 10.0);
}

std::vector<Image> sun_hours_pages(const SunHoursResult& result) {
    return result.map ? result.map->pages_h : std::vector<Image>();
}

}  // namespace gnomon
