// Charts by coplanarity and adjacency, grown face by face from the largest, as in B. Levy,
// S. Petitjean, N. Ray, J. Maillot, "Least Squares Conformal Maps for Automatic Texture Atlas
// Generation", SIGGRAPH 2002, section 3.2. Departures: the projection is parallel, as what is baked
// wants texels of one size in metres and planes rather than few seams; so normals are compared with
// the first face's; a chart that would cover itself is cut, and so is one that leaves room empty.

#include "lightmap/charts.h"

#include "base/smallest_rectangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::lightmap {

namespace {

/// A corner this far off the chart's plane, relative to the face's longest edge, is on it: a
/// sliver's normal turns by far more than its corners move.
constexpr double kOnPlane = 1e-4;
/// But it must be seen well from the chart's front: cosine to the chart's normal.
constexpr double kLeastOnPlaneCosine = 0.5;

/// A compact chart covers this part of its rectangle: a bit less than a triangle does.
constexpr double kCompact = 0.45;
/// Cutting a chart must save this part of its room: each cut is a seam.
constexpr double kWorthCutting = 0.25;

/// How much of a longer side's square counts as area: too little to prefer larger rectangles.
constexpr double kTie = 1e-3;

/// The largest first.
void by_area(const std::vector<Face>& faces, std::vector<std::uint32_t>& indices) {
    std::ranges::sort(indices, [&](std::uint32_t a, std::uint32_t b) {
        return faces[a].area_m2 != faces[b].area_m2 ? faces[a].area_m2 > faces[b].area_m2 : a < b;
    });
}

class Grower {
public:
    Grower(const Surface& surface, const std::vector<std::uint32_t>& wanted,
           const ChartLimits& limits)
        : surface_(surface),
          faces_(surface.faces()),
          limits_(limits),
          least_cosine_(std::cos(limits.normal_rad)),
          states_(faces_.size(), State::taken) {
        for (const std::uint32_t face : wanted)
            states_[face] = State::free;
    }

    bool is_free(std::uint32_t face) const { return states_[face] == State::free; }

    /// The chart that grows from a free face, or its parts.
    std::vector<GrownChart> grow(std::uint32_t seed) {
        GrownChart chart = grow_over(seed, State::free);
        if (chart.area_m2 < kCompact * chart.size_m.x * chart.size_m.y) {
            std::vector<GrownChart> parts = cut(chart);
            double room = 0.0;
            for (const GrownChart& part : parts)
                room += room_of(part);
            if (room <= (1.0 - kWorthCutting) * room_of(chart)) return parts;
        }
        return {std::move(chart)};
    }

private:
    enum class State : std::uint8_t { taken, free, to_cut };

    double room_of(const GrownChart& chart) const {
        return (chart.size_m.x + limits_.padding_m) * (chart.size_m.y + limits_.padding_m);
    }

    std::vector<GrownChart> cut(const GrownChart& chart) {
        std::vector<std::uint32_t> seeds = chart.faces;
        by_area(faces_, seeds);
        for (const std::uint32_t face : seeds)
            states_[face] = State::to_cut;
        std::vector<GrownChart> parts;
        for (const std::uint32_t seed : seeds) {
            if (states_[seed] == State::to_cut) parts.push_back(grow_over(seed, State::to_cut));
        }
        return parts;
    }

    /// Over faces of one state. Those to cut join while the chart stays compact; others may make
    /// room for them, so they are asked again.
    GrownChart grow_over(std::uint32_t seed, State state) {
        GrownChart chart;
        begin(seed);
        take(seed, chart);
        std::size_t before = 0;
        do {
            before = chart.faces.size();
            for (std::size_t i = 0; i < chart.faces.size(); ++i) {
                for (int edge = 0; edge < 3; ++edge) {
                    for (const std::uint32_t next : surface_.across(chart.faces[i], edge)) {
                        if (states_[next] == state && joins(next, state, chart)) take(next, chart);
                    }
                }
            }
        } while (state == State::to_cut && chart.faces.size() > before);
        fit_rectangle(chart);
        return chart;
    }

    /// Along the edge whose rectangle around the face is least; of a right-angled triangle's, which
    /// are equally large, along a leg: the other half of its square then fits the limit.
    void begin(std::uint32_t seed) {
        const Face& face = faces_[seed];
        const auto& c = face.corners_ws;
        const auto room = [&](std::size_t i) {
            const DVec3 edge_ws = c[(i + 1) % 3] - c[i];
            const double length_m = glm::length(edge_ws);
            const double along_m = glm::dot(c[(i + 2) % 3] - c[i], edge_ws) / length_m;
            const double width_m = std::max(length_m, along_m) - std::min(0.0, along_m);
            const double height_m = 2.0 * face.area_m2 / length_m;
            // The longer side decides between nearly equal ones.
            return width_m * height_m + kTie * std::pow(std::max(width_m, height_m), 2.0);
        };
        std::size_t best = 0;
        for (std::size_t i = 1; i < 3; ++i) {
            if (room(i) < room(best)) best = i;
        }
        origin_ws_ = c[best];
        normal_ws_ = face.normal_ws;
        right_ws_ = glm::normalize(c[(best + 1) % 3] - c[best]);
        up_ws_ = glm::cross(normal_ws_, right_ws_);
        low_m_ = high_m_ = dvec2(0.0);
        points_m_.clear();
    }

    dvec2 flat_m(DVec3 p_ws) const {
        return {glm::dot(right_ws_, p_ws - origin_ws_), glm::dot(up_ws_, p_ws - origin_ws_)};
    }

