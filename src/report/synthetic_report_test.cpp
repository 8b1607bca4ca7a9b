#include "report/synthetic_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace gnomon::report {
namespace {

struct Ball {
    Vec3 center;
    float radius;
    Vec3 color;
};

struct Hit {
    bool any = false;
    Vec3 position{0.0f}, normal{0.0f, 1.0f, 0.0f}, color{0.0f};
};

const std::array<Ball, 7> kBalls = {{{{-2.2f, 1.0f, 0.0f}, 1.0f, {0.75f, 0.25f, 0.18f}},
                                     {{0.4f, 0.7f, -1.2f}, 0.7f, {0.2f, 0.45f, 0.7f}},
                                     {{2.0f, 1.3f, 0.6f}, 1.3f, {0.85f, 0.7f, 0.35f}},
                                     {{-0.3f, 0.35f, 1.6f}, 0.35f, {0.3f, 0.6f, 0.35f}},
                                     {{-4.6f, 0.6f, -2.5f}, 0.6f, {0.6f, 0.5f, 0.7f}},
                                     {{4.4f, 0.5f, -2.2f}, 0.5f, {0.8f, 0.8f, 0.8f}},
                                     {{0.2f, 2.6f, -0.2f}, 0.3f, {0.9f, 0.55f, 0.2f}}}};
const Vec3 kEye_ws(0.0f, 3.2f, 9.0f);
const Vec3 kToSun_ws = normalize(Vec3(0.7f, 0.75f, 0.35f));
const Vec3 kLamp_ws(-0.6f, 4.5f, 2.0f);
constexpr float kLightRadius = 0.12f;  // of the sun's disc and the lamp, at distance 1

/// Distance to the ball along the unit vector, or a negative one.
float distance_to(const Ball& ball, Vec3 origin, Vec3 direction) {
    const Vec3 offset = origin - ball.center;
    const float b = glm::dot(offset, direction);
    const float root = b * b - glm::dot(offset, offset) + ball.radius * ball.radius;
    return root < 0.0f ? -1.0f : -b - std::sqrt(root);
}

Hit hit_scene(Vec3 direction) {
    constexpr float kHorizon = 40.0f;
    Hit hit;
    float nearest = direction.y < 0.0f ? -kEye_ws.y / direction.y : kHorizon;
    if (nearest < kHorizon) {
        hit.any = true;
        hit.position = kEye_ws + nearest * direction;
        const int tile = static_cast<int>(std::floor(hit.position.x) + std::floor(hit.position.z));
        hit.color = Vec3((tile & 1) != 0 ? 0.62f : 0.5f);
    }
    for (const Ball& ball : kBalls) {
        const float distance = distance_to(ball, kEye_ws, direction);
        if (distance <= 0.0f || distance >= nearest) continue;
        nearest = distance;
        const Vec3 position = kEye_ws + distance * direction;
        hit = {true, position, (position - ball.center) / ball.radius, ball.color};
    }
    return hit;
}

bool sees(Vec3 from, Vec3 to_light, float reach) {
    constexpr float kOff = 1e-3f;  // a ball must not shadow the point of it that is asked for
    return std::none_of(kBalls.begin(), kBalls.end(), [&](const Ball& ball) {
        const float distance = distance_to(ball, from + kOff * to_light, to_light);
        return distance > 0.0f && distance < reach;
    });
}

struct Lamp {
    bool directional = true;
    Vec3 to_light(Vec3 from) const { return directional ? kToSun_ws : normalize(kLamp_ws - from); }
    float reach(Vec3 from) const { return directional ? 1e9f : glm::length(kLamp_ws - from); }
};

/// Share of `count` rays, spiralling over the light and turned by `turn`, that arrive.
float visible(const Hit& hit, const Lamp& lamp, int count, float turn) {
    constexpr float kGoldenAngle = 2.39996323f;
    const Vec3 to_light = lamp.to_light(hit.position);
    const Vec3 side = normalize(glm::cross(to_light, Vec3(0.0f, 0.0f, 1.0f)));
    const Vec3 up = glm::cross(side, to_light);
    int seen = 0;
    for (int i = 0; i < count; ++i) {
        const float radius =
            count == 1 ? 0.0f
                       : kLightRadius * std::sqrt((static_cast<float>(i) + 0.5f) / float(count));
        const float angle = turn + kGoldenAngle * static_cast<float>(i);
        const Vec3 ray = to_light + radius * (std::cos(angle) * side + std::sin(angle) * up);
        seen += sees(hit.position, normalize(ray), lamp.reach(hit.position)) ? 1 : 0;
    }
    return static_cast<float>(seen) / static_cast<float>(count);
}

/// As a coarse, biased shadow map would: the point moved to its texel's centre, and off the ground.
float coarse(Hit hit, const Lamp& lamp) {
    constexpr float kTexel = 0.11f, kBias = 0.16f;
    hit.position.x = (std::floor(hit.position.x / kTexel) + 0.5f) * kTexel;
    hit.position.z = (std::floor(hit.position.z / kTexel) + 0.5f) * kTexel;
    hit.position += kBias * hit.normal;
    return visible(hit, lamp, 1, 0.0f);
}

using Shader = std::function<float(const Hit&, unsigned x, unsigned y)>;

Vec3 ray_of(Extent size, unsigned x, unsigned y) {
    constexpr float kPixels = 0.72f;  // tangent of half the height's angle
    const auto height = static_cast<float>(size.height);
    const float u = (2.0f * (static_cast<float>(x) + 0.5f) - static_cast<float>(size.width));
    const float v = (height - 2.0f * (static_cast<float>(y) + 0.5f));
    return normalize(Vec3(kPixels * u / height, kPixels * v / height - 0.28f, -1.6f));
}

/// Fills the visibility, the picture and the mask that `shader` leads to.
void draw(Extent size, const Lamp& lamp, const Shader& shader, Image& visibility, Image& picture,
          Image& facing) {
    visibility = Image(size, 1, 1.0f);
    picture = Image(size, 3);
    facing = Image(size, 1);
    for (unsigned y = 0; y < size.height; ++y) {
        for (unsigned x = 0; x < size.width; ++x) {
            const Hit hit = hit_scene(ray_of(size, x, y));
            const float cosine = glm::dot(hit.normal, lamp.to_light(hit.position));
            if (hit.any) visibility.at(x, y) = cosine > 0.0f ? shader(hit, x, y) : 0.0f;
            facing.at(x, y) = hit.any && cosine > 0.0f ? 1.0f : 0.0f;
            const float light = 0.12f + std::max(cosine, 0.0f) * visibility.at(x, y);
            for (int i = 0; i < 3; ++i) {
                const float value = hit.any ? hit.color[i] * light : 0.03f;
                picture.at(x, y, i) = srgb_from_linear(std::min(value, 1.0f));
            }
        }
    }
}

/// MAE, RMSE and false pixels; stray and artefact are made up from them.
Comparison errors(const Image& visibility, const Image& truth, const Image& facing,
                  double artefact_share) {
    Comparison error;
    for (std::size_t i = 0; i < truth.pixels().size(); ++i) {
        if (!(facing.pixels()[i] > 0.0f)) continue;
        const double v = visibility.pixels()[i], t = truth.pixels()[i];
        ++error.pixels;
        error.mae += std::abs(v - t);
        error.rmse += (v - t) * (v - t);
        error.false_lit += t < 0.1 && v > 0.5 ? 1.0 : 0.0;
        error.false_shadow += t > 0.9 && v < 0.5 ? 1.0 : 0.0;
    }
    const double share = 1.0 / static_cast<double>(std::max<std::uint64_t>(error.pixels, 1));
    error.mae *= share;
    error.rmse = std::sqrt(error.rmse * share);
    error.false_lit *= share;
    error.false_shadow *= share;
    error.stray_lit = 0.5 * error.false_lit;
    error.artefact_lit = artefact_share * error.false_lit;
    return error;
}

struct Made {
    std::string name, title;
    std::map<std::string, ParamValue> parameters;
    std::vector<PassTime> passes;
    double total_ms, artefact_share;
    std::uint64_t memory_bytes;
    std::function<float(const Hit&, const Lamp&, unsigned, unsigned)> shade;
};

std::vector<Made> techniques_made() {
    const auto hash = [](unsigned x, unsigned y) {
        return static_cast<float>((x * 1973u + y * 9277u + x * y * 26699u) % 6283u) * 1e-3f;
    };
    return {
        {"local_illumination",
         "Local illumination",
         {},
         {{"facing", 0.42}},
         0.61,
         0.4,
         0,
         [](const Hit&, const Lamp&, unsigned, unsigned) { return 1.0f; }},
        {"ray_traced",
         "Ray traced",
         {{"samples", 16}, {"seed", 1}},
         {},
         412.7,
         0.0,
         0,
         [=](const Hit& hit, const Lamp& lamp, unsigned x, unsigned y) {
             return visible(hit, lamp, 8, hash(x, y));
         }},
        {"shadow_map",
         "Shadow map",
         {{"map_size", 2048},
          {"filter", std::string("box_4x4")},
          {"slope_bias", 1.5},
          {"normal_offset", 0.6},
          {"constant_bias", 0.0},
          {"stabilize", true}},
         {{"draw casters", 6.81}, {"look up", 3.37}},
         11.9,
         0.04,
         std::uint64_t{16} << 20,
         [](const Hit& hit, const Lamp& lamp, unsigned, unsigned) { return coarse(hit, lamp); }},
        {"shadow_volumes",
         "Shadow volumes",
         {{"z_fail", true}},
         {{"silhouettes", 1.9}, {"depth", 2.7}, {"volumes", 21.4}, {"resolve", 0.8}},
         29.5,
         0.0,
         31457280,
         [](const Hit& hit, const Lamp& lamp, unsigned, unsigned) {
             return visible(hit, lamp, 1, 0.0f);
         }}};
}

TechniqueResult made_result(const Made& made, const TruthResult& truth, const Lamp& lamp,
                            Extent size) {
    TechniqueResult result;
    result.technique = made.name;
    result.title = made.title;
    result.light = truth.light;
    result.light_kind = truth.light_kind;
    result.parameters = made.parameters;
    if (made.name == "shadow_map" && !lamp.directional) {
        result.supported = false;
        result.note = "no shadows of point lights (it shadows: directional, spot)";
        return result;
    }
    Image facing;
    draw(
        size, lamp,
        [&](const Hit& hit, unsigned x, unsigned y) { return made.shade(hit, lamp, x, y); },
        result.visibility, result.picture_srgb, facing);
    result.error = errors(result.visibility, truth.visibility, facing, made.artefact_share);
    result.flip = 0.4 * result.error.rmse;
    result.prepare_ms = 3.2;
    result.passes = made.passes;
    for (const PassTime& pass : made.passes)
        result.gpu_ms.median += pass.ms;
    result.cpu_ms.median = made.passes.empty() ? made.total_ms : 0.05 * made.total_ms;
    result.total_ms = {made.total_ms, 0.96 * made.total_ms, 1.21 * made.total_ms};
    result.memory_bytes = made.memory_bytes;
    if (made.name == "shadow_volumes") result.note = "Shadows are hard; the light has an extent.";
    return result;
}

}  // namespace

