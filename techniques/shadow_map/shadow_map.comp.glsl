#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "shadow_map.shared.h"
#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 1) const uint kFilter = kFilterBox4x4;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 3) uniform sampler2DShadow map;  // linear, compares
layout(set = 0, binding = 4) uniform sampler2D map_depth;  // the same map, its values
layout(set = 0, binding = 5, scalar) uniform Frame { ShadowMapFrame frame; };
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

// A surface at 84° to the light; steeper ones are biased as this one.
const float kMaxSlope = 10.0;

// Where the receiver is looked up: moved off its surface and towards the light, in world units that
// follow the texel, so that the filter's texels of its own plane never hide it.
vec3 biased_position(vec3 p_ws, vec3 normal_ws) {
    vec3 to_light = normalize(to_light_ws(push.light, p_ws));
    float along_axis = max(dot(p_ws - frame.eye_ws, frame.axis_ws), 0.0);
    float texel_m = frame.texel_m * mix(1.0, along_axis, frame.perspective);
    // Depths are compared along the map's axis: from there a plane's slope counts, in perspective too.
    float cosine = dot(normal_ws, mix(to_light, -frame.axis_ws, frame.perspective));
    float sine = sqrt(max(0.0, 1.0 - cosine * cosine));
    float slope = cosine > 0.0 ? min(sine / cosine, kMaxSlope) : kMaxSlope;
    float reach_m = frame.reach_texels * texel_m;
    return p_ws + normal_ws * (frame.normal_offset * reach_m * sine) +
           to_light * (frame.bias_constant * texel_m + frame.bias_slope * reach_m * slope);
}

float lit_nearest(vec3 uvz) {
    ivec2 size = textureSize(map_depth, 0);
    ivec2 texel = clamp(ivec2(floor(uvz.xy * size)), ivec2(0), size - 1);
    return uvz.z >= texelFetch(map_depth, texel, 0).x ? 1.0 : 0.0;
}

// Nine bilinear comparisons side by side, which are the 4x4 nearest ones with weights 1-f, 1, 1, f:
// 16 taps in four gathers, without a step where the receiver moves to the next texel.
float lit_box_4x4(vec3 uvz) {
    vec2 size = vec2(textureSize(map_depth, 0));
    vec2 corner = uvz.xy * size - 0.5;
    vec2 f = fract(corner);
    vec2 uv = (floor(corner) + 0.5) / size;  // centre of the texel left above of the receiver
    vec2 step_uv = 1.0 / size;
    vec4 a = textureGather(map, uv + vec2(-0.5, -0.5) * step_uv, uvz.z);
    vec4 b = textureGather(map, uv + vec2(1.5, -0.5) * step_uv, uvz.z);
    vec4 c = textureGather(map, uv + vec2(-0.5, 1.5) * step_uv, uvz.z);
    vec4 d = textureGather(map, uv + vec2(1.5, 1.5) * step_uv, uvz.z);
    // A gather gives (left, below), (right, below), (right, above), (left, above).
    vec4 wx = vec4(1.0 - f.x, 1.0, 1.0, f.x);
    float row0 = dot(wx, vec4(a.w, a.z, b.w, b.z));
    float row1 = dot(wx, vec4(a.x, a.y, b.x, b.y));
    float row2 = dot(wx, vec4(c.w, c.z, d.w, d.z));
    float row3 = dot(wx, vec4(c.x, c.y, d.x, d.y));
    return ((1.0 - f.y) * row0 + row1 + row2 + f.y * row3) / 9.0;
}

float lit_by_map(vec3 p_ws) {
    vec4 p_ls = frame.clip_from_world * vec4(p_ws, 1.0);
    if (p_ls.w <= 0.0) return 1.0;  // behind a spot
    vec3 uvz = vec3(0.5 * p_ls.xy / p_ls.w + 0.5, p_ls.z / p_ls.w);
    if (any(lessThan(uvz.xy, vec2(0.0))) || any(greaterThan(uvz.xy, vec2(1.0)))) return 1.0;
    switch (kFilter) {
        case kFilterNearest:
            return lit_nearest(uvz);
        case kFilterHardware2x2:
            return texture(map, uvz);
    }
    return lit_box_4x4(uvz);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    float depth = texelFetch(depths, ivec2(pixel), 0).x;
    float lit = 1.0;
    if (depth > 0.0) {
        vec3 p_ws = receiver_position(push.world_from_clip, pixel, push.size, depth);
        vec3 normal_ws = unpack_unit_vector(imageLoad(normals, ivec2(pixel)).x);
        lit = faces_light(push.light, p_ws, normal_ws)
                  ? lit_by_map(biased_position(p_ws, normal_ws))
                  : 0.0;
    }
    imageStore(visibility, ivec2(pixel), vec4(lit));
}
