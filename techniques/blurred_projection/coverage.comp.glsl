#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// What the light sees of each channel's owner, and where the owner is at all. Where it is not there
// is neither light nor shadow of it to blur, so that nothing falls on it from what is beside it.

#include "owners.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, rg32ui) uniform readonly uimage2D map_ids;
layout(set = 0, binding = 1) uniform sampler2D presence;
layout(set = 0, binding = 2, scalar) readonly buffer Chosen { Owners owners; };
layout(set = 0, binding = 3, rgba16f) uniform writeonly image2DArray coverage;
layout(push_constant, scalar) uniform Push { CoveragePush push; };

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(push.size)))) return;
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    vec4 present = texelFetch(presence, texel, 0);
    vec4 nearest = channel_of(imageLoad(map_ids, texel).x, owners);
    vec4 lit = present * nearest;
    imageStore(coverage, ivec3(texel, 0), vec4(lit.xy, present.xy));
    if (push.layers > 1u) imageStore(coverage, ivec3(texel, 1), vec4(lit.zw, present.zw));
}
