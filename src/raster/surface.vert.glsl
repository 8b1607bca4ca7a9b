#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Everything that has alpha or colour: position, instance and what shading needs.

#include "raster/scene.shared.h"
#include "raster/transform.glsl"

layout(location = 0) in vec3 position;
layout(location = 0) flat out uint instance;
layout(location = 1) out vec2 texcoord;
layout(location = 2) out vec4 color;
layout(location = 3) out vec3 normal_ws;

layout(set = 0, binding = 0, scalar) readonly buffer Instances { SceneInstance instances[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Attributes { VertexAttributes attributes[]; };
layout(push_constant, scalar) uniform Push { ScenePush push; };

invariant gl_Position;

void main() {
    SceneInstance placed = instances[gl_InstanceIndex];
    vec3 p_ws = to_world(placed.world_from_local, position);
    gl_Position = to_clip(push.clip_from_world, vec4(p_ws, 1.0));
    instance = placed.instance;
    VertexAttributes vertex = attributes[gl_VertexIndex];
    texcoord = vertex.texcoord;
    color = unpackUnorm4x8(vertex.color);
    // Normals go by the cofactors, which also turn them round in mirrored instances.
    mat3 m = mat3(placed.world_from_local);
    mat3 cofactors = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
    normal_ws = cofactors * vertex.normal;
}
