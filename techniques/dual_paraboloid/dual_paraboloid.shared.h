#ifndef GNOMON_DUAL_PARABOLOID_SHARED_H
#define GNOMON_DUAL_PARABOLOID_SHARED_H

#include "visibility/light_shape.shared.h"

#ifdef __cplusplus
namespace gnomon::dual_paraboloid::shared {
using namespace gpu::shared;
#endif

// Specialization constant 1 of dual_paraboloid.comp.glsl
const uint kFilterNearest = 0u;
const uint kFilterBilinear2x2 = 1u;
const uint kFilterBox3x3 = 2u;

/// `_ls`: the light as origin, z along its axis; for the layer that looks against the axis z is
/// turned round.
struct LayerPush {
    float side;              // 1: the layer looks along the axis; -1: against it
    float reach;             // of the paraboloid's plane, from the middle of the map to a side
    float rim;               // z of the unit directions that are `reach` from the middle
    float size_texels;       // side of a layer
    float near_m;            // what is nearer to the light touches it
    float segments_per_rad;  // of an edge that bends most, where the map is finest; 0: one
    uint material;
};

struct MapFrame {
    vec3 right, up, forward;  // axes of the light's space in the world
    float reach;
    float cone;   // of a spot, how far from the middle it shines
    uint layers;  // 1 of a spot, 2 of a point
    float size_texels;
    float near_m;
    float bias_constant;  // texels, towards the light
    float bias_slope;     // texels over which a plane's gain of depth is made up for so,
    float normal_offset;  // and by moving off the surface
};

#ifdef __cplusplus
}  // namespace gnomon::dual_paraboloid::shared
#endif

#endif
