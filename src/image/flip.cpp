// P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild: "FLIP: A
// Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2)
// (HPG), 2020. Names of constants are the paper's. As in NVIDIA's implementation since version 1.2
// the filters are separated, the blue-yellow one as a sum of two. Departures from it: the colours
// are clamped to [0, 1] first, and taps below the rounding of a float are left out.

#include <gnomon/metrics.h>

#include "base/check.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace gnomon {

namespace {

constexpr int kChannels = 3;
constexpr std::size_t kRowsPerTask = 16;

// Section 4: exponent, knee and its value of the colour difference; width in degrees of the feature
// detector and exponent of the feature difference.
constexpr float kQc = 0.7f;
constexpr float kPc = 0.4f;
constexpr float kPt = 0.95f;
constexpr float kFeatureWidth_deg = 0.082f;
constexpr float kQf = 0.5f;

// Filters reach over three standard deviations.
constexpr float kReach = 3.0f;

/// One term a √(π/b) exp(-π² x² / b) of a contrast-sensitivity function; x in degrees (Table 1).
struct Gaussian {
    float a;
    float b;
};
constexpr Gaussian kAchromatic = {1.0f, 0.0047f};
constexpr Gaussian kRedGreen = {1.0f, 0.0053f};
constexpr std::array<Gaussian, 2> kBlueYellow = {{{34.1f, 0.04f}, {13.5f, 0.025f}}};

/// Weights of taps -radius .. radius.
using Kernel = std::vector<float>;

/// width * height values of one channel, row-major.
struct Plane {
    Extent size;
    std::vector<float> values;

    explicit Plane(Extent extent)
        : size(extent), values(static_cast<std::size_t>(extent.width) * extent.height) {}
    float* row(std::size_t y) { return values.data() + y * size.width; }
    const float* row(std::size_t y) const { return values.data() + y * size.width; }
};

template <typename Body>
void for_rows(Extent size, const Body& body) {
    parallel_for(size.height, kRowsPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t y = first; y < last; ++y)
            body(y);
    });
}

// Colour spaces, with the digits of NVIDIA's implementation.

using Matrix = std::array<Vec3, 3>;  // rows

// Exact quotients of the primaries' chromaticities and of the white point, D65.
constexpr Matrix kXyzFromRgb = {
    Vec3{10135552.0f, 8788810.0f, 4435075.0f} / 24577794.0f,
    Vec3{2613072.0f, 8788810.0f, 887015.0f} / 12288897.0f,
    Vec3{1425312.0f, 8788810.0f, 70074185.0f} / 73733382.0f,
};
constexpr Matrix kRgbFromXyz = {
    Vec3{3.241003275f, -1.537398934f, -0.498615861f},
    Vec3{-0.969224334f, 1.875930071f, 0.041554224f},
    Vec3{0.055639423f, -0.204011202f, 1.057148933f},
};
constexpr Vec3 kWhite = {0.950428545f, 1.0f, 1.088900371f};

Vec3 multiply(const Matrix& m, Vec3 v) {
    return {glm::dot(m[0], v), glm::dot(m[1], v), glm::dot(m[2], v)};
}

/// The linear opponent space in which the eye's filters work.
Vec3 ycxcz_from_rgb(Vec3 rgb) {
    const Vec3 xyz = multiply(kXyzFromRgb, rgb) / kWhite;
    return {116.0f * xyz.y - 16.0f, 500.0f * (xyz.x - xyz.y), 200.0f * (xyz.y - xyz.z)};
}

Vec3 rgb_from_ycxcz(Vec3 ycxcz) {
    const float y = (ycxcz.x + 16.0f) / 116.0f;
    const Vec3 xyz = Vec3(y + ycxcz.y / 500.0f, y, y - ycxcz.z / 200.0f) * kWhite;
    return multiply(kRgbFromXyz, xyz);
}

/// CIELAB with Hunt's adjustment: dim colours differ less.
Vec3 hunt_lab_from_rgb(Vec3 rgb) {
    constexpr float kDelta = 6.0f / 29.0f;
    const auto compress = [](float t) {
        return t > kDelta * kDelta * kDelta ? std::cbrt(t)
                                            : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
    };
    const Vec3 xyz = multiply(kXyzFromRgb, rgb) / kWhite;
    const float y = compress(xyz.y);
    const float lightness = 116.0f * y - 16.0f;
    const float hunt = 0.01f * lightness;
    return {lightness, hunt * 500.0f * (compress(xyz.x) - y),
            hunt * 200.0f * (y - compress(xyz.z))};
}

