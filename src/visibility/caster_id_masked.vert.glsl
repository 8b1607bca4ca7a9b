#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Casters with holes into a map that tells whose surface it sees.

#include "raster/scene.shared.h"

layout(location = 0) in vec3 position;
layout(location = 1) in mat4 clip_from_local;
layout(location = 6) in uint object;
layout(location = 0) out vec2 texcoord;
layout(location = 1) out vec4 color;
layout(location = 2) flat out uint seen;

layout(set = 0, binding = 0, scalar) readonly buffer Attributes { VertexAttributes attributes[]; };

void main() {
    gl_Position = clip_from_local * vec4(position, 1.0);
    VertexAttributes vertex = attributes[gl_VertexIndex];
    texcoord = vertex.texcoord;
    color = unpackUnorm4x8(vertex.color);
    seen = object;
}
