#version 460

layout(location = 0) flat in uint seen;
layout(location = 0) out uint object;

void main() { object = seen; }