/// The distance of S. Abasi et al. 2020 for large colour differences, raised to kQc.
float colour_distance(Vec3 lab_a, Vec3 lab_b) {
    const Vec3 d = lab_a - lab_b;
    return std::pow(std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z), kQc);
}

// Filters.

/// out[x] = sum of weights[k] * taps[k][x], for `width` values.
void convolve_row(std::span<const float* const> taps, const Kernel& weights, std::size_t width,
                  float* out) {
    constexpr std::size_t kBlock = 16;  // values summed in registers at a time
    std::size_t x = 0;
    for (; x + kBlock <= width; x += kBlock) {
        std::array<float, kBlock> sum{};
        for (std::size_t k = 0; k < taps.size(); ++k) {
            const float* tap = taps[k] + x;
            const float weight = weights[k];
            for (std::size_t i = 0; i < kBlock; ++i)
                sum[i] += weight * tap[i];
        }
        std::copy(sum.begin(), sum.end(), out + x);
    }
    for (; x < width; ++x) {
        float sum = 0.0f;
        for (std::size_t k = 0; k < taps.size(); ++k)
            sum += weights[k] * taps[k][x];
        out[x] = sum;
    }
}

/// Pixels beyond the border are those on it.
Plane convolve_x(const Plane& in, const Kernel& kernel) {
    const std::size_t radius = kernel.size() / 2;
    const std::size_t width = in.size.width;
    Plane out(in.size);
    parallel_for(in.size.height, kRowsPerTask, [&](std::size_t first, std::size_t last) {
        std::vector<float> padded(width + 2 * radius);
        std::vector<const float*> taps(kernel.size());
        for (std::size_t k = 0; k < taps.size(); ++k)
            taps[k] = padded.data() + k;
        for (std::size_t y = first; y < last; ++y) {
            const float* row = in.row(y);
            std::fill_n(padded.data(), radius, row[0]);
            std::copy_n(row, width, padded.data() + radius);
            std::fill_n(padded.data() + radius + width, radius, row[width - 1]);
            convolve_row(taps, kernel, width, out.row(y));
        }
    });
    return out;
}

Plane convolve_y(const Plane& in, const Kernel& kernel) {
    const auto radius = static_cast<std::ptrdiff_t>(kernel.size() / 2);
    const auto last_row = static_cast<std::ptrdiff_t>(in.size.height) - 1;
    Plane out(in.size);
    for_rows(in.size, [&](std::size_t y) {
        std::vector<const float*> taps(kernel.size());
        for (std::size_t k = 0; k < taps.size(); ++k) {
            const std::ptrdiff_t tap_y = static_cast<std::ptrdiff_t>(y + k) - radius;
            taps[k] =
                in.row(static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(tap_y, 0, last_row)));
        }
        convolve_row(taps, kernel, in.size.width, out.row(y));
    });
    return out;
}

Plane filter(const Plane& in, const Kernel& kernel) {
    return convolve_y(convolve_x(in, kernel), kernel);
}

int radius_of(double deviation_px) {
    return static_cast<int>(std::ceil(kReach * deviation_px));
}

/// A kernel of 2 * radius + 1 taps with the weights that `weight` gives to the offsets in pixels.
template <typename Weight>
std::vector<double> sample(int radius, const Weight& weight) {
    std::vector<double> result;
    for (int x = -radius; x <= radius; ++x)
        result.push_back(weight(static_cast<double>(x)));
    return result;
}

/// As floats times `scale`, without the outer taps that rounding would swallow.
Kernel rounded(const std::vector<double>& weights, double scale) {
    const double least =
        weights[weights.size() / 2] * static_cast<double>(std::numeric_limits<float>::epsilon());
    Kernel result;
    for (const double weight : weights) {
        if (weight >= least) result.push_back(static_cast<float>(weight * scale));
    }
    return result;
}

struct ContrastFilters {
    Kernel achromatic;
    Kernel red_green;
    std::array<Kernel, 2> blue_yellow;  // filtered by each in both directions, then added
};

