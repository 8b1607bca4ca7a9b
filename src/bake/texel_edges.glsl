// edges_visibility() of texel_edges.cpp, which has the sources and reasons, for shaders: includers
// have an array `intervals`, a rise and in the upper half a fall each, and kEven.

#ifndef GNOMON_BAKE_TEXEL_EDGES_GLSL
#define GNOMON_BAKE_TEXEL_EDGES_GLSL

#include "bake/lookup.shared.h"

const float kPi = 3.14159265;

// Of an interval's word.
const int kTimeBits = 16;
const int kRise = 0;
const int kFall = kTimeBits;

const uint kNoEdge = 0xffffffffu;

// The light's window on its path.
struct Window {
    float at_codes;
    float width_codes;
    float path_codes;
    uint ends;               // of PathEnds, as bits
    mat2 normal_from_slope;  // see bake::normal_from_slope()
};

// Of one texel.
struct Times {
    uint first;  // in `intervals`
    uint count;
};

// A receiver between four texels: first row, second row.
struct Between {
    Times times[4];
    float weights[4];  // sum to 1
    vec2 places[4];    // where the texels ask, from the receiver, in texels
};

float time_of(Times times, uint number, int kind) {
    return float(bitfieldExtract(intervals[times.first + number], kind, kTimeBits));
}

// The part of a window that comes after a time `ahead_codes` after its middle.
float part_after(float ahead_codes, float width_codes) {
    if (2.0 * abs(ahead_codes) >= width_codes) return ahead_codes <= 0.0 ? 1.0 : 0.0;
    float x = 2.0 * ahead_codes / width_codes;
    if (kEven) return 0.5 - 0.5 * x;
    float half_chord = sqrt(1.0 - x * x);
    // The arc sine: that of Mesa errs by 3e-4, its arc tangent does not.
    return 0.5 - (x * half_chord + atan(x, half_chord)) / kPi;
}

bool has_end(Window window, uint end) {
    return (window.ends & end) != 0u;
}

// Whether it is no edge but the path's end, over which the texel goes on to be lit.
bool is_path_end(Times times, uint number, int kind, Window window) {
    if (number != (kind == kRise ? 0u : times.count - 1u)) return false;
    bool begins = time_of(times, 0u, kRise) == 0.0;
    bool lasts = time_of(times, times.count - 1u, kFall) == window.path_codes;
    if (has_end(window, kClosed)) return begins && lasts;
    return kind == kRise ? begins && has_end(window, kBeginsUp) : lasts && has_end(window, kEndsUp);
}

// The number of the edge of `others` that is the same as edge `edge` of `times`, or kNoEdge.
uint same_edge(Times times, uint edge, Times others, int kind, Window window) {
    float own = time_of(times, edge, kind);
    uint found = kNoEdge;
    float least = kMostApart * window.path_codes;
    for (uint i = 0u; i < others.count; ++i) {
        float ahead = time_of(others, i, kind) - own;
        if (ahead > least) break;
        if (is_path_end(others, i, kind, window)) continue;
        // Of two that are equally near it is the earlier.
        if (abs(ahead) < least || (abs(ahead) == least && found == kNoEdge)) {
            least = abs(ahead);
            found = i;
        }
    }
    if (found == kNoEdge) return kNoEdge;
    // Times are in order: an edge that is nearer to it than this one is the one before or after.
    float time = time_of(others, found, kind);
    float apart = abs(time - own);
    if (edge > 0u && !is_path_end(times, edge - 1u, kind, window) &&
        abs(time - time_of(times, edge - 1u, kind)) <= apart)
        return kNoEdge;
    if (edge + 1u < times.count && !is_path_end(times, edge + 1u, kind, window) &&
        abs(time - time_of(times, edge + 1u, kind)) < apart)
        return kNoEdge;
    return found;
}

