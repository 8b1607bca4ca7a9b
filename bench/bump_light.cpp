// Averaged light beside what it stands for: a paved square with a bump map, seen from above, under
// two lamps with a box between them.
//
//     bump_light [FILE]
//
// FILE (bump_light.png) gets three panels: all lamps at each pixel, with their own directions and
// traced shadows; the colours of vertices, a tenth of a metre apart, interpolated; and these times
// the bump factor of the vertices' averaged directions. The RMSE of the last two to the first is
// told, of sRGB values.

#include <gnomon/image.h>
#include <gnomon/scene.h>
#include <gnomon/vertex_lighting.h>

#include "bench_main.h"
#include "raster/small_scene_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

namespace gnomon {
namespace {

constexpr float kHalf_m = 1.6f;  ///< of the square's side
constexpr float kBox_m = 0.25f;  ///< half of the box's side, between two vertices
constexpr float kBoxHeight_m = 0.4f;
constexpr unsigned kPanel_px = 320;
constexpr unsigned kVertices = 33;  ///< along each side
constexpr Vec3 kUp{0, 1, 0};
constexpr float kExposure = 0.6f;
/// Of a lamp a metre away: the upward bias is a tenth of that.
constexpr float kFullLuminance = 1.0f;

// Bricks in running bond, with bevels.
constexpr Vec2 kBrick_m{0.4f, 0.2f};
constexpr float kBevel_m = 0.025f;
constexpr float kSlope = 0.8f;

const PointLight kLamps[] = {{.position_ws = {-1.2f, 0.8f, -0.3f}, .intensity = {1.3f, 0.9f, 0.5f}},
                             {.position_ws = {1.0f, 0.6f, 0.9f}, .intensity = {0.3f, 0.5f, 0.9f}}};

Scene square_with_box() {
    const float side = 2.0f * kBox_m;
    const Vec3 low(-kBox_m, 0.0f, kBox_m);
    const Vec3 high(kBox_m, 0.0f, -kBox_m);
    const Vec3 up(0.0f, kBoxHeight_m, 0.0f);
    return Scene(raster::scene_data(
        {raster::quad({-kHalf_m, 0, kHalf_m}, {2 * kHalf_m, 0, 0}, {0, 0, -2 * kHalf_m}),
         raster::quad(low + up, {side, 0, 0}, {0, 0, -side}), raster::quad(low, {side, 0, 0}, up),
         raster::quad(high, {-side, 0, 0}, up), raster::quad(low, up, {0, 0, -side}),
         raster::quad(high, up, {0, 0, side})}));
}

/// Points of the ground in rows, the first at z = -kHalf_m; `inset`: 0 at its border, or 0.5.
std::vector<SurfacePoint> ground_points(unsigned count, float inset) {
    std::vector<SurfacePoint> points;
    const float step_m = 2.0f * kHalf_m / (static_cast<float>(count) - 1.0f + 2.0f * inset);
    for (unsigned y = 0; y < count; ++y) {
        for (unsigned x = 0; x < count; ++x) {
            const float x_m = (static_cast<float>(x) + inset) * step_m - kHalf_m;
            const float z_m = (static_cast<float>(y) + inset) * step_m - kHalf_m;
            points.push_back({{x_m, 0.0f, z_m}, kUp});
        }
    }
    return points;
}

using Lights = std::vector<StrongVertexLight>;

/// The lamps as each point sees them.
std::vector<Lights> lights_at(const Scene& scene, const std::vector<SurfacePoint>& points) {
    Progress silent;
    const std::vector<Light> lamps(std::begin(kLamps), std::end(kLamps));
    const auto traced = trace_vertex_lights(scene, points, lamps, 1, silent);
    std::vector<Lights> lights(points.size());
    for (std::size_t l = 0; l < lamps.size(); ++l) {
        for (std::size_t i = 0; i < points.size(); ++i)
            lights[i].push_back({traced[l][i], light_strength(lamps[l])});
    }
    return lights;
}

/// The bump map's normal in tangent space, whose axes are the world's x, z and y.
Vec3 bump_ts(Vec3 p_ws) {
    const float row = std::floor(p_ws.z / kBrick_m.y);
    const float shift_m = 0.5f * kBrick_m.x * std::abs(std::fmod(row, 2.0f));
    const Vec2 place(p_ws.x + shift_m, p_ws.z);
    const Vec2 from_middle = place - (glm::floor(place / kBrick_m) + 0.5f) * kBrick_m;
    const auto slope = [](float from_middle_m, float side_m) {
        const float over_m = std::abs(from_middle_m) - (0.5f * side_m - kBevel_m);
        return over_m > 0.0f ? std::copysign(kSlope, from_middle_m) : 0.0f;
    };
    return normalize(
        Vec3(slope(from_middle.x, kBrick_m.x), slope(from_middle.y, kBrick_m.y), 1.0f));
}

/// Bilinear, of a value at each vertex.
Vec3 between_vertices(const std::vector<Vec3>& values, Vec3 p_ws) {
    const Vec2 place = (Vec2(p_ws.x, p_ws.z) / (2.0f * kHalf_m) + 0.5f) * float(kVertices - 1);
    const Vec2 first = glm::min(glm::floor(place), Vec2(float(kVertices - 2)));
    const Vec2 f = place - first;
    const std::size_t at =
        static_cast<std::size_t>(first.y) * kVertices + static_cast<std::size_t>(first.x);
    return glm::mix(glm::mix(values[at], values[at + 1], f.x),
                    glm::mix(values[at + kVertices], values[at + kVertices + 1], f.x), f.y);
}

/// Puts a pixel's irradiance into a panel.
void put(Image& picture, unsigned panel, std::size_t pixel, Vec3 irradiance) {
    const auto x = static_cast<unsigned>(pixel % kPanel_px);
    const auto y = static_cast<unsigned>(pixel / kPanel_px);
    for (int channel = 0; channel < 3; ++channel) {
        picture.at(panel * kPanel_px + x, y, channel) =
            srgb_from_linear(std::clamp(kExposure * irradiance[channel], 0.0f, 1.0f));
    }
}

double rmse_to_first(const Image& picture, unsigned panel) {
    double sum = 0.0;
    for (unsigned y = 0; y < kPanel_px; ++y) {
        for (unsigned x = 0; x < kPanel_px; ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                const auto d = static_cast<double>(picture.at(panel * kPanel_px + x, y, channel) -
                                                   picture.at(x, y, channel));
                sum += d * d;
            }
        }
    }
    return std::sqrt(sum / (3.0 * kPanel_px * kPanel_px));
}

int run(int argc, char** argv) {
    const std::filesystem::path file = argc > 1 ? argv[1] : "bump_light.png";
    constexpr TangentFrame kFrame{
        .tangent_ws = {1, 0, 0}, .bitangent_ws = {0, 0, 1}, .normal_ws = kUp};
    const Scene scene = square_with_box();
    std::vector<Vec3> colours, averages_ts;
    for (const Lights& lights : lights_at(scene, ground_points(kVertices, 0.0f))) {
        colours.push_back(vertex_irradiance(lights, kUp));
        averages_ts.push_back(averaged_light_ts(lights, kFrame, kFullLuminance));
    }
    const std::vector<SurfacePoint> pixels = ground_points(kPanel_px, 0.5f);
    const std::vector<Lights> seen = lights_at(scene, pixels);
    Image picture({3 * kPanel_px, kPanel_px}, 3);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Vec3 p_ws = pixels[i].position_ws;
        if (std::max(std::abs(p_ws.x), std::abs(p_ws.z)) <= kBox_m) continue;  // the box is black
        const Vec3 bump = bump_ts(p_ws);
        const Vec3 colour = between_vertices(colours, p_ws);
        const Vec3 average_ts = normalize(between_vertices(averages_ts, p_ws));
        put(picture, 0, i, vertex_irradiance(seen[i], Vec3(bump.x, bump.z, bump.y)));
        put(picture, 1, i, colour);
        put(picture, 2, i, colour * bump_factor(average_ts, bump));
    }
    write_png(file, picture);
    fmt::print("RMSE: vertices {:.3f}, with averaged light {:.3f}\n", rmse_to_first(picture, 1),
               rmse_to_first(picture, 2));
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
