#ifndef GNOMON_VISIBILITY_RECEIVER_SURVEY_SHARED_H
#define GNOMON_VISIBILITY_RECEIVER_SURVEY_SHARED_H

#ifdef __cplusplus
#include "gpu/shared_types.h"
namespace gnomon::shared {
using namespace gpu::shared;
#endif

// Pixels along a side of the block that one invocation looks at.
const uint kSurveyBlock_px = 8u;

// Depths of the picture, which are reversed and at most 1, are told apart by this many of a float's
// highest bits below 1: by a quarter of each octave, in 16 octaves.
const uint kSurveyDepthShift = 21u;
const uint kSurveyDepths = 64u;
const uint kBitsOfOne = 0x3f800000u;  // of the float 1

struct SurveyPush {
    mat4 es_from_clip;  // `_es` as in ReceiverPush
    uvec2 size;
    uint blocks;  // along a row of the picture
};

/// The receivers of a block of the picture.
struct SurveyedBlock {
    vec3 low_es;  // above high_es: there are none
    vec3 high_es;
    float nearest;  // of the picture's reversed depths; 0 in a block of none
    float farthest;
    uvec2 depths;  // bit i of 64: there is a depth i steps below 1
};

#ifdef __cplusplus
}  // namespace gnomon::shared
#endif

#endif
