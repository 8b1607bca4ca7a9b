#include "technique/map_technique.h"

#include <gnomon/error.h>

#include "base/check.h"
#include "visibility/context_test.h"

#include <algorithm>

namespace gnomon {
namespace {

const TechniqueInfo kInterrupted{.name = "interrupted", .lights = LightKinds::directional};

/// One map around all that is seen; fails when told to, after it has recorded all of a frame.
class Interrupted final : public MapTechnique {
public:
    Interrupted(Context& context, const MapOptions& options)
        : MapTechnique(context, kInterrupted, options), options_(options) {}
    bool fails = false;

private:
    MapPlan plan(const Frame& frame, const Seen& seen) const override {
        const LightFit fit = fit_directional_stable(
            std::get<DirectionalLight>(frame.light), frame.camera, frame.size, seen.range,
            frame.scene.bounds(), options_.size_texels(), options_.margin_texels());
        return {.layers = {directional_layer(frame, seen, fit, seen.range)}};
    }
    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        MapTechnique::record(commands, input, visibility);
        if (fails) fail_machine("interrupted: out of memory");
    }

    MapOptions options_;
};

class InterruptedTest : public ContextTest {};

// What was recorded has not run: nothing of it may count as drawn.
TEST_F(InterruptedTest, AFrameLeavesNoMapsForTheNext) {
    const Scene scene = make_builtin_scene("courtyard");
    const Frame frame{.scene = scene,
                      .camera = scene.cameras().front(),
                      .light = scene.lights().front(),
                      .size = {160, 90}};
    for (const MapContent content :
         {MapContent::depth, MapContent::object_id, MapContent::moments}) {
        MapOptions options;
        options.map_size = 512;
        options.reuse_maps = true;
        options.content = content;
        options.filter = MapFilter::taps_16;  // whose bounds are kept too
        options.skip_uniform = SkipUniform::always;
        const Visibility whole = Interrupted(context(), options).render(frame);
        Interrupted technique(context(), options);
        technique.fails = true;
        Progress silent;
        Visibility after;
        EXPECT_THROW(technique.render(frame, after, silent), Error);
        EXPECT_TRUE(after.image().empty());
        technique.fails = false;
        technique.render(frame, after, silent);
        EXPECT_TRUE(std::ranges::equal(after.image().pixels(), whole.image().pixels()));
    }
}

}  // namespace
}  // namespace gnomon
