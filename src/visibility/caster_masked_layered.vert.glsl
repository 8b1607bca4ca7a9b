#version 460
#extension GL_ARB_shader_viewport_layer_array : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Casters with holes into the layers of a map, each instance into its own.

#include "visibility/caster_attributes.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in mat4 clip_from_local;
layout(location = 5) in uint layer;

void main() {
    gl_Position = clip_from_local * vec4(position, 1.0);
    gl_Layer = int(layer);
    set_attributes();
}
