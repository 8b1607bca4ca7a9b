#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// What lighting needs of the visible surface: base colour, shading normal, gloss.

#include "raster/material.glsl"

layout(location = 1) in vec2 texcoord;
layout(location = 2) in vec4 color;
layout(location = 3) in vec3 normal_ws;
layout(location = 0) out vec4 albedo;       // linear base colour; alpha = specular reflectance
layout(location = 1) out vec4 normal_gloss;  // world-space shading normal, or zero; w = shininess

layout(set = 0, binding = 2, scalar) readonly buffer Materials { SceneMaterial materials[]; };
layout(set = 0, binding = 3) uniform sampler2D base_color;
layout(push_constant, scalar) uniform Push { ScenePush push; };

void main() {
    SceneMaterial material = materials[push.material];
    vec2 uv = material_uv(material, texcoord);
    // The level of detail from what was interpolated: lavapipe reads no buffers for the pixels beside the
    // triangle, so that `uv` differs from them by anything.
    vec3 texel = textureGrad(base_color, uv, material.uv_scale_rotation * dFdx(texcoord),
                             material.uv_scale_rotation * dFdy(texcoord))
                     .rgb;
    albedo = vec4(material.base_color.rgb * texel * color.rgb, material.specular);
    float len = length(normal_ws);
    normal_gloss = vec4(len > 0.0 ? normal_ws / len : vec3(0.0), material.shininess);
}
