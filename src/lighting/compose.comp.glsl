#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// From summed light to the picture: ambient, composition, exposure, sRGB.

#include "lighting/lighting.shared.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1) uniform sampler2D albedos;
layout(set = 0, binding = 2, rgba32f) uniform readonly image2D lit_sum;
layout(set = 0, binding = 3, rgba32f) uniform readonly image2D full_sum;
layout(set = 0, binding = 4, rgba32f) uniform writeonly image2D picture;
layout(push_constant, scalar) uniform Push { ComposePush push; };

vec3 srgb_from_linear(vec3 linear) {  // IEC 61966-2-1
    vec3 low = 12.92 * linear;
    vec3 high = 1.055 * pow(max(linear, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, lessThanEqual(linear, vec3(0.0031308)));
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    ivec2 at = ivec2(pixel);
    vec3 color = push.background_srgb;
    if (texelFetch(depths, at, 0).x > 0.0) {
        vec3 ambient = push.ambient * texelFetch(albedos, at, 0).rgb;
        vec4 lit = imageLoad(lit_sum, at);
        vec3 radiance = push.subtractive != 0u
                            ? (ambient + imageLoad(full_sum, at).rgb) * lit.a
                            : ambient + lit.rgb;
        color = srgb_from_linear(clamp(push.exposure * radiance, 0.0, 1.0));
    }
    imageStore(picture, at, vec4(color, 1.0));
}
