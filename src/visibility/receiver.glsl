// The receiver of a pixel, and whether it faces the light. Includers declare the push constants and
// bind depth and normals; their own specialization constants begin at 1 (LookupPipeline).

#ifndef GNOMON_VISIBILITY_RECEIVER_GLSL
#define GNOMON_VISIBILITY_RECEIVER_GLSL

#include "raster/octahedral.glsl"
#include "visibility/light_shape.shared.h"

// The kind of light that the shader is compiled for.
layout(constant_id = 0) const uint kLightKind = kLightOfAnyKind;

uint kind_of(LightShape light) { return kLightKind == kLightOfAnyKind ? light.kind : kLightKind; }

// In the space that the matrix leads to; positions of lights are in the same.
vec3 receiver_position(mat4 from_clip, uvec2 pixel, uvec2 size, float depth) {
    vec2 ndc = 2.0 * (vec2(pixel) + 0.5) / vec2(size) - 1.0;
    vec4 p = from_clip * vec4(ndc, depth, 1.0);
    return p.xyz / p.w;
}

// Not normalised for lights at a finite distance.
vec3 to_light_ws(LightShape light, vec3 p) {
    return kind_of(light) == kLightDirectional ? light.position : light.position - p;
}

// Does any part of the light lie above the receiver's plane, on the side to which it shines?
bool faces_light(LightShape light, vec3 p, vec3 normal_ws) {
    vec3 to_center = to_light_ws(light, p);
    float height = dot(normal_ws, to_center);
    bool shines_here = kind_of(light) < kLightDisc || dot(light.normal, to_center) < 0.0;
    switch (kind_of(light)) {
        case kLightDirectional:
            height += light.radius;
            break;
        case kLightSphere:  // to the outside
            height += light.radius;
            shines_here = dot(to_center, to_center) > light.radius * light.radius;
            break;
        case kLightDisc:
            height += light.radius * length(cross(normal_ws, light.normal));
            break;
        case kLightRect:
            height += abs(dot(normal_ws, light.half_u)) + abs(dot(normal_ws, light.half_v));
            break;
    }
    return height > 0.0 && shines_here;
}

#endif
