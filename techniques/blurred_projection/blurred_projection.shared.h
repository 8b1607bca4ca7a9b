#ifndef GNOMON_BLURRED_PROJECTION_SHARED_H
#define GNOMON_BLURRED_PROJECTION_SHARED_H

#ifdef __cplusplus
#include "gpu/shared_types.h"
namespace gnomon::blurred_projection::shared {
using namespace gpu::shared;
#endif

// Of a colour: each belongs to one object.
const uint kMaxChannels = 4u;

// An owner that a channel has not got; no instance has this number.
const uint kNobody = 0xfffffffeu;

// Of every so many pixels along each axis one is counted: the largest objects are so by far more.
const uint kCountEvery = 4u;

// Of the coverage's colours: lit of two owners, presence of the same.
const uint kOwnersPerLayer = 2u;

/// The instances whose shadows the channels hold, the largest in the picture first.
struct Owners {
    uint instances[kMaxChannels];
};

struct CountPush {
    uvec2 size;  // of the picture
};

struct ChoosePush {
    uint instances;
    uint channels;
};

struct PresencePush {
    mat4 clip_from_world;
    uint material;
    uint masked;  // 1: where the material has holes there is nothing
};

struct CoveragePush {
    uint size;
    uint layers;
};

#ifdef __cplusplus
}  // namespace gnomon::blurred_projection::shared
#endif

#endif
