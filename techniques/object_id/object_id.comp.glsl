#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "object_id.shared.h"
#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 1) const uint kCompare = kCompareIdsAndDepths;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 3, rg32ui) uniform readonly uimage2D receiver_ids;
layout(set = 0, binding = 4) uniform sampler2D map_depths;
layout(set = 0, binding = 5, rg32ui) uniform readonly uimage2D map_ids;
layout(set = 0, binding = 6, scalar) uniform Frame { ObjectMapFrame frame; };
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

#include "visibility/object_map.glsl"

// Of pixels without a receiver, whose values are not used: keeps their places finite.
const float kLeastDepth = 1e-12;

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    ivec2 at = ivec2(min(pixel, push.size - 1u));
    float depth = texelFetch(depths, at, 0).x;
    vec3 p_es = receiver_position(push.es_from_clip, pixel, push.size, max(depth, kLeastDepth));
    vec3 normal_ws = unpack_unit_vector(imageLoad(normals, at).x);
    vec4 p = frame.clip_from_es * vec4(p_es, 1.0);
    vec3 p_ndc = p.xyz / p.w;
    uint object = imageLoad(receiver_ids, at).x;
    vec2 texel = frame.size_texels * (0.5 * p_ndc.xy + 0.5);
    float lit = kCompare == kCompareIds ? lit_by_ids(texel, object)
                                        : lit_by_ids_and_depths(texel, object, p_ndc.z);
    bool inside = p.w > 0.0 && all(lessThanEqual(abs(p_ndc.xy), vec2(1.0)));
    lit = inside || kLightKind == kLightDirectional ? lit : 1.0;
    lit = faces_light(push.light, p_es, normal_ws) ? lit : 0.0;
    if (all(lessThan(pixel, push.size))) {
        imageStore(visibility, at, vec4(depth > 0.0 ? lit : 1.0));
    }
}