    bool joins(std::uint32_t index, State state, const GrownChart& chart) const {
        const Face& face = faces_[index];
        if (glm::dot(face.normal_ws, normal_ws_) < least_cosine_ && !lies_on_plane(face)) {
            return false;
        }
        dvec2 low = low_m_;
        dvec2 high = high_m_;
        for (const DVec3 corner : face.corners_ws) {
            low = glm::min(low, flat_m(corner));
            high = glm::max(high, flat_m(corner));
        }
        const dvec2 size = high - low;
        if (std::max(size.x, size.y) > limits_.side_m) return false;
        return state == State::free || chart.area_m2 + face.area_m2 >= kCompact * size.x * size.y;
    }

    bool lies_on_plane(const Face& face) const {
        if (glm::dot(face.normal_ws, normal_ws_) < kLeastOnPlaneCosine) return false;
        const auto& c = face.corners_ws;
        const double tolerance_m =
            kOnPlane * std::max(glm::distance(c[0], c[1]), glm::distance(c[0], c[2]));
        return std::ranges::all_of(c, [&](DVec3 p) {
            return std::abs(glm::dot(normal_ws_, p - origin_ws_)) <= tolerance_m;
        });
    }

    void take(std::uint32_t index, GrownChart& chart) {
        states_[index] = State::taken;
        chart.faces.push_back(index);
        chart.area_m2 += faces_[index].area_m2;
        for (const DVec3 corner : faces_[index].corners_ws) {
            points_m_.push_back(flat_m(corner));
            low_m_ = glm::min(low_m_, points_m_.back());
            high_m_ = glm::max(high_m_, points_m_.back());
        }
    }

    void fit_rectangle(GrownChart& chart) const {
        dvec2 axis(1.0, 0.0);
        const Rectangle smallest = smallest_rectangle(points_m_);
        // It may be longer than the box that was kept within the limit.
        if (std::max(smallest.size.x, smallest.size.y) <= limits_.side_m) axis = smallest.axis;
        DVec3 right = axis.x * right_ws_ + axis.y * up_ws_;
        DVec3 down = -glm::cross(normal_ws_, right);
        const auto measure = [&] {
            dvec2 low(std::numeric_limits<double>::infinity());
            dvec2 high = -low;
            for (const dvec2 p : points_m_) {
                const DVec3 p_ws = origin_ws_ + p.x * right_ws_ + p.y * up_ws_;
                const dvec2 flat(glm::dot(right, p_ws), glm::dot(down, p_ws));
                low = glm::min(low, flat);
                high = glm::max(high, flat);
            }
            chart.corner_m = low;
            chart.size_m = high - low;
        };
        measure();
        if (chart.size_m.x < chart.size_m.y) {
            std::swap(right, down);
            right = -right;
            measure();
        }
        chart.right_ws = right;
        chart.down_ws = down;
    }

    const Surface& surface_;
    const std::vector<Face>& faces_;
    ChartLimits limits_;
    double least_cosine_;
    std::vector<State> states_;

    // Of the chart that grows.
    DVec3 origin_ws_{0.0}, normal_ws_{0.0}, right_ws_{0.0}, up_ws_{0.0};
    dvec2 low_m_{0.0}, high_m_{0.0};
    std::vector<dvec2> points_m_;
};

}  // namespace

std::vector<GrownChart> grow_charts(const Surface& surface, std::vector<std::uint32_t> wanted,
                                    const ChartLimits& limits) {
    Grower grower(surface, wanted, limits);
    by_area(surface.faces(), wanted);
    std::vector<GrownChart> charts;
    for (const std::uint32_t seed : wanted) {
        if (!grower.is_free(seed)) continue;
        for (GrownChart& chart : grower.grow(seed))
            charts.push_back(std::move(chart));
    }
    return charts;
}

unsigned texels_for(double length_texels) {
    return static_cast<unsigned>(std::max(1.0, std::ceil(length_texels - kBorder_texels)));
}

FlatChart flatten(const Surface& surface, const GrownChart& chart, double texel_size_m) {
    const dvec2 size = chart.size_m / texel_size_m;
    FlatChart flat{.size = {texels_for(size.x), texels_for(size.y)}};
    // Half of what is left at each side, so that the centres of the outermost texels of a rectangle
    // lie inside it.
    const dvec2 margin = 0.5 * (dvec2(flat.size.width, flat.size.height) - size);
    flat.corners.reserve(chart.faces.size());
    for (const std::uint32_t face : chart.faces) {
        Corners& corners = flat.corners.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
            corners[i] = chart.flat_m(surface.faces()[face].corners_ws[i]) / texel_size_m + margin;
        }
    }
    return flat;
}

std::vector<std::uint32_t> remove_overlaps(GrownChart& chart, const FlatChart& flat) {
    if (chart.faces.size() == 1) return {};
    const std::size_t width = flat.size.width;
    std::vector<std::uint8_t> taken(width * flat.size.height, 0);
    // Calls visit(texel) for the centres in a face, without those that rounding puts outside.
    const auto for_texels = [&](const Corners& corners, const auto& visit) {
        for_centres(corners, [&](int y, int begin, int end) {
            if (y < 0 || y >= static_cast<int>(flat.size.height)) return;
            for (int x = std::max(begin, 0); x < std::min(end, static_cast<int>(width)); ++x)
                visit(taken[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)]);
        });
    };
    std::vector<std::uint32_t> kept;
    std::vector<std::uint32_t> removed;
    for (std::size_t i = 0; i < chart.faces.size(); ++i) {
        bool overlaps = false;
        for_texels(flat.corners[i], [&](std::uint8_t texel) { overlaps |= texel != 0; });
        (overlaps ? removed : kept).push_back(chart.faces[i]);
        if (!overlaps) for_texels(flat.corners[i], [](std::uint8_t& texel) { texel = 1; });
    }
    chart.faces = std::move(kept);
    return removed;
}

}  // namespace gnomon::lightmap
