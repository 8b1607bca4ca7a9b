#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// From a map's depths to its contents.

#include "visibility/contents/exponential.glsl"
#include "visibility/contents/exponential_variance.glsl"
#include "visibility/contents/moments.glsl"
#include "visibility/contents/packed.glsl"
#include "visibility/contents/packed_two.glsl"
#include "visibility/map_content.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint kContent = kContentVariance;

layout(set = 0, binding = 0) uniform sampler2DArray depths;
layout(set = 0, binding = 1) uniform writeonly image2DArray contents;
layout(push_constant, scalar) uniform Push { MapContentPush push; };

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(push.size)))) return;
    ivec3 texel = ivec3(gl_GlobalInvocationID.xy, push.layer);
    float depth = texelFetch(depths, texel, 0).x;
    vec2 uv = (vec2(texel.xy) + 0.5) / float(push.size);
    float far = distance_of(push.space, uv, depth);
    float along = distance_along(push.space, depth);
    vec4 content = vec4(far, 0.0, 0.0, 0.0);
    switch (kContent) {
        case kContentPacked:
            content = packed_in_four(far);
            break;
        case kContentPackedTwo:
            content = packed_in_two(far);
            break;
        case kContentExponential:
            content = vec4(warped(along, push.exponent), 0.0, 0.0, 0.0);
            break;
        case kContentVariance:
            content = vec4(along, along * along, 0.0, 0.0);
            break;
        case kContentExponentialVariance:
            content = warped_moments(along, push.exponent);
            break;
        case kContentMoments:
            content = powers(along);
            break;
    }
    imageStore(contents, texel, content);
}
