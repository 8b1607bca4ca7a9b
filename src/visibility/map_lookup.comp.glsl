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
layout(constant_id = 4) const uint kLayerChoice = kChooseByDistance;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 3) uniform sampler2DArray map;
layout(set = 0, binding = 4, scalar) uniform Frame { MapFrame frame; };
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

// Of pixels without a receiver, whose values are not used: keeps their places finite.
const float kLeastDepth = 1e-12;

// Of a filter's result.
const float kRounding = 1e-6;

struct Layer {
    MapLayerFrame map;
    float index;
};

// The last layer that begins before the receiver, or the one along whose axis it is farthest. All are read
// and one is chosen, number by number: an index that differs between pixels would be followed pixel by pixel.
Layer layer_of(float depth, vec3 p_ws) {
    Layer layer = Layer(frame.layers[0], 0.0);
    for (uint i = 1u; i < kLayerCount; ++i) {
        MapLayerFrame next = frame.layers[i];
        bool chosen = kLayerChoice == kChooseByDistance
                          ? depth < next.first_depth
                          : dot(next.w, vec4(p_ws, 1.0)) > dot(layer.map.w, vec4(p_ws, 1.0));
        layer.map.u = mix(layer.map.u, next.u, bvec4(chosen));
        layer.map.v = mix(layer.map.v, next.v, bvec4(chosen));
        layer.map.z = mix(layer.map.z, next.z, bvec4(chosen));
        layer.map.w = mix(layer.map.w, next.w, bvec4(chosen));
        layer.map.steps = mix(layer.map.steps, next.steps, bvec3(chosen));
        layer.index = chosen ? float(i) : layer.index;
    }
    return layer;
}

float filtered(MapPoint point, uvec2 pixel) {
    float size = frame.size_texels;
    switch (kFilter) {
        case kFilterNearest:
            return lit_nearest(map, size, point);
        case kFilterHardware2x2:
            return lit_bilinear(map, size, point, point.texel);
        case kFilterBox3x3:
            return lit_box_3x3(map, size, point);
        case kFilterDithered4:
            return lit_dithered_4(map, size, point, pixel);
    }
    return lit_box_4x4(map, size, point);
}

float lit_by_map(vec3 p_ws, TexelAt texel, Layer layer, uvec2 pixel) {
    vec4 p = vec4(p_ws, 1.0);
    vec3 uvz = vec3(dot(layer.map.u, p), dot(layer.map.v, p), dot(layer.map.z, p));
    float w = kAffine != 0u ? 1.0 : dot(layer.map.w, p);
    uvz /= w;
    float lit = filtered(MapPoint(frame.size_texels * uvz.xy, uvz.z,
                                  frame.bias.receiver_plane * texel.gradient, layer.index),
                         pixel);
    // Weights sum to 1 but for rounding: what is all but lit or dark is.
    lit = clamp((1.0 + 2.0 * kRounding) * lit - kRounding, 0.0, 1.0);
    // Maps that are chosen among by their axis hold all receivers, and so do the sun's; what the bias moves
    // across their border is looked up there.
    if (kLightKind == kLightDirectional || kLayerChoice == kChooseByAxis) return lit;
    bool inside = w > 0.0 && all(lessThanEqual(abs(uvz.xy - 0.5), vec2(0.5)));
    return inside ? lit : 1.0;
}

// Without branches: software drivers walk through both sides of each, and read constants and textures
// slowly within.
void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    ivec2 at = ivec2(min(pixel, push.size - 1u));
    float depth = texelFetch(depths, at, 0).x;
    vec3 p_ws = receiver_position(push.world_from_clip, pixel, push.size, max(depth, kLeastDepth));
    vec3 normal_ws = unpack_unit_vector(imageLoad(normals, at).x);
    vec3 to_light = normalize(to_light_ws(push.light, p_ws));
    Layer layer = layer_of(depth, p_ws);
    TexelAt texel = kAffine != 0u
                        ? affine_texel(layer.map, normal_ws, to_light)
                        : projective_texel(layer.map, frame.size_texels, p_ws, normal_ws);
    vec3 biased_ws = biased_position(p_ws, normal_ws, to_light, texel, frame.bias);
    float lit = lit_by_map(biased_ws, texel, layer, pixel);
    lit = faces_light(push.light, p_ws, normal_ws) ? lit : 0.0;
    if (all(lessThan(pixel, push.size))) {
        imageStore(visibility, at, vec4(depth > 0.0 ? lit : 1.0));
    }
}
