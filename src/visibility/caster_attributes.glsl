// What casters with holes hand on to the fragments, which look for holes.

#ifndef GNOMON_VISIBILITY_CASTER_ATTRIBUTES_GLSL
#define GNOMON_VISIBILITY_CASTER_ATTRIBUTES_GLSL

#include "raster/scene.shared.h"

layout(location = 0) out vec2 texcoord;
layout(location = 1) out vec4 color;

layout(set = 0, binding = 0, scalar) readonly buffer Attributes { VertexAttributes attributes[]; };

void set_attributes() {
    VertexAttributes vertex = attributes[gl_VertexIndex];
    texcoord = vertex.texcoord;
    color = unpackUnorm4x8(vertex.color);
}

#endif
