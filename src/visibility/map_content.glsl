// What a texel holds other than the depth that was drawn into it, and what it is compared with. Distances:
// P. Gerasimov, "Omnidirectional Shadow Mapping", GPU Gems 2004, chapter 12. Departure: distances are
// computed from depths by a pass over the map, so that casters are drawn as fast as for any content.

#ifndef GNOMON_VISIBILITY_MAP_CONTENT_GLSL
#define GNOMON_VISIBILITY_MAP_CONTENT_GLSL

#include "visibility/map_lookup.shared.h"

// How far from the light, 0 to 1, along its axis.
float distance_along(MapSpace space, float depth) {
    return space.reach > 0.0 ? space.reach / max(depth, space.reach) : 1.0 - depth;
}

// How far from the light, 0 to 1: for lights within the world, squared. `uv` is in the map, 0 to 1.
float distance_of(MapSpace space, vec2 uv, float depth) {
    float along = distance_along(space, depth);
    vec2 tangents = (2.0 * uv - 1.0) * space.tangents.xy + space.tangents.zw;
    return space.reach > 0.0 ? min(along * along * (1.0 + dot(tangents, tangents)), 1.0) : along;
}

// The depth that was stored as this distance.
float depth_of(MapSpace space, vec2 uv, float distance) {
    vec2 tangents = (2.0 * uv - 1.0) * space.tangents.xy + space.tangents.zw;
    float along = sqrt(max(distance, 0.0) / (1.0 + dot(tangents, tangents)));
    return space.reach > 0.0 ? space.reach / max(along, space.reach) : 1.0 - distance;
}

// How far off a stored distance may be for its number of bits.
float quantum(uint content) {
    return content == kContentPacked ? 1.0 / 8388608.0
                                     : (content == kContentPackedTwo ? 1.0 / 65536.0 : 0.0);
}

#endif
