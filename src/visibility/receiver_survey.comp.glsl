#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Where receivers are, tile by tile of the picture: each invocation bounds those of some pixels,
// and a tree of pairs all of the tile's.

#include "visibility/receiver_survey.shared.h"

layout(local_size_x = kSurveyGroup, local_size_y = kSurveyGroup) in;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, scalar) writeonly buffer Tiles {
    SurveyedTile tiles[];
};
layout(push_constant, scalar) uniform Push {
    SurveyPush push;
};

const uint kInvocations = kSurveyGroup * kSurveyGroup;
const float kNowhere = 3e38;

shared SurveyedTile parts[kInvocations];

SurveyedTile both(SurveyedTile a, SurveyedTile b) {
    return SurveyedTile(min(a.low_es, b.low_es), max(a.high_es, b.high_es),
                        max(a.nearest, b.nearest), min(a.farthest, b.farthest));
}

void main() {
    SurveyedTile part = SurveyedTile(vec3(kNowhere), vec3(-kNowhere), 0.0, kNowhere);
    uvec2 first = kSurveyTile_px * gl_WorkGroupID.xy + gl_LocalInvocationID.xy;
    for (uint i = 0u; i < kSurveyEach * kSurveyEach; ++i) {
        uvec2 pixel = first + kSurveyGroup * uvec2(i % kSurveyEach, i / kSurveyEach);
        pixel = min(pixel, push.size - 1u);
        float depth = texelFetch(depths, ivec2(pixel), 0).x;
        vec2 ndc = 2.0 * (vec2(pixel) + 0.5) / vec2(push.size) - 1.0;
        vec4 p = push.es_from_clip * vec4(ndc, depth, 1.0);
        bvec3 exists = bvec3(depth > 0.0);
        part.low_es = min(part.low_es, mix(vec3(kNowhere), p.xyz / p.w, exists));
        part.high_es = max(part.high_es, mix(vec3(-kNowhere), p.xyz / p.w, exists));
        part.nearest = max(part.nearest, depth);
        part.farthest = min(part.farthest, exists.x ? depth : kNowhere);
    }
    parts[gl_LocalInvocationIndex] = part;
    for (uint others = kInvocations / 2u; others > 0u; others /= 2u) {
        barrier();
        if (gl_LocalInvocationIndex < others) {
            parts[gl_LocalInvocationIndex] =
                both(parts[gl_LocalInvocationIndex], parts[gl_LocalInvocationIndex + others]);
        }
    }
    if (gl_LocalInvocationIndex == 0u)
        tiles[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = parts[0];
}
