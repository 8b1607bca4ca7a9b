#version 460

// Casters into a map: positions alone. The matrix is an attribute that changes with the instance,
// because that is what software drivers read fastest.

layout(location = 0) in vec3 position;
layout(location = 1) in mat4 clip_from_local;

void main() { gl_Position = clip_from_local * vec4(position, 1.0); }
