#version 460
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// From the number of volumes around each receiver to its visibility.
//
// Rasterisers move corners by up to 1/512 of a pixel, so that the outermost pixels of a surface can hang
// over its true edge. There the side of the surface's own volume, which begins at that edge, is in front
// of the receiver instead of behind it, and the pixel is miscounted, alone among its neighbours. Such a
// pixel takes their state.

#include "raster/scene.shared.h"
#include "raster/transform.glsl"
#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 1) const uint kMendEdges = 1u;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 3) uniform usampler2D volumes;
layout(set = 0, binding = 4, rg32ui) uniform readonly uimage2D ids;
layout(set = 0, binding = 5, scalar) readonly buffer Instances { SceneInstance instances[]; };
layout(set = 0, binding = 6, scalar) readonly buffer Slots { uint slot_of_instance[]; };
layout(set = 0, binding = 7, scalar) readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 9, scalar) uniform View { mat4 clip_from_world; };
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

// Neighbouring pixels of one instance show one surface when their normals differ by less than 30°.
const float kMinNormalCosine = 0.866;

bool enclosed(ivec2 at) { return texelFetch(volumes, at, 0).x != 0u; }

// Is the pixel's centre outside the triangle that it shows? By homogeneous edge functions, M. Olano and
// T. Greer, "Triangle Scan Conversion Using 2D Homogeneous Coordinates", Graphics Hardware 1997.
bool hangs_over(ivec2 at) {
    uvec2 id = imageLoad(ids, at).xy;
    SceneInstance placed = instances[slot_of_instance[id.x]];
    vec3 corners[3];
    for (uint i = 0u; i < 3u; ++i) {
        uint vertex = placed.first_vertex + indices[placed.first_index + 3u * id.y + i];
        vec3 p_ws = to_world(placed.world_from_local, positions[vertex]);
        corners[i] = to_clip(clip_from_world, vec4(p_ws, 1.0)).xyw;
    }
    vec3 center = vec3(2.0 * (vec2(at) + 0.5) / vec2(push.size) - 1.0, 1.0);
    vec3 sides = vec3(dot(cross(corners[1], corners[2]), center),
                      dot(cross(corners[2], corners[0]), center),
                      dot(cross(corners[0], corners[1]), center));
    float area = dot(corners[0], cross(corners[1], corners[2]));
    return any(lessThan(sides * area, vec3(0.0)));
}

// The state of most neighbours that face the light too: of those on the same surface, or of all when
// the pixel is alone on its own. The pixel's own with none, or as many of either state.
bool mended(ivec2 at, vec3 normal_ws) {
    uint instance = imageLoad(ids, at).x;
    int votes = 0;
    int surface_votes = 0;
    // Software drivers walk through branches that no pixel takes, but not through loops.
    [[dont_unroll]] for (int i = 0; i < 9; ++i) {
        ivec2 other = at + ivec2(i % 3, i / 3) - 1;
        bool outside = any(lessThan(other, ivec2(0))) ||
                       any(greaterThanEqual(other, ivec2(push.size)));
        if (i == 4 || outside) continue;
        float depth = texelFetch(depths, other, 0).x;
        vec3 other_normal = unpack_unit_vector(imageLoad(normals, other).x);
        vec3 other_es = receiver_position(push.es_from_clip, uvec2(other), push.size, depth);
        if (depth == 0.0 || !faces_light(push.light, other_es, other_normal)) continue;
        int vote = enclosed(other) ? 1 : -1;
        bool same_surface = imageLoad(ids, other).x == instance &&
                            dot(normal_ws, other_normal) >= kMinNormalCosine;
        votes += vote;
        surface_votes += same_surface ? vote : 0;
    }
    if (surface_votes != 0) votes = surface_votes;
    return votes == 0 ? enclosed(at) : votes > 0;
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    ivec2 at = ivec2(pixel);
    float depth = texelFetch(depths, at, 0).x;
    float lit = 1.0;
    if (depth > 0.0) {
        vec3 p_es = receiver_position(push.es_from_clip, pixel, push.size, depth);
        vec3 normal_ws = unpack_unit_vector(imageLoad(normals, at).x);
        bool mend = kMendEdges != 0u && hangs_over(at);
        bool in_shadow = mend ? mended(at, normal_ws) : enclosed(at);
        lit = faces_light(push.light, p_es, normal_ws) && !in_shadow ? 1.0 : 0.0;
    }
    imageStore(visibility, at, vec4(lit));
}
