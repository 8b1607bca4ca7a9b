#include "choice.h"

#include "visibility/light_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gnomon::automatic {

namespace {

/// A map whose texels are no larger than pixels, if it is seen whole; smaller ones save little.
int map_size_for(Extent size) {
    constexpr unsigned kLeast = 2048, kMost = 4096;
    return static_cast<int>(
        std::clamp(std::bit_ceil(std::max(size.width, size.height)), kLeast, kMost));
}

/// Within a split the farthest pixel is no more than so many times as large as the nearest.
constexpr double kPixelSpread = 2.0;
constexpr int kMostSplits = 6;

int splits_for(const Camera& camera, DepthRange seen) {
    if (camera.ortho_height_m > 0.0f || !(seen.far_m > seen.near_m)) return 1;
    const double needed = std::ceil(std::log(seen.far_m / seen.near_m) / std::log(kPixelSpread));
    return std::clamp(static_cast<int>(needed), 1, kMostSplits);
}

struct ForGpu {
    const Frame& frame;
    DepthRange seen;

    Choice operator()(const DirectionalLight& light) const {
        const int splits = splits_for(frame.camera, seen);
        const bool soft = light.angular_diameter_rad > 0.0f;
        return {"pssm",
                {{"splits", splits},
                 {"map_size", map_size_for(frame.size)},
                 {"filter", std::string(soft ? "pcss" : "box_3x3")}},
                fmt::format("receivers are {:.3g} to {:.3g} m away, and a split holds a factor of "
                            "{}; a texel is about a pixel at {}x{}; the sun is {}",
                            seen.near_m, seen.far_m, kPixelSpread, frame.size.width,
                            frame.size.height, soft ? "a disc" : "a point")};
    }
    Choice operator()(const PointLight&) const {
        return {"psm",
                {{"map_size", map_size_for(frame.size)}},
                "a cube of perspective maps has its texels where the picture has pixels"};
    }
    Choice operator()(const SphereLight&) const {
        return {"psm",
                {{"map_size", map_size_for(frame.size)}, {"filter", std::string("pcss")}},
                "a cube of perspective maps has its texels where the picture has pixels, and pcss "
                "the sphere's penumbra"};
    }
    Choice operator()(const SpotLight& light) const {
        if (light.outer_angle_rad > kWidestSpotRad) return traced("no map holds so wide a spot");
        return {
            "shadow_map", {{"map_size", map_size_for(frame.size)}}, "one map holds a spot's cone"};
    }
    template <typename AreaLight>
    Choice operator()(const AreaLight&) const {
        return traced("no map has the penumbra of a light with so much extent");
    }

    static Choice traced(const char* reason) { return {"ray_traced", {}, reason}; }
};

}  // namespace

Choice choose(const Frame& frame, DepthRange seen, bool software) {
    if (software) {
        return ForGpu::traced("the device is no GPU, and rays err least for what they cost there");
    }
    return std::visit(ForGpu{frame, seen}, frame.light);
}

std::string explanation(const Choice& choice) {
    std::string text = choice.technique;
    for (const auto& [name, value] : choice.params.values())
        text += fmt::format(", {} {}", name, to_string(value));
    return text + ": " + choice.reason;
}

}  // namespace gnomon::automatic
