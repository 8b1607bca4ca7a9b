#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// From bounds of tiles to those of tiles with their neighbours, so that one texel bounds all that a
// filter anywhere in the tile reads.

#include "visibility/map_lookup.shared.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2DArray tiles;
layout(set = 0, binding = 1, rgba32f) uniform writeonly image2DArray bounds;
layout(push_constant, scalar) uniform Push { MapBoundsPush push; };

const float kTile = float(kBoundsTile);

// Of the numbers that a bound is added up from: four roundings of a part in 2^24 each.
const float kRounding = 1.0 / 4194304.0;

// Of a tile's depths over a plane through the middle of another, from which the tile is so many
// tiles away: least and greatest.
vec2 over_plane(vec4 tile, vec2 gradient, vec2 away) {
    float rise = kTile * dot(gradient, away);
    float most = 0.5 * (kTile - 1.0) * dot(abs(tile.xy - gradient), vec2(1.0));
    most += kRounding * (kTile * dot(abs(gradient), abs(away)) + most + abs(tile.z) + abs(tile.w));
    return tile.zw - rise + vec2(-most, most);
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    int last = int((push.size + kBoundsTile - 1u) / kBoundsTile) - 1;
    if (any(greaterThan(at, ivec2(last)))) return;
    int layer = int(push.layer);
    int rings = int(push.rings);
    vec2 gradient = texelFetch(tiles, ivec3(at, layer), 0).xy;
    vec2 level = vec2(1e9, -1e9);
    vec2 sloped = vec2(1e9, -1e9);
    for (int y = -rings; y <= rings; ++y) {
        for (int x = -rings; x <= rings; ++x) {
            ivec2 other = clamp(at + ivec2(x, y), ivec2(0), ivec2(last));
            vec4 tile = texelFetch(tiles, ivec3(other, layer), 0);
            vec2 flat_range = over_plane(tile, vec2(0.0), vec2(0.0));
            vec2 range = over_plane(tile, gradient, vec2(other - at));
            level = vec2(min(level.x, flat_range.x), max(level.y, flat_range.y));
            sloped = vec2(min(sloped.x, range.x), max(sloped.y, range.y));
        }
    }
    bool slopes = sloped.y - sloped.x < level.y - level.x;
    imageStore(bounds, ivec3(at, push.bounds_layer),
               slopes ? vec4(gradient, sloped) : vec4(0.0, 0.0, level));
}
