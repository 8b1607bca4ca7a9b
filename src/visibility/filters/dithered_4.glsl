// Four of the sixteen taps, the others by turns in squares of four pixels, so that the eye averages them.
// M. Bunnell, F. Pellacini, "Shadow Map Antialiasing", GPU Gems 2004, chapter 11.

#ifndef GNOMON_VISIBILITY_FILTERS_DITHERED_4_GLSL
#define GNOMON_VISIBILITY_FILTERS_DITHERED_4_GLSL

#include "visibility/map_filter.glsl"

float lit_dithered_4(sampler2DArray map, float size, MapBias bias, MapPoint point, uvec2 pixel) {
    uvec2 turn = pixel & 1u;
    turn.y ^= turn.x;
    vec2 first = point.texel + vec2(turn) - 1.5;
    float lit = lit_bilinear(map, size, bias, point, first);
    lit += lit_bilinear(map, size, bias, point, first + vec2(2.0, 0.0));
    lit += lit_bilinear(map, size, bias, point, first + vec2(0.0, 2.0));
    lit += lit_bilinear(map, size, bias, point, first + 2.0);
    return 0.25 * lit;
}

#endif
