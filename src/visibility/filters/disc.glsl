// Taps over a disc, turned from pixel to pixel.

#ifndef GNOMON_VISIBILITY_FILTERS_DISC_GLSL
#define GNOMON_VISIBILITY_FILTERS_DISC_GLSL

#include "visibility/map_filter.glsl"

// Evenly over the unit disc, turned by a part of a whole turn: H. Vogel, "A Better Way to Construct the
// Sunflower Head", Mathematical Biosciences 44, 1979.
vec2 disc_sample(uint i, float turn) {
    const float kGoldenAngle = 2.39996323;
    const float kWholeTurn = 6.28318531;
    float angle = kGoldenAngle * float(i) + kWholeTurn * turn;
    return sqrt((float(i) + 0.5) / float(kTaps)) * vec2(cos(angle), sin(angle));
}

// Bilinear taps, `taps` of kTaps or none, over a disc that `spread` makes an ellipse of, in texels.
float lit_disc(sampler2DArray map, float size, MapBias bias, MapPoint point, mat2 spread,
               float turn, uint taps) {
    float lit = 0.0;
    for (uint i = 0u; i < taps; ++i)
        lit += lit_bilinear(map, size, bias, point, point.texel + spread * disc_sample(i, turn));
    return lit / float(kTaps);
}

#endif
