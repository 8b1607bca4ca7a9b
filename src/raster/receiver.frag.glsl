#version 460

layout(location = 0) flat in uint instance;
layout(location = 0) out uvec2 id;

void main() { id = uvec2(instance, gl_PrimitiveID); }
