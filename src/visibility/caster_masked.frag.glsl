#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "raster/material.glsl"

layout(location = 0) in vec2 texcoord;
layout(location = 1) in vec4 color;

layout(set = 0, binding = 1, scalar) readonly buffer Materials { SceneMaterial materials[]; };
layout(set = 0, binding = 2) uniform sampler2D base_color;
layout(push_constant, scalar) uniform Push { CasterPush push; };

void main() {
    SceneMaterial material = materials[push.material];
    vec2 uv = material_uv(material, texcoord);
    if (material_alpha(material, base_color, uv, color.a) < material.alpha_cutoff) discard;
}