ContrastFilters contrast_filters(double pixels_per_degree) {
    constexpr double kPiSquared = std::numbers::pi * std::numbers::pi;
    const double widest_b = kBlueYellow[0].b;
    const int radius = radius_of(std::sqrt(widest_b / (2.0 * kPiSquared)) * pixels_per_degree);
    const auto one_dimensional = [&](Gaussian g, double peak) {
        return sample(radius, [&](double x_px) {
            const double x_deg = x_px / pixels_per_degree;
            return peak * std::exp(-kPiSquared * x_deg * x_deg / g.b);
        });
    };
    const auto sum = [](const std::vector<double>& weights) {
        return std::accumulate(weights.begin(), weights.end(), 0.0);
    };
    const auto alone = [&](Gaussian g) {
        const std::vector<double> weights = one_dimensional(g, 1.0);
        return rounded(weights, 1.0 / sum(weights));
    };
    std::array<std::vector<double>, 2> terms;
    double volume = 0.0;
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const Gaussian g = kBlueYellow[i];
        terms[i] = one_dimensional(g, std::sqrt(g.a * std::sqrt(std::numbers::pi / g.b)));
        volume += sum(terms[i]) * sum(terms[i]);
    }
    const double scale = 1.0 / std::sqrt(volume);
    return {
        alone(kAchromatic), alone(kRedGreen), {rounded(terms[0], scale), rounded(terms[1], scale)}};
}

/// Detectors of edges and points: a Gaussian and its first two derivatives.
struct FeatureFilters {
    Kernel gaussian;
    Kernel first;
    Kernel second;
};

FeatureFilters feature_filters(double pixels_per_degree) {
    const double deviation = 0.5 * kFeatureWidth_deg * pixels_per_degree;
    const int radius = radius_of(deviation);
    const auto gaussian = [&](double x) {
        return std::exp(-x * x / (2.0 * deviation * deviation));
    };
    // Positive weights sum to 1, negative ones to -1.
    const auto normalized = [](const std::vector<double>& weights) {
        double positive = 0.0;
        double negative = 0.0;
        for (const double weight : weights)
            (weight > 0.0 ? positive : negative) += weight;
        Kernel result;
        for (const double weight : weights) {
            result.push_back(static_cast<float>(weight > 0.0   ? weight / positive
                                                : weight < 0.0 ? -weight / negative
                                                               : 0.0));
        }
        return result;
    };
    return {normalized(sample(radius, gaussian)),
            normalized(sample(radius, [&](double x) { return -x * gaussian(x); })),
            normalized(sample(radius, [&](double x) {
                return (x * x / (deviation * deviation) - 1.0) * gaussian(x);
            }))};
}

/// What an observer sees of one picture.
struct Percept {
    std::vector<Vec3> lab;  // Hunt-adjusted, of the filtered picture
    Plane edge;             // length of the gradient of Y
    Plane point;            // length of the second derivatives of Y
};

std::array<Plane, kChannels> ycxcz_planes(const Image& srgb) {
    std::array<Plane, kChannels> planes = {Plane(srgb.size()), Plane(srgb.size()),
                                           Plane(srgb.size())};
    for_rows(srgb.size(), [&](std::size_t y) {
        const float* pixel = srgb.pixels().data() + y * srgb.width() * kChannels;
        for (std::size_t x = 0; x < srgb.width(); ++x, pixel += kChannels) {
            Vec3 rgb;
            for (int c = 0; c < kChannels; ++c) {
                rgb[c] = linear_from_srgb(std::clamp(pixel[c], 0.0f, 1.0f));
            }
            const Vec3 ycxcz = ycxcz_from_rgb(rgb);
            for (int c = 0; c < kChannels; ++c)
                planes[static_cast<std::size_t>(c)].row(y)[x] = ycxcz[c];
        }
    });
    return planes;
}

std::vector<Vec3> filtered_lab(const std::array<Plane, kChannels>& ycxcz,
                               const ContrastFilters& filters) {
    const Plane y = filter(ycxcz[0], filters.achromatic);
    const Plane cx = filter(ycxcz[1], filters.red_green);
    const Plane cz_1 = filter(ycxcz[2], filters.blue_yellow[0]);
    const Plane cz_2 = filter(ycxcz[2], filters.blue_yellow[1]);
    std::vector<Vec3> lab(y.values.size());
    for_rows(y.size, [&](std::size_t row) {
        const std::size_t first = row * y.size.width;
        for (std::size_t i = first; i < first + y.size.width; ++i) {
            const Vec3 rgb =
                rgb_from_ycxcz({y.values[i], cx.values[i], cz_1.values[i] + cz_2.values[i]});
            lab[i] = hunt_lab_from_rgb(glm::clamp(rgb, 0.0f, 1.0f));
        }
    });
    return lab;
}

