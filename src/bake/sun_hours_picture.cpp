#include <gnomon/sun_hours.h>

#include "bake/legend.h"
#include "bake/sun_hours_map.h"
#include "bake/thread_limit.h"
#include "base/parallel.h"
#include "trace/pixel_rays.h"
#include "trace/tracer.h"

#include <fmt/chrono.h>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon {

namespace {

using trace::Receiver;

/// Samples along each side of a pixel.
constexpr unsigned kSamples = 2;
constexpr std::size_t kRowsPerTask = 8;

constexpr Vec3 kSky(0.93f);
constexpr Vec3 kEdge(0.45f);          ///< what edges of surfaces are multiplied with
constexpr float kEdgeCosine = 0.85f;  ///< between normals, of an edge
constexpr float kDiscRadius_px = 5.0f;
constexpr float kDiscRim_px = 1.0f;

/// The whole hour that colours end at.
int greatest_hour(const SunHoursResult& result) {
    return std::max(1, static_cast<int>(std::ceil(result.days.possible_h - 1e-3)));
}

Vec3 grey(Vec3 normal_ws) {
    const Vec3 from = normalize(Vec3(0.4f, 0.8f, 0.5f));
    return Vec3(0.62f + 0.22f * glm::dot(normal_ws, from));
}

/// Paints the samples of a picture.
class Painter {
public:
    Painter(const Scene& scene, const SunHoursResult& result, const Camera& camera, Extent size)
        : scene_(scene),
          result_(result),
          camera_(camera),
          size_(size),
          rays_(camera, size),
          greatest_h_(greatest_hour(result)) {}

    Image paint(std::span<const Receiver> receivers, Progress& progress) const {
        Image image(size_, 3);
        parallel_for(
            size_.height, kRowsPerTask,
            [&](std::size_t first, std::size_t last) {
                for (std::size_t y = first; y < last; ++y) {
                    for (unsigned x = 0; x < size_.width; ++x) {
                        const Vec3 color = color_at(receivers, x, static_cast<unsigned>(y));
                        for (int channel = 0; channel < 3; ++channel)
                            image.at(x, static_cast<unsigned>(y), channel) = color[channel];
                    }
                }
            },
            "painting hours of sun", &progress);
        if (result_.kind == SunPoints::sensors) draw_discs(image, receivers);
        return image;
    }

private:
    Vec3 color_of(float hours) const { return bake::false_color(double{hours} / greatest_h_); }

    Vec3 color_at(std::span<const Receiver> receivers, unsigned x, unsigned y) const {
        const std::size_t i = std::size_t{y} * size_.width + x;
        const Receiver& seen = receivers[i];
        if (result_.kind == SunPoints::grid) {
            const float hours = grid_hours(seen, x, y);
            if (hours >= 0.0f) return color_of(hours);
        }
        if (!seen.exists()) return kSky;
        Vec3 color = grey(seen.normal_ws);
        if (result_.kind == SunPoints::texels) {
            const float hours = result_.map->hours_at(scene_, seen);
            if (hours >= 0.0f) color = color_of(hours);
        }
        const bool edge = (x > 0 && is_edge(seen, receivers[i - 1])) ||
                          (y > 0 && is_edge(seen, receivers[i - size_.width]));
        return edge ? kEdge * color : color;
    }

    static bool is_edge(const Receiver& a, const Receiver& b) {
        return !b.exists() || glm::dot(a.normal_ws, b.normal_ws) < kEdgeCosine;
    }

    /// Of the nearest grid's square that is before the surface; in a parallel picture of any, as
    /// plans cut the scene at the grid's height. Else -1.
    float grid_hours(const Receiver& seen, unsigned x, unsigned y) const {
        const auto [origin, direction] = rays_(x + 0.5, y + 0.5);
        const bool plan = camera_.ortho_height_m > 0.0f;
        double nearest = std::numeric_limits<double>::infinity();
        if (!plan && seen.exists())
            nearest = glm::dot(DVec3(seen.position_ws) - origin, direction) /
                      glm::dot(direction, direction);
        float hours = bake::kNoSurface_h;
        std::size_t first_point = 0;
        for (const SunGrid& grid : result_.grids) {
            const double t = glm::dot(grid.first_ws - origin, grid.normal_ws) /
                             glm::dot(direction, grid.normal_ws);
            if (t > 0.0 && t <= nearest && std::isfinite(t)) {
                const float there = square_hours(grid, first_point, origin + t * direction);
                if (there >= 0.0f) {
                    hours = there;
                    nearest = t;
                }
            }
            first_point += std::size_t{grid.size.width} * grid.size.height;
        }
        return hours;
    }

    /// At a point of the grid's plane.
    float square_hours(const SunGrid& grid, std::size_t first_point, DVec3 point_ws) const {
        const DVec3 from_first = (point_ws - grid.first_ws) / grid.spacing_m;
        const double column = glm::dot(from_first, grid.right_ws) + 0.5;
        const double row = glm::dot(from_first, grid.down_ws) + 0.5;
        if (column < 0.0 || row < 0.0 || column >= grid.size.width || row >= grid.size.height)
            return bake::kNoSurface_h;
        const std::size_t point = first_point + static_cast<std::size_t>(row) * grid.size.width +
                                  static_cast<std::size_t>(column);
        return result_.weights[point] > 0.0 ? result_.hours[point].mean_h : bake::kNoSurface_h;
    }