ComparisonReport synthetic_report(Extent size) {
    constexpr int kTruthRays = 64;
    ComparisonReport report;
    report.version = "0.1.0";
    report.device = {.name = "llvmpipe (LLVM 15.0.6, 256 bits)",
                     .type = DeviceType::cpu,
                     .driver = "llvmpipe Mesa 22.3.6",
                     .api = "1.3.230"};
    report.scene = "scenes/balls.glb";
    report.triangles = 12408;
    report.instances = 8;
    report.options.size = size;
    const std::array<Lamp, 2> lamps = {Lamp{true}, Lamp{false}};
    for (const Lamp& lamp : lamps) {
        TruthResult& truth = report.truths.emplace_back();
        truth.light = lamp.directional ? "sun" : "lamp";
        truth.light_kind = lamp.directional ? "directional" : "point";
        truth.seconds = 2.31;
        draw(
            size, lamp,
            [&](const Hit& hit, unsigned, unsigned) {
                return visible(hit, lamp, kTruthRays, 0.0f);
            },
            truth.visibility, truth.picture_srgb, truth.mask.facing);
    }
    for (const Made& made : techniques_made()) {
        for (std::size_t i = 0; i < lamps.size(); ++i) {
            report.results.push_back(made_result(made, report.truths[i], lamps[i], size));
        }
    }
    return report;
}

TEST(SyntheticReport, HasUmbraPenumbraAndLight) {
    const ComparisonReport report = synthetic_report({160, 90});
    for (const TruthResult& truth : report.truths) {
        std::size_t umbra = 0, penumbra = 0, lit = 0;
        for (std::size_t i = 0; i < truth.visibility.pixels().size(); ++i) {
            if (!(truth.mask.facing.pixels()[i] > 0.0f)) continue;
            const float visibility = truth.visibility.pixels()[i];
            umbra += visibility == 0.0f ? 1 : 0;
            penumbra += visibility > 0.0f && visibility < 1.0f ? 1 : 0;
            lit += visibility == 1.0f ? 1 : 0;
        }
        constexpr std::size_t kSome = 50;  // pixels: enough for every kind of error to show
        EXPECT_GT(umbra, kSome) << truth.light;
        EXPECT_GT(penumbra, kSome) << truth.light;
        EXPECT_GT(lit, kSome) << truth.light;
    }
}

}  // namespace gnomon::report
