#include <gnomon/error.h>
#include <gnomon/metrics.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace gnomon {
namespace {

// Fractions and means of a few values: the rounding of doubles, and of 0.25f and the like none.
constexpr double kRounding = 1e-12;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Image image(Extent size, const std::function<float(unsigned x, unsigned y)>& value) {
    Image result(size, 1);
    for (unsigned y = 0; y < size.height; ++y) {
        for (unsigned x = 0; x < size.width; ++x)
            result.at(x, y) = value(x, y);
    }
    return result;
}

ComparisonMask everywhere(Extent size, float pixel_size_m = 1.0f) {
    return {Image(size, 1, 1.0f), Image(size, 1, pixel_size_m)};
}

/// Lit left of `edge`, shadow from there on.
Image half_plane(Extent size, unsigned edge) {
    return image(size, [=](unsigned x, unsigned) { return x < edge ? 1.0f : 0.0f; });
}

TEST(Compare, MeansAreOfTheMaskedPixels) {
    const Extent size = {4, 1};
    const Image truth(size, 1, 0.5f);
    Image visibility(size, 1, 0.5f);
    visibility.at(0, 0) = 0.75f;   // +1/4
    visibility.at(1, 0) = 0.0f;    // -1/2
    visibility.at(3, 0) = 100.0f;  // outside
    ComparisonMask mask = everywhere(size);
    mask.facing.at(3, 0) = 0.0f;
    const Comparison result = compare(visibility, truth, mask);
    EXPECT_EQ(result.pixels, 3u);
    EXPECT_NEAR(result.mae, 0.75 / 3.0, kRounding);
    EXPECT_NEAR(result.rmse, std::sqrt((1.0 / 16.0 + 1.0 / 4.0) / 3.0), kRounding);
    EXPECT_EQ(result.false_lit + result.false_shadow, 0.0);
}

TEST(Compare, IsZeroForTheTruthAndForAnEmptyMask) {
    const Extent size = {8, 8};
    const Image truth = half_plane(size, 3);
    const Comparison same = compare(truth, truth, everywhere(size));
    EXPECT_EQ(same.pixels, 64u);
    EXPECT_EQ(same.mae + same.rmse + same.false_lit + same.false_shadow, 0.0);
    const Comparison none =
        compare(Image(size, 1), truth, {Image(size, 1, 0.0f), Image(size, 1, 1.0f)});
    EXPECT_EQ(none.pixels, 0u);
    EXPECT_EQ(none.mae + none.rmse + none.false_shadow + none.stray_shadow, 0.0);
}

TEST(Compare, PenumbraIsNeverFalse) {
    const Extent size = {2, 1};
    const Image penumbra(size, 1, 0.4f);
    const Comparison result = compare(Image(size, 1, 1.0f), penumbra, everywhere(size));
    EXPECT_EQ(result.false_lit, 0.0);
    EXPECT_NEAR(result.mae, 0.6, 1e-7);  // of floats
}

TEST(Compare, StrayPixelsLieBeyondTwoPixelsOfTheOtherClass) {
    // Truth: lit up to x = 9. The technique's shadow begins 5 pixels late: x = 10 .. 14 are false,
    // at 1 .. 5 pixels from the lit ones; 3, 4 and 5 are beyond max(2 px, 1 % of 16 px).
    const Extent size = {32, 16};
    const Comparison late = compare(half_plane(size, 15), half_plane(size, 10), everywhere(size));
    EXPECT_NEAR(late.false_lit, 5.0 / 32.0, kRounding);
    EXPECT_NEAR(late.stray_lit, 3.0 / 32.0, kRounding);
    EXPECT_EQ(late.false_shadow, 0.0);
    // Five pixels early: the mirror image.
    const Comparison early = compare(half_plane(size, 5), half_plane(size, 10), everywhere(size));
    EXPECT_NEAR(early.false_shadow, 5.0 / 32.0, kRounding);
    EXPECT_NEAR(early.stray_shadow, 3.0 / 32.0, kRounding);
    EXPECT_EQ(early.false_lit, 0.0);
}

TEST(Compare, StrayDistanceGrowsWithTheHeight) {
    const Extent size = {16, 400};  // 1 % is 4 px: of the distances 1 .. 5 only 5 is beyond
    const Comparison result = compare(half_plane(size, 13), half_plane(size, 8), everywhere(size));
    EXPECT_NEAR(result.stray_lit, 1.0 / 16.0, kRounding);
}

TEST(Compare, ArtefactsLieBeyondTheTexelsReach) {
    // Texels of 2 m on pixels of 1 m, radius 0.5: (0.5 + 1.5) * 2 = 4 px, of distances 1 .. 6.
    const Extent size = {32, 4};
    const Image truth = half_plane(size, 10);
    const Image late = half_plane(size, 16);
    const Image texels(size, 1, 2.0f);
    const Comparison coarse = compare(late, truth, everywhere(size), texels, 0.5f);
    EXPECT_NEAR(coarse.stray_lit, 4.0 / 32.0, kRounding);
    EXPECT_NEAR(coarse.artefact_lit, 2.0 / 32.0, kRounding);
    // The same texels on pixels of 4 m reach 1 px; the aliasing of 1.5 px is still granted.
    const Comparison fine = compare(late, truth, everywhere(size, 4.0f), texels, 0.5f);
    EXPECT_NEAR(fine.artefact_lit, 5.0 / 32.0, kRounding);
}

/// Finds the class in some columns, and keeps what it was asked.
class ColumnProbe : public EdgeProbe {
public:
    ColumnProbe(Extent size, unsigned first, unsigned last)
        : size_(size), first_(first), last_(last) {}

