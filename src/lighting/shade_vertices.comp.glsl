#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Sets what each receiver sends to the eye to its diffuse light as vertices have it, made more or
// less by "averaged L": S. Dietrich, "More on Shadowing", developer's journal, GameDev.net, undated.
// As bump_factor() computes it, in the world: the flat surface's normal is the triangle's, the bump
// the shading normal.

#include "lighting/lighting.shared.h"
#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2) uniform sampler2D albedos;
layout(set = 0, binding = 3) uniform sampler2D normal_glosses;
layout(set = 0, binding = 4, rgba32f) uniform writeonly image2D lit_sum;
layout(set = 0, binding = 5, scalar) readonly buffer Shades { VertexShade shades[]; };
layout(push_constant, scalar) uniform Push { VertexPush push; };

const float kPi = 3.14159265;

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    ivec2 at = ivec2(pixel);
    vec3 radiance = vec3(0.0);
    if (texelFetch(depths, at, 0).x > 0.0) {
        VertexShade shade = shades[pixel.y * push.size.x + pixel.x];
        vec3 geometric_ws = unpack_unit_vector(imageLoad(normals, at).x);
        vec3 bump_ws = texelFetch(normal_glosses, at, 0).xyz;
        if (dot(bump_ws, bump_ws) == 0.0) bump_ws = geometric_ws;
        bump_ws = normalize(bump_ws);
        if (dot(bump_ws, geometric_ws) < 0.0) bump_ws = -bump_ws;  // seen from the back
        float flat_cosine = dot(shade.averaged_ws, geometric_ws);
        float factor = 1.0;
        if (push.most_factor > 0.0 && flat_cosine > 0.0)
            factor = min(max(dot(shade.averaged_ws, bump_ws), 0.0) / flat_cosine, push.most_factor);
        radiance = texelFetch(albedos, at, 0).rgb / kPi * shade.irradiance * factor;
    }
    imageStore(lit_sum, at, vec4(radiance, 1.0));
}
