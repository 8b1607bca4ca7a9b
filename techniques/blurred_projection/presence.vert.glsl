#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// The channels' owners as the light sees them, whatever is before them. All others are put where
// nothing is drawn.

#include "owners.glsl"
#include "raster/scene.shared.h"
#include "raster/transform.glsl"

layout(location = 0) in vec3 position;
layout(location = 0) flat out vec4 channel;
layout(location = 1) out vec2 texcoord;
layout(location = 2) out vec4 color;

layout(set = 0, binding = 0, scalar) readonly buffer Instances { SceneInstance instances[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Attributes { VertexAttributes attributes[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Chosen { Owners owners; };
layout(push_constant, scalar) uniform Push { PresencePush push; };

const vec4 kOutside = vec4(2.0, 2.0, 0.0, 1.0);

void main() {
    SceneInstance placed = instances[gl_InstanceIndex];
    channel = channel_of(placed.instance, owners);
    gl_Position = kOutside;
    texcoord = vec2(0.0);
    color = vec4(0.0);
    if (channel == vec4(0.0)) return;
    vec3 p_ws = to_world(placed.world_from_local, position);
    gl_Position = to_clip(push.clip_from_world, vec4(p_ws, 1.0));
    VertexAttributes vertex = attributes[gl_VertexIndex];
    texcoord = vertex.texcoord;
    color = unpackUnorm4x8(vertex.color);
}
