#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "owners.glsl"
#include "visibility/object_map.shared.h"
#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 3, rg32ui) uniform readonly uimage2D receiver_ids;
layout(set = 0, binding = 4) uniform sampler2D map_depths;
layout(set = 0, binding = 5, rg32ui) uniform readonly uimage2D map_ids;
layout(set = 0, binding = 6) uniform sampler2DArray coverage;
layout(set = 0, binding = 7, scalar) readonly buffer Chosen { Owners owners; };
layout(set = 0, binding = 8, scalar) uniform Frame { ObjectMapFrame frame; };
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

#include "visibility/object_map.glsl"

// Of pixels without a receiver, whose values are not used: keeps their places finite.
const float kLeastDepth = 1e-12;

// Of the blur's weight: an object of which there is less around a place is thinner than a texel.
const float kLeastPresent = 1e-2;

const float kUnknown = -1.0;

// Of what there is of the owner around the place, how much the light sees.
float lit_by_coverage(vec2 uv, uint channel) {
    vec4 both = textureLod(coverage, vec3(uv, channel / kOwnersPerLayer), 0.0);
    float lit = both[channel % kOwnersPerLayer];
    float present = both[kOwnersPerLayer + channel % kOwnersPerLayer];
    return present < kLeastPresent ? kUnknown : min(lit / present, 1.0);
}

float lit_by_map(vec3 p_ndc, uint object) {
    vec2 uv = 0.5 * p_ndc.xy + 0.5;
    uint channel = channel_number(object, owners);
    float lit = channel == kNoChannel ? kUnknown : lit_by_coverage(uv, channel);
    return lit != kUnknown ? lit : lit_by_ids_and_depths(frame.size_texels * uv, object, p_ndc.z);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    ivec2 at = ivec2(min(pixel, push.size - 1u));
    float depth = texelFetch(depths, at, 0).x;
    vec3 p_es = receiver_position(push.es_from_clip, pixel, push.size, max(depth, kLeastDepth));
    vec3 normal_ws = unpack_unit_vector(imageLoad(normals, at).x);
    vec4 p = frame.clip_from_es * vec4(p_es, 1.0);
    vec3 p_ndc = p.xyz / p.w;
    float lit = lit_by_map(p_ndc, imageLoad(receiver_ids, at).x);
    bool inside = p.w > 0.0 && all(lessThanEqual(abs(p_ndc.xy), vec2(1.0)));
    lit = inside || kLightKind == kLightDirectional ? lit : 1.0;
    lit = faces_light(push.light, p_es, normal_ws) ? lit : 0.0;
    if (all(lessThan(pixel, push.size))) {
        imageStore(visibility, at, vec4(depth > 0.0 ? lit : 1.0));
    }
}
