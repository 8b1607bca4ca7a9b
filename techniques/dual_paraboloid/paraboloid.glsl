// Unit directions around a light and where a paraboloid mirror of unit focal length shows them.

#ifndef GNOMON_DUAL_PARABOLOID_PARABOLOID_GLSL
#define GNOMON_DUAL_PARABOLOID_PARABOLOID_GLSL

// The direction against the axis is nowhere; what is nearer to it than this, of 1 + z, is kept
// finite.
const float kLeastAlong = 1e-6;

// Of the unit circle's inside the half-space along the axis.
vec2 place_of(vec3 direction) { return direction.xy / max(1.0 + direction.z, kLeastAlong); }

vec3 direction_at(vec2 place) {
    float square = dot(place, place);
    return vec3(2.0 * place, 1.0 - square) / (1.0 + square);
}

#endif
