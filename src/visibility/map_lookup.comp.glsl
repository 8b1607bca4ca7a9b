#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Receivers against a depth map of any projection and up to eight layers.

#include "visibility/map_bias.glsl"
#include "visibility/map_filter.glsl"
#include "visibility/map_lookup.shared.h"
#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 1) const uint kFilter = kFilterBox4x4;
layout(constant_id = 2) const uint kLayerCount = 1u;
layout(constant_id = 3) const uint kAffine = 1u;  // all texels of a layer are of one size

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 3) uniform sampler2DArrayShadow map;  // linear, compares
layout(set = 0, binding = 4) uniform sampler2DArray map_depth;  // the same map, its values
layout(set = 0, binding = 5, scalar) uniform Frame { MapFrame frame; };
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

struct Layer {
    mat4 clip_from_world;
    vec3 texel_u_ws;
    vec3 texel_v_ws;
    float texel_m;
    float index;
};

Layer layer(uint i) {
    return Layer(frame.layers[i].clip_from_world, frame.layers[i].texel_u_ws,
                 frame.layers[i].texel_v_ws, frame.layers[i].texel_m, float(i));
}

// The last layer that begins before the receiver. Chosen value by value: constants are read for all
// pixels at once, and an index that differs between them would be followed pixel by pixel.
Layer layer_of(float depth) {
    Layer last = layer(0u);
    for (uint i = 1u; i < kLayerCount; ++i) {
        if (depth < frame.layers[i].first_depth) last = layer(i);
    }
    return last;
}

float lit_by_map(vec3 p_ws, Layer layer, uvec2 pixel) {
    vec4 p_cs = layer.clip_from_world * vec4(p_ws, 1.0);
    vec3 uvz = kAffine != 0u ? p_cs.xyz : p_cs.xyz / p_cs.w;
    uvz.xy = 0.5 * uvz.xy + 0.5;
    bool outside = any(lessThan(uvz.xy, vec2(0.0))) || any(greaterThan(uvz.xy, vec2(1.0)));
    if (p_cs.w <= 0.0 || outside) return 1.0;
    float size = frame.size_texels;
    switch (kFilter) {
        case kFilterNearest:
            return lit_nearest(map_depth, size, uvz, layer.index);
        case kFilterHardware2x2:
            return lit_hardware_2x2(map, uvz, layer.index);
        case kFilterBox3x3:
            return lit_box_3x3(map, size, uvz, layer.index);
        case kFilterDithered4:
            return lit_dithered_4(map, size, uvz, layer.index, pixel);
    }
    return lit_box_4x4(map, size, uvz, layer.index);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    float depth = texelFetch(depths, ivec2(pixel), 0).x;
    float lit = 1.0;
    if (depth > 0.0) {
        vec3 p_ws = receiver_position(push.world_from_clip, pixel, push.size, depth);
        vec3 normal_ws = unpack_unit_vector(imageLoad(normals, ivec2(pixel)).x);
        vec3 to_light = normalize(to_light_ws(push.light, p_ws));
        Layer layer = layer_of(depth);
        TexelAt texel = kAffine != 0u ? affine_texel(layer.texel_u_ws, layer.texel_v_ws,
                                                     layer.texel_m, normal_ws)
                                      : projective_texel(layer.clip_from_world, frame.size_texels,
                                                         p_ws, normal_ws);
        vec3 biased_ws = biased_position(p_ws, normal_ws, to_light, texel, frame.bias);
        lit = faces_light(push.light, p_ws, normal_ws) ? lit_by_map(biased_ws, layer, pixel) : 0.0;
    }
    imageStore(visibility, ivec2(pixel), vec4(lit));
}
