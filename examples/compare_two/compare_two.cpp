// Two techniques on one scene, each against the ray-traced truth.
//     compare_two [SCENE] [TECHNIQUE] [TECHNIQUE]

#include <gnomon/gnomon.h>

#include <cstdio>
#include <exception>
#include <string>

namespace {

void compare_two(const std::string& scene_name, const std::string& first,
                 const std::string& second) {
    gnomon::Context context;  // the best Vulkan 1.3 device; lavapipe will do
    const gnomon::Scene scene = gnomon::load_scene(scene_name);  // metres, Y up
    const gnomon::Frame frame{.scene = scene,
                              .camera = scene.cameras().at(0),
                              .light = scene.lights().at(0),
                              .size = {320, 180}};

    const gnomon::Visibility truth = gnomon::trace_visibility(context, frame, {.samples = 64});
    const gnomon::ComparisonMask mask = gnomon::comparison_mask(context, frame);

    for (const std::string& name : {first, second}) {
        const auto technique = gnomon::make_technique(context, name);
        technique->prepare(scene);
        const gnomon::Comparison error = compare(technique->render(frame), truth, mask);
        std::printf("%-20s rmse %.4f  false lit %.4f  false shadow %.4f\n", name.c_str(),
                    error.rmse, error.false_lit, error.false_shadow);
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        compare_two(argc > 1 ? argv[1] : "cube", argc > 2 ? argv[2] : "shadow_map",
                    argc > 3 ? argv[3] : "local_illumination");
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}
