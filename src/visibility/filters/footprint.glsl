// Taps over what the pixel covers of the map: W. Reeves, D. Salesin, R. Cook, "Rendering Antialiased Shadows
// with Depth Maps", SIGGRAPH 1987.

#ifndef GNOMON_VISIBILITY_FILTERS_FOOTPRINT_GLSL
#define GNOMON_VISIBILITY_FILTERS_FOOTPRINT_GLSL

#include "visibility/map_filter.glsl"

// Evenly over the square from -0.5 to 0.5, moved by a part of its side: the additive recurrence of the
// plastic number.
vec2 square_sample(uint i, float shift) {
    return fract(float(i) * vec2(0.75487767, 0.56984029) + vec2(shift, fract(7.0 * shift))) - 0.5;
}

// Bilinear taps over a parallelogram of the sides `spread`, in texels.
float lit_footprint(sampler2DArray map, float size, MapBias bias, MapPoint point, mat2 spread,
                    float shift, uint taps) {
    float lit = 0.0;
    for (uint i = 0u; i < taps; ++i)
        lit += lit_bilinear(map, size, bias, point, point.texel + spread * square_sample(i, shift));
    return lit / float(kTaps);
}

#endif
