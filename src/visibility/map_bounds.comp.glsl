#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Between which two planes the depths of each tile of a map are: map_bounds.glsl tells what for.

#include "visibility/map_lookup.shared.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2DArray depths;
layout(set = 0, binding = 1, rgba32f) uniform writeonly image2DArray bounds;
layout(push_constant, scalar) uniform Push { MapBoundsPush push; };

// Of the numbers that a bound is added up from: four roundings of a part in 2^24 each.
const float kRounding = 1.0 / 4194304.0;

float depth_at(uvec2 texel) {
    return texelFetch(depths, ivec3(min(texel, push.size - 1u), push.layer), 0).x;
}

void main() {
    uvec2 tile = gl_GlobalInvocationID.xy;
    uint tiles = (push.size + kBoundsTile - 1u) / kBoundsTile;
    if (any(greaterThanEqual(tile, uvec2(tiles)))) return;
    uvec2 first = tile * kBoundsTile;
    uint last = kBoundsTile - 1u;
    // The plane through the corners, where they are on one.
    float d00 = depth_at(first);
    float d10 = depth_at(first + uvec2(last, 0u));
    float d01 = depth_at(first + uvec2(0u, last));
    float d11 = depth_at(first + last);
    vec2 gradient = 0.5 * vec2(d10 + d11 - d00 - d01, d01 + d11 - d00 - d10) / float(last);
    vec2 level = vec2(1.0, 0.0);  // least and greatest depth
    vec2 sloped = vec2(1e9, -1e9);  // and of what they are above a plane through the middle
    for (uint y = 0u; y < kBoundsTile; y += 2u) {
        for (uint x = 0u; x < kBoundsTile; x += 2u) {
            uvec2 corner = first + uvec2(x, y);
            vec2 uv = vec2(corner + 1u) / float(push.size);
            vec4 depth = textureGather(depths, vec3(uv, push.layer));
            vec2 d = vec2(x, y) - 0.5 * float(last);
            vec4 above = depth - gradient.x * (d.x + vec4(0.0, 1.0, 1.0, 0.0)) -
                         gradient.y * (d.y + vec4(1.0, 1.0, 0.0, 0.0));
            vec2 nearer = max(depth.xy, depth.zw);
            vec2 farther = min(depth.xy, depth.zw);
            vec2 higher = max(above.xy, above.zw);
            vec2 lower = min(above.xy, above.zw);
            level = vec2(min(level.x, min(farther.x, farther.y)),
                         max(level.y, max(nearer.x, nearer.y)));
            sloped =
                vec2(min(sloped.x, min(lower.x, lower.y)), max(sloped.y, max(higher.x, higher.y)));
        }
    }
    float rise = dot(abs(gradient), vec2(kBoundsTile));
    sloped += kRounding * (level.y + rise) * vec2(-1.0, 1.0);
    bool slopes = sloped.y - sloped.x < level.y - level.x;
    imageStore(bounds, ivec3(tile, push.layer),
               slopes ? vec4(gradient, sloped) : vec4(0.0, 0.0, level));
}
