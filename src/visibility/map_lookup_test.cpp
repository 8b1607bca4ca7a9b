#include "visibility/map_lookup.h"

#include "gpu/commands.h"
#include "visibility/context_impl.h"
#include "visibility/context_test.h"
#include "visibility/depth_map.h"
#include "visibility/light_view.h"
#include "visibility/visibility_impl.h"

#include <algorithm>
#include <vector>

namespace gnomon {
namespace {

/// No multiple of a block.
constexpr Extent kSize{317, 181};

class MapLookupTest : public ContextTest {
protected:
    static Visibility look_up(const Frame& frame, const LookupLayers& layers, bool surveyed) {
        Context::Impl& impl = context().impl();
        const gpu::Device& device = impl.device();
        const raster::Receivers& receivers = impl.receivers(frame)->device;
        DepthMap map(device);
        MapLookup lookup(device, {.filter = MapFilter::hardware_2x2}, {});
        ReceiverSurvey survey(device);
        gpu::Submission submission(device);
        gpu::Commands commands = submission.begin();
        survey.record(commands, receivers);
        submission.submit_and_wait();
        survey.seen();

        std::vector<MapLayer> drawn;
        for (const LookupLayer& layer : layers.layers)
            drawn.push_back({.fit = layer.fit, .casters = CasterVolume(layer.fit)});
        Visibility visibility;
        gpu::Image& target = visibility.impl().device_target(impl, frame.size);
        commands = submission.begin();
        map.record(commands, impl.gpu_scene(frame.scene), drawn, {});
        lookup.record(commands, receivers, frame.light, layers, map.image(), map.ids(), nullptr,
                      surveyed ? &survey : nullptr, target);
        commands.use(target, gpu::Use::storage_read);
        submission.submit_and_wait();
        return visibility;
    }

    static constexpr unsigned kMapSize = 512;
    static constexpr float kMarginTexels = 3.0f;

    static LookupLayers layers_of(const Frame& frame, double blend) {
        constexpr double kEnds_m[] = {1.0, 6.0, 14.0, 100.0};
        LookupLayers layers{.blend = blend};
        for (std::size_t i = 0; i + 1 < std::size(kEnds_m); ++i) {
            layers.layers.push_back(
                {fit_directional_stable(std::get<DirectionalLight>(frame.light), frame.camera,
                                        frame.size, {kEnds_m[i], kEnds_m[i + 1]},
                                        frame.scene.bounds(), kMapSize, kMarginTexels),
                 kEnds_m[i]});
        }
        return layers;
    }
};

// Blocks that lie in one layer are looked up there, and where no receiver is, none is: neither must
// show.
TEST_F(MapLookupTest, ListedBlocksGiveThePictureOfAllPixels) {
    for (const char* name : {"courtyard", "field-small"}) {
        const Scene scene = make_builtin_scene(name);
        const Frame frame{.scene = scene,
                          .camera = scene.cameras().front(),
                          .light = scene.lights().front(),
                          .size = kSize};
        for (const double blend : {0.0, 0.3}) {
            const LookupLayers layers = layers_of(frame, blend);
            const Visibility all = look_up(frame, layers, false);
            const Visibility listed = look_up(frame, layers, true);
            EXPECT_TRUE(std::ranges::equal(listed.image().pixels(), all.image().pixels()))
                << name << ", " << blend;
        }
    }
}

// The faces of a cube begin at no distance.
TEST_F(MapLookupTest, ListedBlocksLookIntoEveryFaceOfACube) {
    const Scene scene = make_builtin_scene("courtyard");
    Frame frame{.scene = scene, .camera = scene.cameras().front(), .size = kSize};
    const Vec3 position_ws = scene.bounds().center();
    frame.light = PointLight{.position_ws = position_ws};
    LookupLayers layers{.choice = LayerChoice::by_axis};
    for (const LightView& view : cube_views(DVec3(position_ws)))
        layers.layers.push_back({fit_view(view, scene.bounds(), kMapSize, kMarginTexels)});
    const Visibility all = look_up(frame, layers, false);
    const Visibility listed = look_up(frame, layers, true);
    EXPECT_TRUE(std::ranges::equal(listed.image().pixels(), all.image().pixels()));
}

}  // namespace
}  // namespace gnomon
