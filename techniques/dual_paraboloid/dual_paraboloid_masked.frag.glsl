#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "raster/material.glsl"
#include "write_depth.glsl"

layout(location = 4) in vec2 texcoord;
layout(location = 5) in vec4 color;

layout(set = 0, binding = 1, scalar) readonly buffer Materials { SceneMaterial materials[]; };
layout(set = 0, binding = 2) uniform sampler2D base_color;

void main() {
    SceneMaterial material = materials[push.material];
    vec2 uv = material_uv(material, texcoord);
    if (material_alpha(material, base_color, uv, color.a) < material.alpha_cutoff) discard;
    write_depth();
}