// The least square plane through times at places, from sums over them.
struct Plane {
    float count;
    float times;
    vec2 places;
    vec2 products;
    vec3 squares;  // xx, xy, yy
};

void add(inout Plane plane, vec2 place, float time) {
    plane.count += 1.0;
    plane.times += time;
    plane.places += place;
    plane.products += place * time;
    plane.squares += vec3(place.x * place.x, place.x * place.y, place.y * place.y);
}

// Time per texel to the right and down; 0 when the places are nearly in a line.
vec2 slope_of(Plane plane) {
    vec2 mean = plane.places / plane.count;
    vec3 spread =
        plane.squares - plane.count * vec3(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y);
    vec2 tilt = plane.products - mean * plane.times;
    float area = spread.x * spread.z - spread.y * spread.y;
    float length2 = spread.x + spread.z;
    if (area <= kLeastSpread * length2 * length2) return vec2(0.0);
    return vec2(spread.z * tilt.x - spread.y * tilt.y, spread.x * tilt.y - spread.y * tilt.x) /
           area;
}

// The part of the window that comes after an edge of a texel, once that has been moved.
float part_after_edge(Between between, uint texel, uint edge, int kind, Window window) {
    float own = time_of(between.times[texel], edge, kind);
    if (is_path_end(between.times[texel], edge, kind, window)) {
        if (has_end(window, kClosed)) return part_after(own - window.at_codes, window.width_codes);
        return kind == kRise ? 1.0 : 0.0;
    }
    Plane plane = Plane(0.0, 0.0, vec2(0.0), vec2(0.0), vec3(0.0));
    float weight = 0.0;
    float sum = 0.0;
    for (uint i = 0u; i < 4u; ++i) {
        uint same = i == texel ? edge
                               : same_edge(between.times[texel], edge, between.times[i], kind,
                                           window);
        if (same == kNoEdge) continue;
        float later = time_of(between.times[i], same, kind) - own;  // small: exact
        add(plane, between.places[i], later);
        weight += between.weights[i];
        sum += between.weights[i] * later;
    }
    vec2 slope = slope_of(plane);
    vec2 normal = length(slope) < kLeastSlope ? vec2(0.0) : window.normal_from_slope * slope;
    float size = length(normal);
    float slowness = size > 0.0 ? size / max(abs(normal.x), size / kMostSlowness) : 1.0;
    return part_after(own - window.at_codes + sum / weight,
                      window.width_codes * (kEven ? 1.0 : slowness));
}

// Edges farther from the window's middle do not come into it wherever they are moved to.
float reach_of(Window window) {
    return kMostApart * window.path_codes + 0.5 * kMostSlowness * window.width_codes;
}

float part_seen(Between between, Window window) {
    float reach = reach_of(window);
    float seen = 0.0;
    for (uint i = 0u; i < 4u; ++i) {
        if (!(between.weights[i] > 0.0)) continue;
        for (uint k = 0u; k < between.times[i].count; ++k) {
            float rise = time_of(between.times[i], k, kRise) - window.at_codes;
            float fall = time_of(between.times[i], k, kFall) - window.at_codes;
            if (rise > reach) break;
            if (fall < -reach) continue;
            float after_rise =
                rise < -reach ? 1.0 : part_after_edge(between, i, k, kRise, window);
            float after_fall = fall > reach ? 0.0 : part_after_edge(between, i, k, kFall, window);
            seen += between.weights[i] * (after_rise - after_fall);
        }
    }
    return seen;
}

float edges_visibility(Between between, Window window) {
    float seen = part_seen(between, window);
    // A window of a closed path is also one path before or after its place.
    if (has_end(window, kClosed) && min(window.at_codes, window.path_codes - window.at_codes) < reach_of(window)) {
        window.at_codes +=
            window.at_codes < 0.5 * window.path_codes ? window.path_codes : -window.path_codes;
        seen += part_seen(between, window);
    }
    return clamp(seen, 0.0, 1.0);
}

#endif
