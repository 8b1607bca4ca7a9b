#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Casters into a depth map: positions alone.

#include "raster/scene.shared.h"

layout(location = 0) in vec3 position;

layout(set = 0, binding = 0, scalar) readonly buffer Instances { SceneInstance instances[]; };
layout(push_constant, scalar) uniform Push { ScenePush push; };

void main() {
    vec3 p_ws = instances[gl_InstanceIndex].world_from_local * vec4(position, 1.0);
    gl_Position = push.clip_from_world * vec4(p_ws, 1.0);
}
