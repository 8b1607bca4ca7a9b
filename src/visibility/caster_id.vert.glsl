#version 460

// Casters into a map that tells whose surface it sees.

layout(location = 0) in vec3 position;
layout(location = 1) in mat4 clip_from_local;
layout(location = 6) in uint object;
layout(location = 0) flat out uint seen;

void main() {
    gl_Position = clip_from_local * vec4(position, 1.0);
    seen = object;
}
