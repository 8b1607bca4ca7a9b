#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    float depth = texelFetch(depths, ivec2(pixel), 0).x;
    float lit = 1.0;
    if (depth > 0.0) {
        vec3 p_es = receiver_position(push.es_from_clip, pixel, push.size, depth);
        vec3 normal_ws = unpack_unit_vector(imageLoad(normals, ivec2(pixel)).x);
        lit = faces_light(push.light, p_es, normal_ws) ? 1.0 : 0.0;
    }
    imageStore(visibility, ivec2(pixel), vec4(lit));
}
