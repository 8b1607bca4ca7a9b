#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// A map's contents blurred along one axis, by a binomial's bell that ends at the radius.

#include "visibility/map_lookup.shared.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2DArray source;
layout(set = 0, binding = 1) uniform writeonly image2DArray target;
layout(push_constant, scalar) uniform Push { MapBlurPush push; };

// Of the bell's width, where it is cut off.
const float kSigmas = 2.0;

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(push.size)))) return;
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    int reach = int(ceil(push.radius_texels));
    float narrowness = kSigmas / max(push.radius_texels, 1e-3);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = -reach; i <= reach; ++i) {
        ivec2 at = clamp(texel + i * ivec2(push.step), ivec2(0), ivec2(push.size - 1u));
        float x = narrowness * float(i);
        float weight = exp(-0.5 * x * x);
        sum += weight * texelFetch(source, ivec3(at, push.layer), 0);
        weights += weight;
    }
    imageStore(target, ivec3(texel, push.layer), sum / weights);
}
