#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// How finely a caster's triangle is divided, so that its straight edges follow the map's arcs. The
// map is stereographic: an edge, seen from the light part of a great circle of normal m, is part of
// a circle there, of the radius 1 / |m.z|; a chord c of it is off by c² |m.z| / 8 in its middle.

#include "dual_paraboloid.shared.h"

layout(vertices = 3) out;
layout(location = 0) in vec3 p_ls[];
layout(location = 1) in uint vertex[];
layout(location = 0) out vec3 corner_ls[];
layout(location = 1) out uint corner_vertex[];
layout(location = 2) patch out vec3 edges_rad;  // opposite of each corner
layout(location = 3) patch out vec3 plane;      // as write_depth.glsl reads it
layout(location = 4) patch out mat3 sides;

layout(push_constant, scalar) uniform Push { LayerPush push; };

const float kMostSegments = 64.0;  // every device can; at 2048 texels a half circle takes 51

// Beyond the rim the map grows without bounds: a piece that crosses it must end soon.
const float kLeastSegmentsPerRad = 2.0;

// Keeps directions and normals finite.
const float kLeast = 1e-30;

// A piece's angle is such that its chord is off by no more than half a texel where the map is
// finest on it, at the end nearer to the rim.
float segments(vec3 a, vec3 b, out float angle_rad) {
    vec3 across = cross(a, b);
    float sine = length(across);
    angle_rad = atan(sine, dot(a, b));
    float bend = abs(across.z) / max(sine, kLeast);
    float scale = min(1.0 / max(1.0 + min(a.z, b.z), kLeast), 1.0 / (1.0 + push.rim));
    float per_rad = max(push.segments_per_rad * scale * sqrt(bend), kLeastSegmentsPerRad);
    return push.segments_per_rad > 0.0 ? clamp(ceil(angle_rad * per_rad), 1.0, kMostSegments) : 1.0;
}

// What a unit direction's product with is near_m over the distance along it: that is linear on a
// plane.
vec3 plane_of(vec3 a, vec3 b, vec3 c, vec3 distances) {
    vec3 normal = cross(b - a, c - a);
    float least = min(distances.x, min(distances.y, distances.z));
    vec3 nearest = distances.x == least ? a : (distances.y == least ? b : c);
    float height = dot(normal, nearest);
    return height != 0.0 ? push.near_m / height * normal : vec3(0.0);
}

void main() {
    corner_ls[gl_InvocationID] = p_ls[gl_InvocationID];
    corner_vertex[gl_InvocationID] = vertex[gl_InvocationID];
    if (gl_InvocationID != 0) return;
    vec3 distances = vec3(length(p_ls[0]), length(p_ls[1]), length(p_ls[2]));
    vec3 a = p_ls[0] / max(distances.x, kLeast);
    vec3 b = p_ls[1] / max(distances.y, kLeast);
    vec3 c = p_ls[2] / max(distances.z, kLeast);
    plane = plane_of(p_ls[0], p_ls[1], p_ls[2], distances);
    float winding = dot(cross(a, b), c) < 0.0 ? -1.0 : 1.0;
    sides = winding * mat3(cross(b, c), cross(c, a), cross(a, b));
    vec3 angles_rad;
    vec3 levels = vec3(segments(b, c, angles_rad.x), segments(c, a, angles_rad.y),
                       segments(a, b, angles_rad.z));
    edges_rad = angles_rad;
    // Directions beyond the rim are a convex cone: what has its corners there is all there.
    bool hidden = max(a.z, max(b.z, c.z)) < push.rim;
    if (hidden) levels = vec3(0.0);
    gl_TessLevelOuter[0] = levels.x;
    gl_TessLevelOuter[1] = levels.y;
    gl_TessLevelOuter[2] = levels.z;
    gl_TessLevelInner[0] = max(levels.x, max(levels.y, levels.z));
}
