#ifndef GNOMON_VISIBILITY_MAP_LOOKUP_SHARED_H
#define GNOMON_VISIBILITY_MAP_LOOKUP_SHARED_H

#include "visibility/light_shape.shared.h"

#ifdef __cplusplus
namespace gnomon::shared {
#endif

const uint kMaxMapLayers = 8u;

// Specialization constants of map_lookup.comp.glsl, from 1: kFilter, kLayerCount, kAffine

const uint kFilterNearest = 0u;
const uint kFilterHardware2x2 = 1u;
const uint kFilterBox3x3 = 2u;
const uint kFilterBox4x4 = 3u;
const uint kFilterDithered4 = 4u;

/// By how much receivers are moved before they are looked up: map_bias.glsl.
struct MapBias {
    float reach_texels;   // farthest texel centre that decides, from the receiver
    float constant;       // texels, towards the light
    float slope;          // times the depth that a plane gains over the filter's reach
    float normal_offset;  // times the offset that frees a plane from the filter's reach
};

struct MapLayerFrame {
    mat4 clip_from_world;  // of the light, reversed Z
    vec3 texel_u_ws;       // from a texel to the next, of an affine map
    vec3 texel_v_ws;
    float texel_m;      // the longer of both
    float first_depth;  // the layer's receivers are not nearer than this depth of the picture
};

struct MapFrame {
    MapLayerFrame layers[kMaxMapLayers];
    MapBias bias;
    float size_texels;
};

#ifdef __cplusplus
}  // namespace gnomon::shared
#endif

#endif
