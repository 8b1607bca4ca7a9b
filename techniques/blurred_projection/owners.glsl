// Which channel is an instance's.

#ifndef GNOMON_BLURRED_PROJECTION_OWNERS_GLSL
#define GNOMON_BLURRED_PROJECTION_OWNERS_GLSL

#include "blurred_projection.shared.h"

const uint kNoChannel = kMaxChannels;

// The number of the channel that the instance owns, or kNoChannel.
uint channel_number(uint instance, Owners owners) {
    for (uint channel = 0u; channel < kMaxChannels; ++channel) {
        if (owners.instances[channel] == instance) return channel;
    }
    return kNoChannel;
}

// 1 in the channel that the instance owns, else 0.
vec4 channel_of(uint instance, Owners owners) {
    uvec4 all = uvec4(owners.instances[0], owners.instances[1], owners.instances[2],
                      owners.instances[3]);
    return vec4(equal(all, uvec4(instance)));
}

#endif
