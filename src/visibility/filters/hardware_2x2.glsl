// Four texels, weighted by how near they are: as percentage-closer filtering in hardware.

#ifndef GNOMON_VISIBILITY_FILTERS_HARDWARE_2X2_GLSL
#define GNOMON_VISIBILITY_FILTERS_HARDWARE_2X2_GLSL

#include "visibility/map_filter.glsl"

float lit_hardware_2x2(sampler2DArray map, float size, MapBias bias, MapPoint point) {
    vec2 corner = floor(point.texel - 0.5);
    vec4 stored = stored_quad(map, size, point, corner);
    point = ended(point, size, chosen(stored, lessThan(point.gradient, vec2(0.0))));
    return mixed(lit_quad(stored, size, bias, point, corner), point.texel - 0.5 - corner);
}

#endif
