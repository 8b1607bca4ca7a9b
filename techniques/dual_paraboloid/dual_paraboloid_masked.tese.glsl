#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Casters with holes.

#include "place_piece.glsl"
#include "raster/scene.shared.h"

layout(location = 4) out vec2 texcoord;
layout(location = 5) out vec4 color;

layout(set = 0, binding = 0, scalar) readonly buffer Attributes { VertexAttributes attributes[]; };

void main() {
    vec3 weights = place_piece();
    texcoord = vec2(0.0);
    color = vec4(0.0);
    for (int i = 0; i < 3; ++i) {
        VertexAttributes corner = attributes[corner_vertex[i]];
        texcoord += weights[i] * corner.texcoord;
        color += weights[i] * unpackUnorm4x8(corner.color);
    }
}