    std::vector<std::uint8_t> find(std::span<const Place> places, bool lit) const override {
        std::vector<std::uint8_t> found;
        for (const Place& place : places) {
            const std::size_t x = place.pixel % size_.width;
            found.push_back(x >= first_ && x <= last_ ? 1 : 0);
            EXPECT_NEAR(place.reach_m, 4.0, kRounding);
        }
        (lit ? asked_lit : asked_shadow) += places.size();
        return found;
    }

    mutable std::size_t asked_lit = 0, asked_shadow = 0;

private:
    Extent size_;
    unsigned first_, last_;
};

TEST(Compare, EdgesThatThePictureDoesNotShowExplainToo) {
    // As above: the last two of six false columns are beyond 4 px.
    const Extent size = {32, 4};
    const auto probe = std::make_shared<ColumnProbe>(size, 14u, 14u);
    ComparisonMask mask = everywhere(size);
    mask.edges = probe;
    const Image late = half_plane(size, 16);
    const Image early = half_plane(size, 10);
    const Image texels(size, 1, 2.0f);
    EXPECT_NEAR(compare(late, early, mask, texels, 0.5f).artefact_lit, 1.0 / 32.0, kRounding);
    EXPECT_EQ(probe->asked_lit, 8u);
    EXPECT_EQ(probe->asked_shadow, 0u);
    EXPECT_NEAR(compare(early, late, mask, texels, 0.5f).artefact_shadow, 2.0 / 32.0, kRounding);
    EXPECT_EQ(probe->asked_shadow, 8u);
    // Without texels there is no reach.
    EXPECT_NEAR(compare(late, early, mask).artefact_lit, 4.0 / 32.0, kRounding);
    EXPECT_EQ(probe->asked_lit, 8u);
}

TEST(Compare, AliasingOnTheDiagonalIsNoArtefact) {
    const Extent size = {9, 9};
    const auto diagonal = [&](int edge) {
        return image(size, [=](unsigned x, unsigned y) {
            return static_cast<int>(x) - static_cast<int>(y) < edge ? 1.0f : 0.0f;
        });
    };
    const Image texels(size, 1, 1e-3f);
    const Comparison one = compare(diagonal(1), diagonal(0), everywhere(size), texels);
    EXPECT_NEAR(one.false_lit, 9.0 / 81.0, kRounding);
    EXPECT_EQ(one.artefact_lit, 0.0);
    // From the last lit pixels, x - y = -1, those at 0, 1 and 2 are 1, √2 and √5 px away.
    const Comparison three = compare(diagonal(3), diagonal(0), everywhere(size), texels);
    EXPECT_NEAR(three.artefact_lit, 7.0 / 81.0, kRounding);
}

TEST(Compare, ArtefactsAreJudgedAsStrayWithoutTexels) {
    const Extent size = {32, 16};
    const Image truth = half_plane(size, 10);
    const Image late = half_plane(size, 15);
    for (const float no_texel : {0.0f, -1.0f, kNan, std::numeric_limits<float>::infinity()}) {
        const Comparison result =
            compare(late, truth, everywhere(size), Image(size, 1, no_texel), 1.0f);
        EXPECT_EQ(result.artefact_lit, result.stray_lit);
    }
    EXPECT_NEAR(compare(late, truth, everywhere(size)).artefact_lit, 3.0 / 32.0, kRounding);
    // pixel_size_m is then not needed.
    EXPECT_NO_THROW(compare(late, truth, {Image(size, 1, 1.0f), {}}));
}

TEST(Compare, WithoutTheOtherClassEveryFalsePixelIsFar) {
    const Extent size = {8, 8};
    const Comparison result = compare(Image(size, 1, 1.0f), Image(size, 1, 0.0f), everywhere(size),
                                      Image(size, 1, 1e6f), 4.0f);
    EXPECT_EQ(result.false_lit, 1.0);
    EXPECT_EQ(result.stray_lit, 1.0);
    EXPECT_EQ(result.artefact_lit, 1.0);
}

TEST(Compare, PixelsOutsideTheMaskAreOfNoClass) {
    // The only lit pixels of the truth have no receiver, so the false ones beside them are far.
    const Extent size = {8, 1};
    ComparisonMask mask = everywhere(size);
    mask.facing.at(0, 0) = 0.0f;
    const Comparison result = compare(half_plane(size, 2), half_plane(size, 1), mask);
    EXPECT_NEAR(result.false_lit, 1.0 / 7.0, kRounding);
    EXPECT_NEAR(result.stray_lit, 1.0 / 7.0, kRounding);
}

TEST(Compare, RefusesWhatItCannotCompare) {
    const Extent size = {4, 4};
    const Image ok(size, 1);
    Image nan(size, 1);
    nan.at(2, 1) = kNan;
    EXPECT_THROW(compare(Image(), ok, everywhere(size)), Error);
    EXPECT_THROW(compare(ok, Image({4, 5}, 1), everywhere(size)), Error);
    EXPECT_THROW(compare(ok, Image(size, 3), everywhere(size)), Error);
    EXPECT_THROW(compare(ok, ok, everywhere({5, 4})), Error);
    EXPECT_THROW(compare(ok, ok, everywhere(size), Image({5, 4}, 1)), Error);
    EXPECT_THROW(compare(ok, ok, {Image(size, 1, 1.0f), {}}, ok), Error);
    EXPECT_THROW(compare(ok, nan, everywhere(size)), Error);
    EXPECT_THROW(compare(ok, ok, everywhere(size), {}, -1.0f), Error);
    EXPECT_THROW(compare(ok, ok, everywhere(size), {}, kNan), Error);
    try {
        compare(nan, ok, everywhere(size));
        ADD_FAILURE() << "NaN accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_NE(std::string_view(error.what()).find("(2, 1)"), std::string_view::npos);
    }
}

}  // namespace
}  // namespace gnomon
