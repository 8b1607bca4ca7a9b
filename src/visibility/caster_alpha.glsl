// Where a caster has holes.

#ifndef GNOMON_VISIBILITY_CASTER_ALPHA_GLSL
#define GNOMON_VISIBILITY_CASTER_ALPHA_GLSL

#include "raster/material.glsl"

layout(set = 0, binding = 1, scalar) readonly buffer Materials { SceneMaterial materials[]; };
layout(set = 0, binding = 2) uniform sampler2D base_color;
layout(push_constant, scalar) uniform Push { CasterPush push; };

bool is_hole(vec2 texcoord, vec4 color) {
    SceneMaterial material = materials[push.material];
    vec2 uv = material_uv(material, texcoord);
    return material_alpha(material, base_color, uv, color.a) < material.alpha_cutoff;
}

#endif
