#ifndef GNOMON_OCCLUSION_INTERVAL_MAPS_SHARED_H
#define GNOMON_OCCLUSION_INTERVAL_MAPS_SHARED_H

#ifdef __cplusplus
#include "gpu/shared_types.h"
namespace gnomon::occlusion_interval_maps::shared {
using namespace gpu::shared;
#endif

// Specialization constant 0 of occlusion_interval_maps.comp.glsl, as bake::TexelLookup.
const uint kLookupNearest = 0u;
const uint kLookupInterpolated = 1u;
const uint kLookupEdges = 2u;

// Where a triangle's side has no facet, a chart no fine cells, a cell no samples.
const uint kNone = 0xffffffffu;

// Of LitTexel::count_and_place.
const int kCountBits = 16;
const int kPlaceBits = 8;

/// lightmap::Facet by a point on it: near that, floats are exact.
struct PageFacet {
    vec3 normal_ws;
    vec3 point_ws;
    vec2 place_texels;  // of the point, on the page
    vec3 u_ws;          // one texel to the right
    vec3 v_ws;          // one texel down
    uint chart;
};

/// lightmap::Chart.
struct PageChart {
    uint first_texel;  // of its page
    uint side_texels;  // of its page
    uvec2 least_texel;
    uvec2 size_texels;
    uint first_cell;  // rows from the top, one more than texels each way; or kNone
};

/// A texel, or a sample of a fine cell.
struct LitTexel {
    uint first_interval;
    uint
        count_and_place;  // of its intervals; where it asks, as bake::SamplePlace: two signed bytes
};

struct LookupPush {
    mat4 es_from_clip;  // `_es` as in ReceiverPush
    vec3 eye_ws;
    vec3 along_ws;  // where the light goes: unit vectors, or zero
    vec3 across_ws;
    float at_codes;  // of the light's middle, on the path
    float width_codes;
    float path_codes;
    uint ends;  // PathEnds as bits
    uint fine_parts;
    uvec2 size;
};

#ifdef __cplusplus
}  // namespace gnomon::occlusion_interval_maps::shared
#endif

#endif
