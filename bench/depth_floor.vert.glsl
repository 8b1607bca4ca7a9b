#version 460
#extension GL_EXT_scalar_block_layout : require

// Nothing but where a vertex is.

layout(location = 0) in vec3 position;

layout(push_constant, scalar) uniform Push { mat4 clip_from_local; };

void main() {
    gl_Position = clip_from_local * vec4(position, 1.0);
}
