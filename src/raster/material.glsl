// Colour and alpha of a surface, as trace/alpha.h computes them for rays.

#ifndef GNOMON_RASTER_MATERIAL_GLSL
#define GNOMON_RASTER_MATERIAL_GLSL

#include "raster/scene.shared.h"

vec2 material_uv(SceneMaterial material, vec2 texcoord) {
    return material.uv_scale_rotation * texcoord + material.uv_offset;
}

// Level 0, so that a hole is a hole at every distance and for every ray.
float material_alpha(SceneMaterial material, sampler2D base_color, vec2 uv, float vertex_alpha) {
    return material.base_color.a * textureLod(base_color, uv, 0.0).a * vertex_alpha;
}

#endif
