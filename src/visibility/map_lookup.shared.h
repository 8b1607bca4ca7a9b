#ifndef GNOMON_VISIBILITY_MAP_LOOKUP_SHARED_H
#define GNOMON_VISIBILITY_MAP_LOOKUP_SHARED_H

#include "visibility/light_shape.shared.h"

#ifdef __cplusplus
namespace gnomon::shared {
#endif

const uint kMaxMapLayers = 8u;

// Specialization constants of map_lookup.comp.glsl, from 1: kFilter, kContent, kTaps, kLayerCount,
// kAffine, kLayerChoice, kProof, kListed; of map_content.comp.glsl: kContent

const uint kFilterNearest = 0u;
const uint kFilterHardware2x2 = 1u;
const uint kFilterBox3x3 = 2u;
const uint kFilterBox4x4 = 3u;
const uint kFilterDithered4 = 4u;
const uint kFilterTaps16 = 5u;
const uint kFilterDisc = 6u;
const uint kFilterFootprint = 7u;
const uint kFilterPcss = 8u;

const uint kContentDepth = 0u;
const uint kContentDistance = 1u;
const uint kContentPacked = 2u;
const uint kContentPackedTwo = 3u;
const uint kContentObjectId = 4u;     // beside the depth
const uint kContentExponential = 5u;  // this and what follows is blurred instead of compared
const uint kContentVariance = 6u;
const uint kContentExponentialVariance = 7u;
const uint kContentMoments = 8u;

const uint kChooseByDistance = 0u;
const uint kChooseByAxis = 1u;

// What a map's bounds are for: nothing, to skip filters, or to show where they would be skipped.
const uint kProofNone = 0u;
const uint kProofSkips = 1u;
const uint kProofShown = 2u;

// Side of a tile, in texels. Of 8 up to a fifth more is proven, but bounds take up to twice as long
// to make for a narrow filter, and six times as long for a wide one; of 32 up to a third less is.
const uint kBoundsTile = 16u;

/// By how much receivers are moved before they are looked up: map_bias.glsl.
struct MapBias {
    float receiver_plane;   // 1: texels are compared with the receiver's plane there; 0: with its
                            // depth
    float reach_texels;     // over which a plane's gain of depth is made up for
    float constant;         // texels, towards the light
    float slope;            // times the depth that a plane gains over the filter's reach
    float normal_offset;    // times the offset that frees a plane from the filter's reach
    float cone;             // of a plane's gain of depth, per texel that a tap is away
    float grazed_texels;    // of the map, off a plane that the light grazes
    float distance_scale;   // a receiver's stored distance is multiplied by this,
    float distance_offset;  // and less by this
};

/// How a map's contents are read: filters/*.glsl, contents/*.glsl.
struct MapReadingFrame {
    float radius_texels;   // of the disc
    float most_texels;     // PCSS reaches no farther
    float exponent;        // of exponential contents
    float least_variance;  // of the depth's range, squared
    float bleeding;        // shadows lighter than this, of a whole, are light
};

/// What turns depths of a layer into distances.
struct MapSpace {
    vec4 tangents;  // of a light within the world: half sizes, middle of its view
    float reach;    // nearest over farthest distance along its axis; 0: of a light at infinity
};

struct MapLayerFrame {
    // Rows of the matrix to the map: texel coordinates in [0, 1], reversed depth, w.
    vec4 u, v, z, w;
    // Of an affine map: what makes u.xyz and v.xyz the steps from a texel to the next in the world,
    // and the longer of both steps in metres.
    vec3 steps;
    float first_depth;  // the layer's receivers are not nearer than this depth of the picture
    float bias_scale;   // of MapBias::constant
    MapSpace space;
};

struct MapFrame {
    ReceiverPush receivers;
    MapLayerFrame layers[kMaxMapLayers];
    MapBias bias;
    MapReadingFrame reading;
    float size_texels;
    float blend;  // LookupLayers::blend
    // How far around a receiver the map's bounds hold, in texels: the narrowest, the next, which
    // are without end where none are wider; and the widest.
    vec3 bounded_texels;
};

/// What differs between the dispatches of a frame.
struct MapLookupPush {
    uint first_layer;  // of those that are chosen among
    uint first_block;  // of the listed ones
};

struct MapContentPush {
    MapSpace space;
    float exponent;
    uint layer;
    uint size;
};

struct MapBoundsPush {
    uint layer;
    uint size;
    uint rings;         // of tiles around each that its bounds hold for too
    uint bounds_layer;  // where these bounds go
};

struct MapBlurPush {
    uvec2 step;  // (1, 0) or (0, 1)
    uint layer;
    uint size;
    float radius_texels;
};

#ifdef __cplusplus
}  // namespace gnomon::shared
#endif

#endif