/// Length of the vector of the responses to `derivative` along x and along y.
Plane feature(const Plane& luminance, const Plane& smooth_x, const Kernel& gaussian,
              const Kernel& derivative) {
    const Plane along_x = convolve_y(convolve_x(luminance, derivative), gaussian);
    Plane result = convolve_y(smooth_x, derivative);
    for (std::size_t i = 0; i < result.values.size(); ++i) {
        result.values[i] =
            std::sqrt(result.values[i] * result.values[i] + along_x.values[i] * along_x.values[i]);
    }
    return result;
}

Percept perceive(const Image& srgb, const ContrastFilters& contrast,
                 const FeatureFilters& features) {
    std::array<Plane, kChannels> ycxcz = ycxcz_planes(srgb);
    std::vector<Vec3> lab = filtered_lab(ycxcz, contrast);
    Plane& luminance = ycxcz[0];
    for (float& y : luminance.values)
        y = (y + 16.0f) / 116.0f;  // to [0, 1]
    const Plane smooth_x = convolve_x(luminance, features.gaussian);
    return {std::move(lab), feature(luminance, smooth_x, features.gaussian, features.first),
            feature(luminance, smooth_x, features.gaussian, features.second)};
}

/// The colour difference in [0, 1]: small ones, up to the share kPc of the greatest, take [0, kPt].
float redistribute(float distance, float greatest) {
    const float knee = kPc * greatest;
    if (distance < knee) return kPt / knee * distance;
    return kPt + (distance - knee) / (greatest - knee) * (1.0f - kPt);
}

void check_picture(const char* name, const Image& image) {
    if (image.channels() != kChannels) {
        fail_input("flip: {} has {} channels; it must have 3 (RGB)", name, image.channels());
    }
    for (const float value : image.pixels()) {
        if (std::isnan(value)) fail_input("flip: {} has a pixel that is NaN", name);
    }
}

}  // namespace

Image flip_map(const Image& reference_srgb, const Image& test_srgb, float pixels_per_degree) {
    constexpr float kMinPixelsPerDegree = 1.0f;
    constexpr float kMaxPixelsPerDegree = 10'000.0f;
    check_picture("reference_srgb", reference_srgb);
    check_picture("test_srgb", test_srgb);
    if (reference_srgb.size() != test_srgb.size()) {
        fail_input("flip: reference_srgb is {}x{} pixels but test_srgb is {}x{}",
                   reference_srgb.width(), reference_srgb.height(), test_srgb.width(),
                   test_srgb.height());
    }
    if (!(pixels_per_degree >= kMinPixelsPerDegree && pixels_per_degree <= kMaxPixelsPerDegree)) {
        fail_input("flip: pixels_per_degree is {}; it must be {} to {}", pixels_per_degree,
                   kMinPixelsPerDegree, kMaxPixelsPerDegree);
    }
    const ContrastFilters contrast = contrast_filters(pixels_per_degree);
    const FeatureFilters features = feature_filters(pixels_per_degree);
    const Percept reference = perceive(reference_srgb, contrast, features);
    const Percept test = perceive(test_srgb, contrast, features);

    // The two colours of sRGB that lie farthest apart.
    const float greatest = colour_distance(hunt_lab_from_rgb({0.0f, 1.0f, 0.0f}),
                                           hunt_lab_from_rgb({0.0f, 0.0f, 1.0f}));
    Image map(reference_srgb.size(), 1);
    for_rows(map.size(), [&](std::size_t y) {
        const std::size_t first = y * map.width();
        for (std::size_t i = first; i < first + map.width(); ++i) {
            const float colour =
                redistribute(colour_distance(reference.lab[i], test.lab[i]), greatest);
            const float edge = std::abs(reference.edge.values[i] - test.edge.values[i]);
            const float point = std::abs(reference.point.values[i] - test.point.values[i]);
            const float feature =
                std::pow(std::max(edge, point) / std::numbers::sqrt2_v<float>, kQf);
            map.pixels()[i] = std::clamp(std::pow(colour, 1.0f - feature), 0.0f, 1.0f);
        }
    });
    return map;
}

double flip(const Image& reference_srgb, const Image& test_srgb, float pixels_per_degree) {
    const Image map = flip_map(reference_srgb, test_srgb, pixels_per_degree);
    const std::span<const float> values = map.pixels();
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace gnomon
