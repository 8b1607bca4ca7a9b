// Between texels, interpolating results blurs an edge over a texel, as interpolated times of the
// edge do not: over a plane the time at which a straight edge passes is smooth. Our own; matching
// by nearest times is that of contours between slices, in one dimension.

#include "bake/texel_edges.h"

#include "bake/interval_codes.h"
#include "bake/lookup.shared.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace gnomon::bake {

namespace {

using glm::dvec2;

// In double.
const double kLeastSpread = shared::kLeastSpread;
const double kMostSlowness = shared::kMostSlowness;
const double kLeastSlope = shared::kLeastSlope;
const double kLeastSine = shared::kLeastSine;
const double kMostApart = shared::kMostApart;
/// Of the path: shadows that pass in less, as those of wires, would make all the ground fine that
/// they sweep. Six minutes of thirteen hours.
constexpr double kShortest = 1.0 / 128.0;
constexpr std::size_t kMostIntervals = IntervalPage::kMostPairs * IntervalPage::kIntervalsPerPair;
constexpr std::size_t kNone = kMostIntervals;

/// Times of a texel, in codes.
struct Times {
    std::array<float, kMostIntervals> values;
    std::size_t count = 0;
    std::size_t end = kNone;  ///< the one that is no edge but the path's end; see PathEnds

    void add(float time) {
        assert(count < kMostIntervals);
        values[count++] = time;
    }
    /// The number of the nearest one, of two the earlier; kNone when there is none.
    std::size_t nearest(float time) const {
        std::size_t best = kNone;
        float least = std::numeric_limits<float>::infinity();
        for (std::size_t i = 0; i < count; ++i) {
            if (i == end) continue;
            const float apart = std::abs(values[i] - time);
            if (apart >= least) break;  // they are in order: the rest are farther
            least = apart;
            best = i;
        }
        return best;
    }
};

struct Edges {
    Times rises, falls;

    void add(float rise, float fall) {
        rises.add(rise);
        falls.add(fall);
    }
};

Edges edges_of(const IntervalPage& page, std::size_t texel) {
    Edges edges;
    const std::size_t most = IntervalPage::kIntervalsPerPair * static_cast<std::size_t>(page.pairs);
    for (std::size_t i = 0; i < most; ++i) {
        const std::size_t at = value_index(page, texel, i);
        if (page.rises[at] == IntervalPage::kNoRise) break;
        edges.add(page.rises[at], page.falls[at]);
    }
    return edges;
}

/// The same of a path that goes on beyond its ends: what is lit at both ends of a closed one goes
/// on over them, and what is lit at an end that is up goes on to be.
Edges edges_of(const IntervalPage& page, std::size_t texel, double path_codes,
               const PathEnds& ends) {
    constexpr auto kAlways = std::numeric_limits<float>::max();
    Edges edges = edges_of(page, texel);
    const std::size_t count = edges.rises.count;
    if (count == 0) return edges;
    const bool begins = edges.rises.values[0] == 0.0f;
    const bool lasts = static_cast<double>(edges.falls.values[count - 1]) >= path_codes;
    if (ends.closed) {
        if (!begins || !lasts) return edges;
        edges.rises.end = 0;
        edges.falls.end = count - 1;
        return edges;
    }
    if (ends.begins_up && begins) {
        edges.rises.end = 0;
        edges.rises.values[0] = -kAlways;
    }
    if (ends.ends_up && lasts) {
        edges.falls.end = count - 1;
        edges.falls.values[count - 1] = kAlways;
    }
    return edges;
}

/// Leaves out what is dark for less than `least`, then what is lit for less.
Edges without_short(const Edges& edges, float least) {
    Edges joined;
    for (std::size_t i = 0; i < edges.rises.count; ++i) {
        if (joined.rises.count > 0 &&
            edges.rises.values[i] - joined.falls.values[joined.falls.count - 1] < least) {
            joined.falls.values[joined.falls.count - 1] = edges.falls.values[i];
        } else {
            joined.add(edges.rises.values[i], edges.falls.values[i]);
        }
    }
    Edges result;
    for (std::size_t i = 0; i < joined.rises.count; ++i) {
        if (joined.falls.values[i] - joined.rises.values[i] >= least)
            result.add(joined.rises.values[i], joined.falls.values[i]);
    }
    return result;
}

/// The number of the edge of `others` that is the same as edge `edge` of `times`, or kNone.
std::size_t same_edge(const Times& times, std::size_t edge, const Times& others,
                      double path_codes) {
    const float own = times.values[edge];
    const std::size_t found = others.nearest(own);
    if (found == kNone || times.nearest(others.values[found]) != edge) return kNone;
    const auto apart = static_cast<double>(std::abs(others.values[found] - own));
    return apart <= kMostApart * path_codes ? found : kNone;
}

/// The least square plane through times at places.
class Plane {
public:
    void add(dvec2 place, double time) {
        ++count_;
        places_ += place;
        times_ += time;
        squares_ += DVec3(place.x * place.x, place.x * place.y, place.y * place.y);
        products_ += place * time;
    }

