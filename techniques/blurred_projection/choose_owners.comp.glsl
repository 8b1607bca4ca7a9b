#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// The instances that most pixels show, of equal ones the first. The counts are zero afterwards.

#include "blurred_projection.shared.h"

layout(local_size_x = 256) in;

layout(set = 0, binding = 0, scalar) buffer Counts { uint counts[]; };
layout(set = 0, binding = 1, scalar) buffer Result { Owners owners; };
layout(push_constant, scalar) uniform Push { ChoosePush push; };

shared uint best_count[gl_WorkGroupSize.x];
shared uint best_instance[gl_WorkGroupSize.x];

void take_if_better(uint own, uint instance, uint count) {
    bool better = count > best_count[own] ||
                  (count == best_count[own] && instance < best_instance[own]);
    if (count == 0u || !better) return;
    best_count[own] = count;
    best_instance[own] = instance;
}

// Leaves the instance of the greatest count in best_instance[0], kNobody when all are zero.
void find_best(uint own) {
    best_count[own] = 0u;
    best_instance[own] = kNobody;
    for (uint i = own; i < push.instances; i += gl_WorkGroupSize.x)
        take_if_better(own, i, counts[i]);
    for (uint half_width = gl_WorkGroupSize.x / 2u; half_width > 0u; half_width /= 2u) {
        barrier();
        if (own < half_width) {
            take_if_better(own, best_instance[own + half_width], best_count[own + half_width]);
        }
    }
    barrier();
}

void main() {
    uint own = gl_LocalInvocationIndex;
    for (uint channel = 0u; channel < kMaxChannels; ++channel) {
        uint best = kNobody;
        if (channel < push.channels) {
            find_best(own);
            best = best_instance[0];
        }
        barrier();
        if (own == 0u) owners.instances[channel] = best;
        // Lest it be found again; by the invocation that reads it.
        if (best != kNobody && best % gl_WorkGroupSize.x == own) counts[best] = 0u;
    }
    for (uint i = own; i < push.instances; i += gl_WorkGroupSize.x)
        counts[i] = 0u;
}
