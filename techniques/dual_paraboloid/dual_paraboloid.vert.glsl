#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Corners of casters, from the light.

#include "dual_paraboloid.shared.h"

layout(location = 0) in vec3 position;
layout(location = 1) in mat4 ls_from_local;
layout(location = 0) out vec3 p_ls;
layout(location = 1) out uint vertex;

layout(push_constant, scalar) uniform Push { LayerPush push; };

void main() {
    vec3 p = (ls_from_local * vec4(position, 1.0)).xyz;
    p_ls = vec3(p.xy, push.side * p.z);
    vertex = gl_VertexIndex;
}
