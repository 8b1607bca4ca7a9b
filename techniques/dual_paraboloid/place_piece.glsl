// The corner of a piece of a caster's triangle. Includers are tessellation evaluation shaders.

#ifndef GNOMON_DUAL_PARABOLOID_PLACE_PIECE_GLSL
#define GNOMON_DUAL_PARABOLOID_PLACE_PIECE_GLSL

#include "dual_paraboloid.shared.h"
#include "paraboloid.glsl"

layout(triangles, equal_spacing, ccw) in;
layout(location = 0) in vec3 corner_ls[];
layout(location = 1) in uint corner_vertex[];
layout(location = 2) patch in vec3 edges_rad;
layout(location = 3) patch in vec3 plane;
layout(location = 4) patch in mat3 sides;
layout(location = 0) flat out vec3 piece_plane;
layout(location = 1) flat out mat3 piece_sides;

layout(push_constant, scalar) uniform Push { LayerPush push; };

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[1];
};

// An edge without angle, of which there is one piece.
const float kLeastRad = 1e-6;

// Decides where there is nothing else to weigh by.
const float kLeastWeight = 1e-30;

// Of the corners' directions, so that an edge's pieces have equal angles at the light however far
// its ends are, as K. Shoemake's "Animating Rotation with Quaternion Curves", SIGGRAPH 1985, goes
// along an arc; within the triangle a mean of its edges' weights, of one scale, lest a short edge pulls all
// pieces towards its ends. `at`: barycentric.
vec3 arc_weights(vec3 at) {
    const float kQuarter = 1.57079633;
    vec3 rad = max(edges_rad, kLeastRad);
    vec3 scale = sin(min(rad, kQuarter));  // of half a circle the sine is 0
    vec3 by_next = sin(at * rad.zxy) / scale.zxy;      // along the edge to the next corner
    vec3 by_previous = sin(at * rad.yzx) / scale.yzx;  // and to the one before
    precise vec3 sum = at.yzx * by_next + at.zxy * by_previous + kLeastWeight * at;
    return sum / (at.yzx + at.zxy + kLeastWeight);
}

// Puts the vertex into the map and returns the corners' barycentric weights there. w is the
// distance, so that what is interpolated over the piece is as on the triangle.
vec3 place_piece() {
    vec3 distances =
        max(vec3(length(corner_ls[0]), length(corner_ls[1]), length(corner_ls[2])), kLeastWeight);
    vec3 weights = arc_weights(gl_TessCoord) / distances;
    weights /= weights.x + weights.y + weights.z;
    precise vec3 p_ls =
        weights.x * corner_ls[0] + weights.y * corner_ls[1] + weights.z * corner_ls[2];
    float distance_m = length(p_ls);
    vec3 direction = p_ls / max(distance_m, kLeastWeight);
    gl_Position = vec4(distance_m / push.reach * place_of(direction), push.near_m, distance_m);
    gl_ClipDistance[0] = p_ls.z - push.rim * distance_m;
    piece_plane = plane;
    piece_sides = sides;
    return weights;
}

#endif
