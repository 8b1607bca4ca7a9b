// A skinned glTF file casts the shadow of the pose that it is loaded in, by every technique.

#include "harness.h"
#include "scene/load_test_scene.h"
#include "subjects.h"

namespace gnomon {
namespace {

using test::context;

constexpr double kRest_s = 0.0, kBent_s = 1.0;

/// A board of 1 m by 2 m over a ground, 3 m above it. Its right edge follows a joint in its middle,
/// which turns by 180° in two seconds, by way of 90°: the board then hangs down there.
scene::TestGltf board_over_ground() {
    scene::TestGltf gltf;
    const auto quad = [&](std::vector<float> corners, nlohmann::json attributes) {
        attributes["POSITION"] = gltf.vec3(corners);
        const int triangles = gltf.indices({0, 1, 2, 0, 2, 3});
        return gltf.mesh({{"attributes", attributes}, {"indices", triangles}});
    };
    const std::vector<std::uint8_t> joint_of{0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
    const int joints = gltf.accessor({{"bufferView", gltf.view(joint_of)},
                                      {"componentType", 5121},
                                      {"count", 4},
                                      {"type", "VEC4"}});
    const int weights = gltf.floats("VEC4", 4, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    quad({-1, 0, 0.5f, 1, 0, 0.5f, 1, 0, -0.5f, -1, 0, -0.5f},
         {{"JOINTS_0", joints}, {"WEIGHTS_0", weights}});
    quad({-4, 0, 4, 4, 0, 4, 4, 0, -4, -4, 0, -4}, nlohmann::json::object());
    const int binds = gltf.floats("MAT4", 16, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                                               1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    gltf.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", binds}}};
    gltf.json["nodes"] = {{{"mesh", 0}, {"skin", 0}},
                          {{"translation", {0, 3, 0}}, {"children", {2}}},
                          nlohmann::json::object(),
                          {{"mesh", 1}}};
    gltf.json["scenes"][0]["nodes"] = {0, 1, 3};
    const int times = gltf.floats("SCALAR", 1, {0, 2});
    const int turns = gltf.floats("VEC4", 4, {0, 0, 0, 1, 0, 0, -1, 0});
    gltf.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", turns}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
    return gltf;
}

class Skinned : public test::DeviceTest, public testing::WithParamInterface<const TechniqueInfo*> {
protected:
    static Frame frame_at(double time_s, const Light& light) {
        return {.scene = board_over_ground().load({.animation_time_s = time_s}),
                .camera = look_at({0, 1.0f, 4.0f}, {0, 0, 0}),
                .light = light,
                .size = {160, 120}};
    }
};

std::vector<const TechniqueInfo*> casting_techniques() {
    std::vector<const TechniqueInfo*> casting;
    for (const TechniqueInfo& info : techniques()) {
        if (test::casts(info)) casting.push_back(&info);
    }
    return casting;
}

INSTANTIATE_TEST_SUITE_P(Techniques, Skinned, testing::ValuesIn(casting_techniques()),
                         [](const auto& test) { return std::string(test.param->name); });

TEST_P(Skinned, CastersCastTheShadowOfTheirPose) {
    const auto technique = test::make_small(GetParam()->name);
    for (const Light& light :
         {Light(sun(radians(70.0f), radians(90.0f), 0.0f)), Light(PointLight{{0.3f, 7.0f, 0}})}) {
        if (!supports(GetParam()->lights, light)) continue;
        SCOPED_TRACE(light_name(light));
        const Visibility rest = trace_visibility(context(), frame_at(kRest_s, light));
        for (const double time_s : {kRest_s, kBent_s}) {
            const Frame frame = frame_at(time_s, light);
            const Visibility truth = trace_visibility(context(), frame);
            const ComparisonMask mask = comparison_mask(context(), frame);
            if (time_s != kRest_s) {  // else the test would not tell one pose from the other
                EXPECT_GT(compare(rest, truth, mask).false_shadow, 0.01);
            }
            const Comparison error = compare(technique->render(frame), truth, mask);
            EXPECT_LT(error.false_lit + error.false_shadow, 0.004) << time_s << " s";
        }
    }
}

}  // namespace
}  // namespace gnomon
