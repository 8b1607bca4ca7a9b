#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// How many of the picture's pixels show each instance.

#include "blurred_projection.shared.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, rg32ui) uniform readonly uimage2D receiver_ids;
layout(set = 0, binding = 1, scalar) buffer Counts { uint counts[]; };
layout(push_constant, scalar) uniform Push { CountPush push; };

const uint kNoReceiver = 0xffffffffu;

void main() {
    uvec2 pixel = kCountEvery * gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    uint instance = imageLoad(receiver_ids, ivec2(pixel)).x;
    if (instance != kNoReceiver) atomicAdd(counts[instance], 1u);
}
