#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Casters with holes into a depth map.

#include "raster/scene.shared.h"

layout(location = 0) in vec3 position;
layout(location = 1) out vec2 texcoord;
layout(location = 2) out vec4 color;

layout(set = 0, binding = 0, scalar) readonly buffer Instances { SceneInstance instances[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Attributes { VertexAttributes attributes[]; };
layout(push_constant, scalar) uniform Push { ScenePush push; };

void main() {
    vec3 p_ws = instances[gl_InstanceIndex].world_from_local * vec4(position, 1.0);
    gl_Position = push.clip_from_world * vec4(p_ws, 1.0);
    VertexAttributes vertex = attributes[gl_VertexIndex];
    texcoord = vertex.texcoord;
    color = unpackUnorm4x8(vertex.color);
}
