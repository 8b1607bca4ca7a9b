// What an object map says of a receiver. Includers bind `map_depths` and `map_ids`, and declare
// `frame`.

#ifndef GNOMON_VISIBILITY_OBJECT_MAP_GLSL
#define GNOMON_VISIBILITY_OBJECT_MAP_GLSL

#include "visibility/object_map.shared.h"

const uint kNothing = 0xffffffffu;

// As a receiver's depth: behind everything, so that ids alone decide.
const float kBehindAll = -1.0;

// Does the texel's object leave light for the receiver's?
bool lit_by_texel(ivec2 texel, uint object, float depth) {
    uint nearest = imageLoad(map_ids, texel).x;
    bool own = nearest == object || nearest == kNothing;
    return own || texelFetch(map_depths, texel, 0).x <= depth;
}

// The four texels around a place, in rows.
vec4 lit_by_texels(vec2 texel, uint object, float depth) {
    ivec2 corner = ivec2(floor(texel - 0.5));
    ivec2 last = ivec2(frame.size_texels) - 1;
    vec4 lit;
    for (int i = 0; i < 4; ++i) {
        ivec2 at = clamp(corner + ivec2(i % 2, i / 2), ivec2(0), last);
        lit[i] = lit_by_texel(at, object, depth) ? 1.0 : 0.0;
    }
    return lit;
}

// A texel of another object hides the receiver when it is nearer to the light.
float lit_by_ids_and_depths(vec2 texel, uint object, float depth) {
    vec4 lit = lit_by_texels(texel, object, depth);
    vec2 f = fract(texel - 0.5);
    return mix(mix(lit.x, lit.y, f.x), mix(lit.z, lit.w, f.x), f.y);
}

// Of the four texels around a place one is the receiver's own if it is seen at all, wherever on its
// object's rim it is: it is lit by any of them.
float lit_by_ids(vec2 texel, uint object) {
    vec4 lit = lit_by_texels(texel, object, kBehindAll);
    return max(max(lit.x, lit.y), max(lit.z, lit.w));
}

#endif
