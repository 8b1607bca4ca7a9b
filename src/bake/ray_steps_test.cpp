#include "bake/ray_steps.h"

#include <gnomon/bake.h>
#include <gnomon/error.h>

#include "bake/light_day.h"
#include "bake/texel_receivers.h"
#include "lightmap/atlas.h"
#include "lightmap/texels.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace gnomon::bake {
namespace {

namespace fs = std::filesystem;

BakePath summer(int steps) {
    using namespace std::chrono;
    SunPathOptions options;
    options.steps = steps;
    return bake_path(
        sun_path({48.137, 11.575, 520.0}, 2026y / June / 21, std::chrono::minutes(120), options),
        "48.137,11.575", "2026-06-21");
}

std::vector<trace::Receiver> texels_of(const Scene& scene, double texel_size_m) {
    Progress silent;
    const lightmap::Atlas atlas =
        lightmap::make_atlas(scene, {.texel_size_m = texel_size_m}, silent);
    return texel_receivers(atlas, lightmap::make_texels(scene, atlas, silent));
}

/// The codes at which one is lit and the other is not.
int difference(const LitTimes& a, const LitTimes& b, int codes) {
    std::vector<char> lit(static_cast<std::size_t>(codes), 0);
    for (const CodedInterval& interval : a)
        std::fill(lit.begin() + interval.rise, lit.begin() + interval.fall, 1);
    int differ = 0;
    for (const CodedInterval& interval : b) {
        for (int code = interval.rise; code < interval.fall; ++code)
            lit[static_cast<std::size_t>(code)] ^= 1;
    }
    for (const char one : lit)
        differ += one;
    return differ;
}

struct Agreement {
    const char* scene;
    double most_differing;  ///< a part of the samples
};

class BothMethods : public testing::TestWithParam<Agreement> {};

// docs/bakes.md: a hundred thousandth of the samples, where rays round at edges. Four of the
// courtyard's 20,000 texels lie in the plane of another surface, which may or may not shade them.
TEST_P(BothMethods, AgreeButForEdges) {
    Progress silent;
    const Scene scene = make_builtin_scene(GetParam().scene);
    const std::vector<trace::Receiver> texels = texels_of(scene, 0.5);
    for (const BakeBits bits : {BakeBits::eight, BakeBits::sixteen}) {
        BakeOptions options{.bits = bits, .resume_file = {}};
        const LightDay traversal(scene, summer(100), options, silent);
        options.method = BakeMethod::rays;
        const LightDay rays(scene, summer(100), options, silent);
        const std::vector<LitTimes> expected = rays.times(texels, silent);
        const std::vector<LitTimes> found = traversal.times(texels, silent);
        double differ = 0.0;
        std::size_t shadowed = 0;
        for (std::size_t i = 0; i < texels.size(); ++i) {
            differ += difference(found[i], expected[i], rays.codes());
            shadowed += expected[i].size() > 1 ? 1 : 0;
        }
        EXPECT_GT(shadowed, texels.size() / 100);  // or there would be little to agree about
        EXPECT_LE(differ / (static_cast<double>(texels.size()) * rays.codes()),
                  GetParam().most_differing);
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, BothMethods,
                         testing::Values(Agreement{"cube", 1e-5}, Agreement{"courtyard", 1e-4}),
                         [](const auto& agreement) { return std::string(agreement.param.scene); });

TEST(RayBakes, KeepWhatTheyHaveAndAreNotGoneOnWithByAnotherMethod) {
    const fs::path file =
        fs::temp_directory_path() / ("gnomon_ray_bake" + std::to_string(::getpid()));
    fs::remove(file);
    Progress silent;
    const Scene scene = make_builtin_scene("cube");
    BakeOptions options{.texel_size_m = 0.5, .method = BakeMethod::rays, .resume_file = file};
    const IntervalBake first = bake_intervals(scene, summer(20), options, silent);
    EXPECT_EQ(bake_intervals(scene, summer(20), options, silent).pages[0].rises,
              first.pages[0].rises);
    options.method = BakeMethod::interval_traversal;
    EXPECT_THROW(bake_intervals(scene, summer(20), options, silent), Error);
    fs::remove(file);
}

TEST(RayBakes, TellTheirProgressAndCanBeStopped) {
    class Stops final : public Progress {
    public:
        void report(std::string_view task, double) override {
            if (task == "baking the sun") told_ = true;
        }
        bool cancelled() const override { return told_; }

    private:
        std::atomic<bool> told_{false};
    } stops;
    try {
        bake_intervals(make_builtin_scene("courtyard"), summer(20),
                       {.texel_size_m = 0.5, .method = BakeMethod::rays, .resume_file = {}}, stops);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
}

}  // namespace
}  // namespace gnomon::bake