    /// Time per texel to the right and down; 0 when the places are nearly in a line.
    dvec2 slope() const {
        const dvec2 mean = places_ / count_;
        const DVec3 spread =
            squares_ - count_ * DVec3(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y);
        const dvec2 tilt = products_ - mean * times_;
        const double area = spread.x * spread.z - spread.y * spread.y;
        const double length2 = spread.x + spread.z;
        if (area <= kLeastSpread * length2 * length2) return dvec2(0.0);
        return dvec2(spread.z * tilt.x - spread.y * tilt.y, spread.x * tilt.y - spread.y * tilt.x) /
               area;
    }

private:
    double count_ = 0.0, times_ = 0.0;
    dvec2 places_{0.0}, products_{0.0};
    DVec3 squares_{0.0};  ///< xx, xy, yy
};

/// A texel's edge at the receiver.
struct MovedEdge {
    double time = 0.0;
    double slowness = 1.0;  ///< how much longer it takes to cross the disc than one across the path
};

MovedEdge moved(std::span<const Times, 4> times, const BetweenTexels& between, std::size_t texel,
                std::size_t edge) {
    if (edge == times[texel].end) return {.time = static_cast<double>(times[texel].values[edge])};
    Plane plane;
    double weight = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const std::size_t same =
            i == texel ? edge : same_edge(times[texel], edge, times[i], between.path_codes);
        if (same == kNone) continue;
        const auto time = static_cast<double>(times[i].values[same]);
        plane.add(between.places_texels[i], time);
        weight += between.weights[i];
        sum += between.weights[i] * time;
    }
    MovedEdge result{.time = sum / weight};
    const dvec2 slope = plane.slope();
    if (glm::length(slope) < kLeastSlope) return result;
    const dvec2 normal = between.normal_from_slope * slope;
    // An edge that is nearly along the path may seem to go backwards.
    const double length = glm::length(normal);
    if (length > 0.0) result.slowness = std::min(length / std::abs(normal.x), kMostSlowness);
    return result;
}

/// The part of the window that comes after an edge, at its places one after the other.
double part_after(const MovedEdge& edge, const LightWindow& window, const WindowPlaces& places) {
    const double width = window.width_steps * window.codes_per_step;
    double sum = 0.0;
    for (std::size_t place = 0; place < places.count; ++place) {
        sum += seen_part(edge.time, std::numeric_limits<double>::max(), places.at[place],
                         width * (window.even ? 1.0 : edge.slowness), window.even);
    }
    return sum;
}

}  // namespace

glm::dmat2 normal_from_slope(DVec3 u_ws, DVec3 v_ws, DVec3 along_ws, DVec3 across_ws) {
    // An edge that is seen at distance h passes a point p when n . (p - edge) = 0, n its normal in
    // the sky: its time t has grad t = -n / (h speed n.along) there, on the surface.
    const glm::dmat2 slope_from_normal(-glm::dot(along_ws, u_ws), -glm::dot(along_ws, v_ws),
                                       -glm::dot(across_ws, u_ws), -glm::dot(across_ws, v_ws));
    const double texel_m2 = glm::length(glm::cross(u_ws, v_ws));
    if (std::abs(glm::determinant(slope_from_normal)) < kLeastSine * texel_m2)
        return glm::dmat2(0.0);
    return glm::inverse(slope_from_normal);
}

bool have_same_edges(const IntervalPage& page, const FourTexels& texels, double path_codes) {
    const auto least = static_cast<float>(kShortest * path_codes);
    std::array<Edges, 4> edges;
    for (std::size_t i = 0; i < texels.size(); ++i)
        edges[i] = without_short(edges_of(page, texels[i]), least);
    const auto are_same = [&](const Times& a, const Times& b) {
        if (a.count != b.count) return false;
        for (std::size_t i = 0; i < a.count; ++i) {
            if (same_edge(a, i, b, path_codes) != i) return false;
        }
        return true;
    };
    for (std::size_t a = 0; a < edges.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            if (!are_same(edges[a].rises, edges[b].rises)) return false;
            if (!are_same(edges[a].falls, edges[b].falls)) return false;
        }
    }
    return true;
}

double edges_visibility(const IntervalPage& page, const BetweenTexels& between,
                        const LightWindow& window) {
    std::array<Times, 4> rises;
    std::array<Times, 4> falls;
    for (std::size_t i = 0; i < between.texels.size(); ++i) {
        const Edges edges = edges_of(page, between.texels[i], between.path_codes, window.ends);
        rises[i] = edges.rises;
        falls[i] = edges.falls;
    }
    const WindowPlaces places = window_places(window);
    double seen = 0.0;
    for (std::size_t i = 0; i < between.texels.size(); ++i) {
        if (!(between.weights[i] > 0.0)) continue;
        for (std::size_t k = 0; k < rises[i].count; ++k) {
            seen += between.weights[i] * (part_after(moved(rises, between, i, k), window, places) -
                                          part_after(moved(falls, between, i, k), window, places));
        }
    }
    return std::clamp(seen, 0.0, 1.0);
}

}  // namespace gnomon::bake
