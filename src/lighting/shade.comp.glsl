#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Adds one light to what each receiver sends to the eye: Lambert and normalised Blinn-Phong. J. Blinn,
// "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977; normalisation after
// T. Akenine-Moeller et al., Real-Time Rendering, 2008. Lights with area shine from their centre here:
// their visibility is exact, their form factor is not.

#include "lighting/lighting.shared.h"
#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2) uniform sampler2D albedos;        // a = specular reflectance
layout(set = 0, binding = 3) uniform sampler2D normal_glosses;  // w = shininess
layout(set = 0, binding = 4, r32f) uniform readonly image2D visibility;
layout(set = 0, binding = 5, rgba32f) uniform image2D lit_sum;   // a = product of visibilities
layout(set = 0, binding = 6, rgba32f) uniform image2D full_sum;  // as if nothing were in the way; a = irradiance / pi
layout(set = 0, binding = 7, scalar) uniform Frame { ShadeFrame frame; };

const float kPi = 3.14159265;
const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);  // Rec. 709

vec3 irradiance_facing(vec3 p_ws, vec3 to_light, float distance_m) {
    vec3 strength = frame.strength;
    if (frame.light.kind != kLightDirectional) strength /= max(distance_m * distance_m, 1e-12);
    float spot = clamp(dot(-to_light, frame.spot_axis) * frame.spot_scale + frame.spot_offset, 0.0, 1.0);
    float emitter = max(dot(-to_light, frame.light.normal), 0.0);
    return strength * spot * spot * mix(1.0, emitter, frame.emits_one_side);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.size))) return;
    ivec2 at = ivec2(pixel);
    vec4 lit = frame.first != 0u ? vec4(0.0, 0.0, 0.0, 1.0) : imageLoad(lit_sum, at);
    vec4 full = frame.first != 0u ? vec4(0.0) : imageLoad(full_sum, at);
    float depth = texelFetch(depths, at, 0).x;
    if (depth > 0.0) {
        vec3 p_ws = receiver_position(frame.world_from_clip, pixel, frame.size, depth);
        vec3 geometric_ws = unpack_unit_vector(imageLoad(normals, at).x);
        vec4 normal_gloss = texelFetch(normal_glosses, at, 0);
        vec3 normal_ws = dot(normal_gloss.xyz, normal_gloss.xyz) > 0.0 ? normalize(normal_gloss.xyz)
                                                                        : geometric_ws;
        if (dot(normal_ws, geometric_ws) < 0.0) normal_ws = -normal_ws;  // seen from the back
        vec3 from_p = to_light_ws(frame.light, p_ws);
        float distance_m = length(from_p);
        vec3 to_light = from_p / max(distance_m, 1e-12);
        vec3 to_eye = normalize(frame.eye_ws - frame.perspective * p_ws);

        float cosine = max(dot(normal_ws, to_light), 0.0);
        if (!faces_light(frame.light, p_ws, geometric_ws)) cosine = 0.0;
        vec3 irradiance = irradiance_facing(p_ws, to_light, distance_m) * cosine;
        vec4 albedo = texelFetch(albedos, at, 0);
        float shininess = normal_gloss.w;
        float lobe = pow(max(dot(normal_ws, normalize(to_light + to_eye)), 0.0), shininess);
        vec3 brdf = albedo.rgb / kPi + albedo.a * lobe * (shininess + 8.0) / (8.0 * kPi);
        float seen = imageLoad(visibility, at).x;
        full += vec4(brdf * irradiance, dot(irradiance, kLuminance) / kPi);
        lit.rgb += brdf * irradiance * seen;
        lit.a *= seen;
    }
    imageStore(lit_sum, at, lit);
    imageStore(full_sum, at, full);
}
