#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Casters with holes into a map that tells whose surface it sees.

#include "visibility/caster_attributes.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in mat4 clip_from_local;
layout(location = 6) in uint object;
layout(location = 2) flat out uint seen;

void main() {
    gl_Position = clip_from_local * vec4(position, 1.0);
    set_attributes();
    seen = object;
}
