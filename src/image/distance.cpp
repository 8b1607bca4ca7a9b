// P. Felzenszwalb, D. Huttenlocher: "Distance Transforms of Sampled Functions", Theory of Computing
// 8, 2012. Departure: along the columns, where the sampled function is 0 or infinite, two scans
// find the distance that their lower envelope would; along the rows it is theirs, and parabolas at
// infinity are left out of it.

#include "image/distance.h"

#include "base/parallel.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace gnomon::image {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kRowsPerTask = 16;

/// Distances along the columns, in pixels: down from the nearest set pixel above, then up from
/// below.
std::vector<double> column_distance_px(std::span<const std::uint8_t> mask, Extent size) {
    const std::size_t width = size.width;
    std::vector<double> distance(mask.size());
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const double above = i < width ? kInfinity : distance[i - width] + 1.0;
        distance[i] = mask[i] != 0 ? 0.0 : above;
    }
    for (std::size_t i = mask.size() - width; i-- > 0;) {
        distance[i] = std::min(distance[i], distance[i + width] + 1.0);
    }
    return distance;
}

/// The lower envelope of the parabolas (x - apex)² + height, one per finite pixel of a row.
///
/// All is exact: heights are integers below 2^33, so the quotient that separates two parabolas
/// rounds to the same side of every integer x.
class Envelope {
public:
    explicit Envelope(std::size_t width) : apex_(width), from_(width + 1), height_(width) {}

    /// Replaces the distances of one row by the squared distances in both directions.
    void transform(std::span<double> row) {
        build(row);
        if (count_ == 0) {
            for (double& value : row)
                value = kInfinity;
            return;
        }
        std::size_t k = 0;
        for (std::size_t x = 0; x < row.size(); ++x) {
            const double position = static_cast<double>(x);
            while (k + 1 < count_ && from_[k + 1] < position)
                ++k;
            row[x] = (position - apex_[k]) * (position - apex_[k]) + height_[k];
        }
    }

private:
    void build(std::span<const double> row) {
        count_ = 0;
        for (std::size_t x = 0; x < row.size(); ++x) {
            if (row[x] == kInfinity) continue;
            const double apex = static_cast<double>(x);
            const double height = row[x] * row[x];
            double from = -kInfinity;
            while (count_ > 0) {
                from = crossing(count_ - 1, apex, height);
                if (from > from_[count_ - 1]) break;
                --count_;
                from = -kInfinity;
            }
            apex_[count_] = apex;
            height_[count_] = height;
            from_[count_] = from;
            ++count_;
        }
    }

    /// Where the parabola of `apex` falls below the k-th, whose apex lies to the left.
    double crossing(std::size_t k, double apex, double height) const {
        return ((height + apex * apex) - (height_[k] + apex_[k] * apex_[k])) /
               (2.0 * (apex - apex_[k]));
    }

    std::vector<double> apex_;
    std::vector<double> from_;  // the k-th parabola is the lowest from here to from_[k + 1]
    std::vector<double> height_;
    std::size_t count_ = 0;
};

}  // namespace

std::vector<double> squared_distance_px2(std::span<const std::uint8_t> mask, Extent size) {
    assert(mask.size() == static_cast<std::size_t>(size.width) * size.height);
    if (mask.empty()) return {};
    std::vector<double> distance = column_distance_px(mask, size);
    parallel_for(size.height, kRowsPerTask, [&](std::size_t first, std::size_t last) {
        Envelope envelope(size.width);
        for (std::size_t y = first; y < last; ++y) {
            envelope.transform(std::span(distance).subspan(y * size.width, size.width));
        }
    });
    return distance;
}

}  // namespace gnomon::image
