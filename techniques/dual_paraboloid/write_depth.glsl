// The depth of a caster's triangle where a texel centre's ray meets its plane, which is not what
// the corners of its pieces are interpolated to. Where the ray passes by the triangle, of whose
// edges pieces are off by half a texel, it is what is interpolated: a plane that is seen almost
// edge on would be anywhere. Includers are fragment shaders.

#ifndef GNOMON_DUAL_PARABOLOID_WRITE_DEPTH_GLSL
#define GNOMON_DUAL_PARABOLOID_WRITE_DEPTH_GLSL

#include "dual_paraboloid.shared.h"
#include "paraboloid.glsl"

layout(location = 0) flat in vec3 piece_plane;  // its product with a direction is the depth there
layout(location = 1) flat in mat3 piece_sides;  // and of these not below 0 within the triangle

layout(push_constant, scalar) uniform Push { LayerPush push; };

void write_depth() {
    vec3 direction = direction_at(push.reach * (2.0 * gl_FragCoord.xy / push.size_texels - 1.0));
    float depth = dot(piece_plane, direction);
    // A triangle all around the light is to one side of it; what touches the light hides nothing.
    if (depth <= 0.0 || depth >= 1.0) discard;
    bool within = all(greaterThanEqual(direction * piece_sides, vec3(0.0)));
    gl_FragDepth = within ? depth : gl_FragCoord.z;
}

#endif
