#include <gnomon/error.h>
#include <gnomon/report.h>

#include <gtest/gtest.h>

#include <string>

namespace gnomon {
namespace {

constexpr Extent kSize{96, 54};

/// The cube under a hard sun and a disc: one light that all shadow, one that few do.
CompareOptions cube_options(const Scene& scene) {
    CompareOptions options;
    options.camera = scene.cameras().at(0);
    options.lights = {sun(radians(40.0f), radians(30.0f), 0.0f),
                      DiscLight{.center_ws = {2.0f, 6.0f, 2.0f}, .radius_m = 0.5f}};
    options.size = kSize;
    options.reference_samples = 16;
    options.timing_frames = 2;
    return options;
}

class CompareTechniques : public ::testing::Test {
protected:
    Context context_{{.validation = true}};
    const Scene scene_ = make_builtin_scene("cube");
    CompareOptions options_ = cube_options(scene_);
    Progress progress_;

    void TearDown() override {
        for (const std::string& message : context_.validation_messages())
            ADD_FAILURE() << message;
    }
};

TEST_F(CompareTechniques, JudgesEveryTechniqueOnEveryLightInTheDocumentedOrder) {
    const ComparisonReport report = compare_techniques(context_, scene_, options_, progress_);
    ASSERT_EQ(report.truths.size(), 2u);
    ASSERT_EQ(report.results.size(), 2 * techniques().size());
    for (std::size_t i = 0; i < report.results.size(); ++i) {
        const TechniqueResult& result = report.results[i];
        const TechniqueInfo& info = techniques()[i / 2];
        EXPECT_EQ(result.technique, info.name);
        EXPECT_EQ(result.light, report.truths[i % 2].light);
        EXPECT_EQ(result.supported, supports(info.lights, options_.lights[i % 2]));
        EXPECT_EQ(result.parameters.size(), info.params().size());
        if (!result.supported) {
            EXPECT_FALSE(result.note.empty());
            continue;
        }
        EXPECT_EQ(result.visibility.size(), kSize);
        EXPECT_EQ(result.picture_srgb.channels(), 3);
        EXPECT_GT(result.error.pixels, 0u);
        EXPECT_GT(result.total_ms.median, 0.0);
        EXPECT_LE(result.total_ms.min, result.total_ms.median);
        EXPECT_LE(result.total_ms.median, result.total_ms.max);
    }
}

TEST_F(CompareTechniques, TracedHardShadowsAreTheTruth) {
    options_.techniques = {{"ray_traced", {}}};
    options_.lights.resize(1);
    const ComparisonReport report = compare_techniques(context_, scene_, options_, progress_);
    const TechniqueResult& result = report.results.at(0);
    // Without extent both cast the same one ray a receiver.
    EXPECT_EQ(result.error.rmse, 0.0);
    EXPECT_EQ(result.flip, 0.0);
}

TEST_F(CompareTechniques, NoShadowsMissAllOfTheUmbra) {
    options_.techniques = {{"local_illumination", {}}};
    options_.lights.resize(1);
    const ComparisonReport report = compare_techniques(context_, scene_, options_, progress_);
    const TruthResult& truth = report.truths.at(0);
    double umbra = 0.0, judged = 0.0;
    for (std::size_t i = 0; i < truth.visibility.pixels().size(); ++i) {
        if (!(truth.mask.facing.pixels()[i] > 0.0f)) continue;
        judged += 1.0;
        umbra += truth.visibility.pixels()[i] == 0.0f ? 1.0 : 0.0;
    }
    ASSERT_GT(umbra, 0.0);
    EXPECT_DOUBLE_EQ(report.results.at(0).error.false_lit, umbra / judged);
    EXPECT_EQ(report.results.at(0).error.false_shadow, 0.0);
}

TEST_F(CompareTechniques, RefusesWhatCannotBeCompared) {
    CompareOptions options = options_;
    options.lights.clear();
    EXPECT_THROW(compare_techniques(context_, scene_, options, progress_), Error);
    options = options_;
    options.timing_frames = 0;
    EXPECT_THROW(compare_techniques(context_, scene_, options, progress_), Error);
    options = options_;
    options.size = {0, 0};
    EXPECT_THROW(compare_techniques(context_, scene_, options, progress_), Error);
}

TEST_F(CompareTechniques, StopsWhenCancelled) {
    struct Cancelling : Progress {
        bool cancelled() const override { return true; }
    } cancelling;
    try {
        compare_techniques(context_, scene_, options_, cancelling);
        FAIL() << "was not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
}

TEST_F(CompareTechniques, BenchTimesTheFirstLight) {
    const std::vector<BenchResult> results =
        bench_techniques(context_, scene_, options_, 3, progress_);
    ASSERT_EQ(results.size(), techniques().size());
    for (const BenchResult& result : results) {
        EXPECT_EQ(result.light, "sun");
        EXPECT_EQ(result.supported, result.note.empty());
        EXPECT_EQ(result.supported, result.total_ms.median > 0.0) << result.technique;
    }
    EXPECT_THROW(bench_techniques(context_, scene_, options_, 0, progress_), Error);
}

}  // namespace
}  // namespace gnomon