    void draw_discs(Image& image, std::span<const Receiver> receivers) const {
        const glm::dmat4 clip_from_world = glm::dmat4(camera_.clip_from_world(size_));
        for (std::size_t i = 0; i < result_.points.size(); ++i) {
            const DVec3 position = result_.points[i].position_ws;
            const glm::dvec4 clip = clip_from_world * glm::dvec4(position, 1.0);
            if (!(clip.w > 0.0)) continue;
            const double x = (0.5 + 0.5 * clip.x / clip.w) * size_.width;
            const double y = (0.5 + 0.5 * clip.y / clip.w) * size_.height;
            if (!(x >= 0.0 && y >= 0.0 && x < size_.width && y < size_.height)) continue;
            const Receiver& seen =
                receivers[static_cast<std::size_t>(y) * size_.width + static_cast<std::size_t>(x)];
            if (!hidden(position, seen)) draw_disc(image, x, y, color_of(result_.hours[i].mean_h));
        }
    }

    /// By more than what a point on a surface, seen at a slant, can seem to be behind it.
    bool hidden(DVec3 position, const Receiver& seen) const {
        constexpr double kSlack = 0.01;  // of the distance
        if (!seen.exists() || camera_.ortho_height_m > 0.0f) return false;
        const DVec3 eye(camera_.eye_ws());
        return glm::distance(eye, DVec3(seen.position_ws)) <
               (1.0 - kSlack) * glm::distance(eye, position);
    }

    void draw_disc(Image& image, double x, double y, Vec3 color) const {
        const float rim = kSamples * kDiscRadius_px, radius = rim - kSamples * kDiscRim_px;
        for (int j = -static_cast<int>(rim); j <= static_cast<int>(rim); ++j) {
            for (int i = -static_cast<int>(rim); i <= static_cast<int>(rim); ++i) {
                const float distance = std::hypot(static_cast<float>(i), static_cast<float>(j));
                if (distance > rim) continue;
                bake::fill_rectangle(image, static_cast<int>(x) + i, static_cast<int>(y) + j, 1, 1,
                                     distance > radius ? Vec3(1.0f) : color);
            }
        }
    }

    const Scene& scene_;
    const SunHoursResult& result_;
    const Camera& camera_;
    Extent size_;
    trace::PixelRays rays_;
    int greatest_h_;
};

Image averaged(const Image& samples, Extent size) {
    constexpr float kWeight = 1.0f / (kSamples * kSamples);
    Image image(size, 3);
    for (unsigned y = 0; y < samples.height(); ++y) {
        for (unsigned x = 0; x < samples.width(); ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                image.at(x / kSamples, y / kSamples, channel) +=
                    kWeight * samples.at(x, y, channel);
            }
        }
    }
    return image;
}

std::string title_of(const SunHoursResult& result) {
    const SunHoursOptions& options = result.options;
    const auto date = [](std::chrono::year_month_day day) {
        return fmt::format("{:%F}", std::chrono::sys_days(day));
    };
    if (options.from == options.to) return "hours of sun\n" + date(options.from);
    return fmt::format("hours a day\n{}\nto {}", date(options.from), date(options.to));
}

}  // namespace

Camera top_camera(const Scene& scene, Extent size) {
    constexpr float kMargin = 1.04f;  // around the scene
    const Box3 bounds = scene.bounds().empty() ? Box3{Vec3(-1.0f), Vec3(1.0f)} : scene.bounds();
    const Vec3 sides = bounds.size();
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    const float reach_m = std::max({sides.x / aspect, sides.z, 1e-3f});
    const float clear_m = 0.1f * (sides.y + reach_m);  // between the scene and the camera
    const Vec3 target = bounds.center();
    Camera camera = look_at(Vec3(target.x, bounds.max.y + clear_m, target.z), target);
    camera.name = "top";
    camera.ortho_height_m = kMargin * reach_m;
    camera.near_m = 0.5f * clear_m;
    camera.ortho_depth_m = sides.y + 2.0f * clear_m;
    return camera;
}

std::uint64_t sun_hours_picture_bytes(Extent size) {
    constexpr std::uint64_t kColor_bytes = 3 * sizeof(float);
    constexpr std::uint64_t kSample_bytes =
        sizeof(trace::SurfaceId) + sizeof(Receiver) + kColor_bytes;
    return std::uint64_t{size.width} * size.height *
           (kSamples * kSamples * kSample_bytes + kColor_bytes);
}

Image sun_hours_picture(const Scene& scene, const SunHoursResult& result, const Camera& camera,
                        Extent size, Progress& progress) {
    const bake::ThreadLimit limit(result.options.threads);
    const Extent samples{kSamples * size.width, kSamples * size.height};
    const trace::Tracer tracer(scene, result.options.ignore_alpha, progress);
    const std::vector<trace::SurfaceId> surfaces =
        tracer.visible_surfaces(camera, samples, progress);
    const std::vector<Receiver> receivers = tracer.receivers(camera, samples, surfaces);
    const Image painted = Painter(scene, result, camera, samples).paint(receivers, progress);
    return bake::with_legend(averaged(painted, size), title_of(result), greatest_hour(result));
}

}  // namespace gnomon
