#ifndef GNOMON_VISIBILITY_MAP_LOOKUP_SHARED_H
#define GNOMON_VISIBILITY_MAP_LOOKUP_SHARED_H

#include "visibility/light_shape.shared.h"

#ifdef __cplusplus
namespace gnomon::shared {
#endif

const uint kMaxMapLayers = 8u;

// Specialization constants of map_lookup.comp.glsl, from 1: kFilter, kLayerCount, kAffine,
// kLayerChoice

const uint kFilterNearest = 0u;
const uint kFilterHardware2x2 = 1u;
const uint kFilterBox3x3 = 2u;
const uint kFilterBox4x4 = 3u;
const uint kFilterDithered4 = 4u;

const uint kChooseByDistance = 0u;
const uint kChooseByAxis = 1u;

/// By how much receivers are moved before they are looked up: map_bias.glsl.
struct MapBias {
    float receiver_plane;  // 1: texels are compared with the receiver's plane there; 0: with its
                           // depth
    float reach_texels;    // over which a plane's gain of depth is made up for
    float constant;        // texels, towards the light
    float slope;           // times the depth that a plane gains over the filter's reach
    float normal_offset;   // times the offset that frees a plane from the filter's reach
};

struct MapLayerFrame {
    // Rows of the matrix to the map: texel coordinates in [0, 1], reversed depth, w.
    vec4 u, v, z, w;
    // Of an affine map: what makes u.xyz and v.xyz the steps from a texel to the next in the world,
    // and the longer of both steps in metres.
    vec3 steps;
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
