#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "blurred_projection.shared.h"
#include "raster/material.glsl"

layout(location = 0) flat in vec4 channel;
layout(location = 1) in vec2 texcoord;
layout(location = 2) in vec4 color;
layout(location = 0) out vec4 present;

layout(set = 0, binding = 2, scalar) readonly buffer Materials { SceneMaterial materials[]; };
layout(set = 0, binding = 3) uniform sampler2D base_color;
layout(push_constant, scalar) uniform Push { PresencePush push; };

void main() {
    if (push.masked != 0u) {
        SceneMaterial material = materials[push.material];
        vec2 uv = material_uv(material, texcoord);
        if (material_alpha(material, base_color, uv, color.a) < material.alpha_cutoff) discard;
    }
    present = channel;
}
