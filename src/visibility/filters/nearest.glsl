// The texel that the receiver is in.

#ifndef GNOMON_VISIBILITY_FILTERS_NEAREST_GLSL
#define GNOMON_VISIBILITY_FILTERS_NEAREST_GLSL

#include "visibility/map_filter.glsl"

float lit_nearest(sampler2DArray map, float size, MapBias bias, MapPoint point) {
    vec2 texel = clamp(floor(point.texel), 0.0, size - 1.0);
    vec2 d = texel + 0.5 - point.texel;
    float plane = plane_depths(point, vec4(d.x), vec4(d.y)).x;
    float stored = stored_distance(map, size, texel, point);
    if (kStoresDepths) return plane >= stored ? 1.0 : 0.0;
    return compared_distance(point, bias, size, texel, plane) <= stored ? 1.0 : 0.0;
}

#endif
