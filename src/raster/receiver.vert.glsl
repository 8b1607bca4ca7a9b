#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Receivers and casters without alpha: position and instance.

#include "raster/scene.shared.h"
#include "raster/transform.glsl"

layout(location = 0) in vec3 position;
layout(location = 0) flat out uint instance;

layout(set = 0, binding = 0, scalar) readonly buffer Instances { SceneInstance instances[]; };
layout(push_constant, scalar) uniform Push { ScenePush push; };

invariant gl_Position;

void main() {
    SceneInstance placed = instances[gl_InstanceIndex];
    vec3 p_ws = to_world(placed.world_from_local, position);
    gl_Position = to_clip(push.clip_from_world, vec4(p_ws, 1.0));
    instance = placed.instance;
}
