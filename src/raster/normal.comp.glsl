#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// The geometric normal of each receiver from its triangle, turned towards the viewer.

#include "raster/octahedral.glsl"
#include "raster/scene.shared.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, scalar) readonly buffer Instances { SceneInstance instances[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Slots { uint slot_of_instance[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 4, rg32ui) uniform readonly uimage2D ids;
layout(set = 0, binding = 5, r32ui) uniform writeonly uimage2D normals;
layout(push_constant, scalar) uniform Push { NormalPush push; };

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    uvec2 id = imageLoad(ids, ivec2(pixel)).xy;
    if (id.x == 0xffffffffu) {
        imageStore(normals, ivec2(pixel), uvec4(0u));
        return;
    }
    SceneInstance placed = instances[slot_of_instance[id.x]];
    uint first = placed.first_index + 3u * id.y;
    vec3 a = positions[placed.first_vertex + indices[first]];
    vec3 b = positions[placed.first_vertex + indices[first + 1u]];
    vec3 c = positions[placed.first_vertex + indices[first + 2u]];
    mat3 m = mat3(placed.world_from_local);
    vec3 normal_ws = normalize(cross(m * (b - a), m * (c - a)));
    vec3 to_eye = push.eye_ws - push.perspective * (placed.world_from_local * vec4(a, 1.0));
    if (dot(normal_ws, to_eye) < 0.0) normal_ws = -normal_ws;
    imageStore(normals, ivec2(pixel), uvec4(pack_unit_vector(normal_ws)));
}
