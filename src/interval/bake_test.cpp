#include "interval/bake.h"

#include <gnomon/error.h>

#include "interval/test_days.h"
#include "trace/test_scenes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <bit>
#include <cmath>

namespace gnomon::interval {
namespace {

using trace::Receiver;

/// What a camera sees of a scene: receivers on its own triangles, as a bake has them.
struct Stage {
    explicit Stage(const char* name, bool ignore_alpha = false)
        : scene(make_builtin_scene(name)),
          frame(frame_around(pole_at(0.84))),
          tracer(scene, ignore_alpha, progress),
          tree(scene, frame, ignore_alpha, progress) {
        constexpr Extent kSize{64, 48};
        const Camera& camera = scene.cameras().at(0);
        receivers =
            tracer.receivers(camera, kSize, tracer.visible_surfaces(camera, kSize, progress));
    }

    Progress progress;
    Scene scene;
    Frame frame;
    trace::Tracer tracer;
    Tree tree;
    std::vector<Receiver> receivers;
};

DayPath summer_day(const Frame& frame, int steps) {
    return DayPath(circle(frame, 0.409, -1.9, 1.9, steps), frame);
}

struct Comparison {
    int samples = 0, lit = 0, differ = 0;
};

/// With a shadow ray for each receiver and step.
Comparison compare_with_rays(const Stage& stage, const DayPath& path, const DayMasks& masks) {
    Comparison comparison;
    std::vector<float> visibility(stage.receivers.size());
    const Extent size{static_cast<unsigned>(stage.receivers.size()), 1};
    Progress progress;
    for (int k = 0; k < path.steps(); ++k) {
        const Vec3 to_sun(path.to_sun_ws()[static_cast<std::size_t>(k)]);
        stage.tracer.visibility(stage.receivers, size, DirectionalLight{.to_light_ws = to_sun}, 1,
                                1, visibility, progress);
        for (std::size_t i = 0; i < visibility.size(); ++i) {
            const bool lit = is_lit(masks.mask(i), k);
            ++comparison.samples;
            comparison.lit += lit ? 1 : 0;
            comparison.differ += lit != (visibility[i] > 0.0f) ? 1 : 0;
        }
    }
    return comparison;
}

TEST(Bake, SaysWhatRaysSay) {
    for (const char* name : {"courtyard", "field-small", "gas-station"}) {
        const Stage stage(name);
        const DayPath path = summer_day(stage.frame, 64);
        Progress progress;
        const DayMasks masks = bake(stage.tree, path, stage.receivers, progress);
        const Comparison comparison = compare_with_rays(stage, path, masks);
        // Embree's triangles and directions are rounded to float, by 1e-7 of their distance; there
        // are some edges of shadows among 1e5 samples, so that now and then one falls between.
        EXPECT_LE(comparison.differ, 2 + comparison.samples / 100'000)
            << name << ", of " << comparison.samples;
        EXPECT_GT(comparison.lit, comparison.samples / 10) << name;
        EXPECT_LT(comparison.lit, comparison.samples * 19 / 20) << name;
    }
}

TEST(Bake, IsTheSameForAllTilesAndThreads) {
    const Stage stage("courtyard");
    const DayPath path = summer_day(stage.frame, 256);
    Progress progress;
    const DayMasks one = bake(stage.tree, path, stage.receivers, progress, 1);
    for (const std::size_t threads : {1u, 2u, 5u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        for (const int texels : {kChooseTile, 3, 16, 32, 64}) {
            EXPECT_EQ(bake(stage.tree, path, stage.receivers, progress, texels).words, one.words)
                << texels << " texels, " << threads << " threads";
        }
    }
}

TEST(Bake, OneTreeServesEveryDate) {
    const Stage stage("cube");
    for (const double declination : {-0.409, -0.1, 0.0, 0.2, 0.409}) {
        const double half = std::acos(-std::tan(0.84) * std::tan(declination));
        const DayPath path(circle(stage.frame, declination, -half, half, 65), stage.frame);
        Progress progress;
        const DayMasks masks = bake(stage.tree, path, stage.receivers, progress);
        EXPECT_LE(compare_with_rays(stage, path, masks).differ, 2) << declination;
    }
}

TEST(Bake, ReportsAndStops) {
    struct Counting : Progress {
        void report(std::string_view, double fraction) override {
            EXPECT_GE(fraction, 0.0);
            EXPECT_LE(fraction, 1.0);
            last = fraction;
        }
        bool cancelled() const override { return cancel; }
        double last = -1.0;
        bool cancel = false;
    } progress;
    const Scene scene = make_builtin_scene("courtyard");
    const Frame frame = frame_around(pole_at(0.84));
    const Tree tree(scene, frame, false, progress);
    EXPECT_EQ(progress.last, 1.0);
    const std::vector<Receiver> receivers = receivers_on({0, 0, 0}, {1, 0, 0}, {0, 0, -1}, 8);
    const DayPath path = summer_day(frame, 64);
    bake(tree, path, receivers, progress);
    EXPECT_EQ(progress.last, 1.0);
    progress.cancel = true;
    EXPECT_THROW(bake(tree, path, receivers, progress), Error);
    EXPECT_THROW(Tree(scene, frame, false, progress), Error);
    progress.cancel = false;
    EXPECT_THROW(bake(tree, path, receivers, progress, 65), Error);
    EXPECT_THROW(bake(tree, path, receivers, progress, -1), Error);
}

}  // namespace
}  // namespace gnomon::interval
