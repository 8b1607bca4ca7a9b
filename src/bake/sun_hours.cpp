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
#include <iterator>
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

/// What is held of a texel besides the light map's part: where it is asked, and the result.
constexpr std::uint64_t kTexel_bytes =
    sizeof(Receiver) + sizeof(SunHours) + sizeof(SunSensor) + sizeof(double);

/// Of a place on a page: its hours, those with neighbours' values, and where such come from.
constexpr std::uint64_t kPlace_bytes = 2 * sizeof(float) + sizeof(std::uint32_t);

/// Of a part's receivers while they are counted, and of triangles, whose places on the pages are
/// looked up by both sides. Trees of the scene take no more than the light map's own work on
/// triangles, which is done by then.
std::uint64_t other_bytes(const Scene& scene, const SunCalendar& calendar) {
    std::size_t most_words = 0;
    for (const DayGroup& group : calendar.groups)
        most_words = std::max(most_words, (group.to_sun_ws.size() + 63) / 64);
    return kReceiversPerPart * (most_words * sizeof(std::uint64_t) + sizeof(HourSums)) +
           2 * sizeof(std::uint32_t) * scene.triangle_count();
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

/// Whose materials all have two sides: the backs of others are not seen, and insides show backs.
Scene with_backs(const Scene& scene) {
    SceneData data = scene.data();
    for (Material& material : data.materials)
        material.double_sided = true;
    return Scene(std::move(data));
}

void leave_out_insides(const Scene& scene, SunHoursResult& result, Progress& progress) {
    std::vector<std::size_t> dark;
    std::vector<Vec3> places_ws;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        if (result.hours[i].mean_h > 0.0f) continue;
        dark.push_back(i);
        places_ws.emplace_back(result.points[i].position_ws);
    }
    const trace::Tracer tracer(with_backs(scene), result.options.ignore_alpha, progress);
    const float near_m = 1e-6f * (1.0f + scene.bounds().size().y);  // what it stands on is no roof
    const auto above = tracer.first_seen(places_ws, Vec3(0.0f, 1.0f, 0.0f), near_m, progress);
    for (std::size_t i = 0; i < dark.size(); ++i) {
        if (above[i].instance == trace::kNoReceiver) continue;
        const DVec3 front = trace::world_triangle(scene, above[i]).front_normal_ws();
        if (front.y > 0.0) result.weights[dark[i]] = 0.0;
    }
}

}  // namespace

SunHoursResult sun_hours(const Scene& scene, std::span<const SunSensor> sensors,
                         const SunHoursOptions& options, Progress& progress) {
    return hours_of_sensors(scene, SunPoints::sensors, sensors, options, progress);
}

SunHoursResult sun_hours(const Scene& scene, std::span<const SunGrid> grids,
                         const SunHoursOptions& options, Progress& progress) {
    std::vector<SunSensor> sensors;
    for (const SunGrid& grid : grids)
        std::ranges::copy(grid.sensors(), std::back_inserter(sensors));
    SunHoursResult result = hours_of_sensors(scene, SunPoints::grid, sensors, options, progress);
    result.grids.assign(grids.begin(), grids.end());
    leave_out_insides(scene, result, progress);
    return result;
}

SunHoursResult sun_hours(const Scene& scene, const SunGrid& grid, const SunHoursOptions& options,
                         Progress& progress) {
    return sun_hours(scene, std::span(&grid, 1), options, progress);
}

SunHoursResult sun_hours(const Scene& scene, double texel_size_m, const SunHoursOptions& options,
                         Progress& progress) {
    const bake::ThreadLimit limit(options.threads);
    SunHoursResult result = begin(scene, SunPoints::texels, options);
    const SunCalendar calendar = bake::make_calendar(options, progress);
    result.days = calendar.days;
    result.texel_size_m = texel_size_m;
    lightmap::Atlas atlas =
        lightmap::make_atlas(scene,
                             {.texel_size_m = texel_size_m,
                              .back_sides = options.back_sides,
                              .memory_limit_bytes = options.memory_limit_bytes,
                              .more_texel_bytes = kTexel_bytes,
                              .more_place_bytes = kPlace_bytes,
                              .more_bytes = other_bytes(scene, calendar) + options.more_bytes,
                              .texel_option = options.texel_option},
                             progress);
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
