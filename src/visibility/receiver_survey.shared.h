#ifndef GNOMON_VISIBILITY_RECEIVER_SURVEY_SHARED_H
#define GNOMON_VISIBILITY_RECEIVER_SURVEY_SHARED_H

#ifdef __cplusplus
#include "gpu/shared_types.h"
namespace gnomon::shared {
using namespace gpu::shared;
#endif

// Pixels along a side of a tile, and those of them that one invocation looks at.
const uint kSurveyTile_px = 64u;
const uint kSurveyGroup = 8u;
const uint kSurveyEach = kSurveyTile_px / kSurveyGroup;

struct SurveyPush {
    mat4 es_from_clip;  // `_es` as in ReceiverPush
    uvec2 size;
};

/// The receivers of a tile of the picture.
struct SurveyedTile {
    vec3 low_es;  // above high_es: there are none
    vec3 high_es;
    float nearest;  // of the picture's reversed depths; 0 in a tile of none
    float farthest;
};

#ifdef __cplusplus
}  // namespace gnomon::shared
#endif

#endif
