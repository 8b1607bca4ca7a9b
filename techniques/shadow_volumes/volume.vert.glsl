#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Caps and sides of shadow volumes, pulled from records: three vertices a cap, three a side of a
// light at infinity (whose volumes end in one point there), six a side of other lights.

#include "raster/scene.shared.h"
#include "raster/transform.glsl"
#include "shadow_volumes.shared.h"

layout(set = 0, binding = 0, scalar) readonly buffer Instances {
    SceneInstance instances[];
};
layout(set = 0, binding = 1, scalar) readonly buffer Positions {
    vec3 positions[];
};
layout(set = 0, binding = 2, scalar) readonly buffer Caps {
    VolumeTriangle caps[];
};
layout(set = 0, binding = 3, scalar) readonly buffer Sides {
    VolumeSide sides[];
};
layout(push_constant, scalar) uniform Push {
    VolumePush push;
};

invariant gl_Position;

vec4 place(uint slot, uint vertex, bool extruded) {
    vec3 p_ws = to_world(instances[slot].world_from_local, positions[vertex]);
    return extruded ? vec4(p_ws * push.light_ws.w - push.light_ws.xyz, 0.0) : vec4(p_ws, 1.0);
}

vec4 cap_vertex(bool far) {
    VolumeTriangle cap = caps[gl_VertexIndex / 3];
    uint corner = gl_VertexIndex % 3;
    if (far) corner = 2u - corner;  // seen from its other side
    return place(cap.slot, corner == 0u ? cap.a : corner == 1u ? cap.b : cap.c, far);
}

vec4 side_vertex() {
    bool at_infinity = push.light_ws.w == 0.0;
    uint vertices = at_infinity ? 3u : 6u;
    VolumeSide side = sides[gl_VertexIndex / vertices];
    // Counter-clockwise from outside: b, a, a extruded; b, a extruded, b extruded.
    uint corner = gl_VertexIndex % vertices;
    bool is_b = corner == 0u || corner == 3u || corner == 5u;
    bool extruded = corner == 2u || corner >= 4u;
    return place(side.slot, is_b ? side.b : side.a, extruded);
}

void main() {
    vec4 p_ws = push.part == kSides ? side_vertex() : cap_vertex(push.part == kFarCaps);
    gl_Position = to_clip(push.clip_from_world, p_ws);
}
