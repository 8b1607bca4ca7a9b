#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "visibility/caster_alpha.glsl"

layout(location = 0) in vec2 texcoord;
layout(location = 1) in vec4 color;

void main() {
    if (is_hole(texcoord, color)) discard;
}
