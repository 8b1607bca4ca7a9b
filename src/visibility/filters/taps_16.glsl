// Sixteen bilinear taps in a square of texels: the whole of what four dithered ones sample (GPU Gems 2004,
// chapter 11).

#ifndef GNOMON_VISIBILITY_FILTERS_TAPS_16_GLSL
#define GNOMON_VISIBILITY_FILTERS_TAPS_16_GLSL

#include "visibility/map_filter.glsl"

// All sixteen, or none.
float lit_taps_16(sampler2DArray map, float size, MapBias bias, MapPoint point, uint taps) {
    float lit = 0.0;
    for (uint i = 0u; i < taps; ++i)
        lit += lit_bilinear(map, size, bias, point, point.texel + vec2(i % 4u, i / 4u) - 1.5);
    return lit / 16.0;
}

#endif
