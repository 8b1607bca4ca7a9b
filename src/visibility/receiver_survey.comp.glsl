#version 460
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Where receivers are, block by block of the picture, an invocation for each. Nothing is shared between
// invocations, and no loop is left in: software drivers are slow at barriers, and read constants slowly
// within loops.

#include "visibility/receiver_survey.shared.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, scalar) writeonly buffer Blocks { SurveyedBlock blocks[]; };
layout(push_constant, scalar) uniform Push { SurveyPush push; };

const float kNowhere = 3e38;

// Bounds of four series of pixels.
struct Range {
    vec4 low, high;
};

Range with(Range range, vec4 value, bvec4 exists) {
    return Range(min(range.low, mix(vec4(kNowhere), value, exists)),
                 max(range.high, mix(vec4(-kNowhere), value, exists)));
}

float least(vec4 v) { return min(min(v.x, v.y), min(v.z, v.w)); }
float most(vec4 v) { return max(max(v.x, v.y), max(v.z, v.w)); }

void main() {
    uvec2 block = gl_GlobalInvocationID.xy;
    vec2 size = vec2(push.size);
    mat4 m = push.es_from_clip;
    const Range kNone = Range(vec4(kNowhere), vec4(-kNowhere));
    Range x = kNone;
    Range y = kNone;
    Range z = kNone;
    Range depth = kNone;
    uvec4 near_bits = uvec4(0u);
    uvec4 far_bits = uvec4(0u);
    [[unroll]] for (uint i = 0u; i < kSurveyBlock_px * kSurveyBlock_px / 4u; ++i) {
        vec2 corner = vec2(kSurveyBlock_px * block + 2u * uvec2(i % 4u, i / 4u));
        vec4 d = textureGather(depths, (corner + 1.0) / size);
        // Beyond the picture's border its last pixels are read again.
        vec4 across = min(corner.x + vec4(0.0, 1.0, 1.0, 0.0), size.x - 1.0);
        vec4 down = min(corner.y + vec4(1.0, 1.0, 0.0, 0.0), size.y - 1.0);
        vec4 u = 2.0 * (across + 0.5) / size.x - 1.0;
        vec4 v = 2.0 * (down + 0.5) / size.y - 1.0;
        vec4 w = 1.0 / (m[0].w * u + m[1].w * v + m[2].w * d + m[3].w);
        bvec4 exists = greaterThan(d, vec4(0.0));
        x = with(x, w * (m[0].x * u + m[1].x * v + m[2].x * d + m[3].x), exists);
        y = with(y, w * (m[0].y * u + m[1].y * v + m[2].y * d + m[3].y), exists);
        z = with(z, w * (m[0].z * u + m[1].z * v + m[2].z * d + m[3].z), exists);
        depth = with(depth, d, exists);
        uvec4 step = min((kBitsOfOne - floatBitsToUint(min(d, vec4(1.0)))) >> kSurveyDepthShift,
                         kSurveyDepths - 1u);
        uvec4 bit = mix(uvec4(0u), uvec4(1u) << (step & 31u), exists);
        bvec4 is_near = lessThan(step, uvec4(32u));
        near_bits |= mix(uvec4(0u), bit, is_near);
        far_bits |= mix(bit, uvec4(0u), is_near);
    }
    if (block.x >= push.blocks || kSurveyBlock_px * block.y >= push.size.y) return;
    blocks[block.y * push.blocks + block.x] =
        SurveyedBlock(vec3(least(x.low), least(y.low), least(z.low)),
                      vec3(most(x.high), most(y.high), most(z.high)),
                      max(most(depth.high), 0.0), least(depth.low),
                      uvec2(near_bits.x | near_bits.y | near_bits.z | near_bits.w,
                            far_bits.x | far_bits.y | far_bits.z | far_bits.w));
}
