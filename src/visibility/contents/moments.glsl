// Four moments of distances: C. Peters, R. Klein, "Moment Shadow Mapping", I3D 2015.

#ifndef GNOMON_VISIBILITY_CONTENTS_MOMENTS_GLSL
#define GNOMON_VISIBILITY_CONTENTS_MOMENTS_GLSL

// Moments are moved this far towards those of an even spread, lest rounding make them impossible: less
// lights the ground behind a caster's foot by up to 50 texels, more everywhere lightens shadows.
const float kMomentBias = 1e-5;

// Of a spread over both ends of the range, 0.4 each, and its middle, 0.2. Over the ends alone a texel at an
// end, as where casters are clamped to a warped map's near plane, is without the three places that the problem
// needs; with more in the middle (Peters' and Klein's 0.625) light leaks three texels under a caster's foot.
const vec4 kSpreadMoments = vec4(0.0, 0.8, 0.0, 0.8);

// Of a distance from -1 to 1: of one from 0 to 1 what rounding leaves of their differences is a sixteenth as
// good, and shows as specks of light in shadows.
vec4 powers(float along) {
    float d = 2.0 * along - 1.0;
    return vec4(d, d * d, d * d * d, d * d * d * d);
}

// Of all distributions with these four moments, the one with the least before the receiver: Hamburger's
// problem, by a Cholesky factorisation of the moments' matrix and the roots of a quadratic.
float lit_by_moments(vec4 moments, float along) {
    float at = 2.0 * along - 1.0;
    vec4 b = mix(moments, kSpreadMoments, kMomentBias);
    float l32_d22 = b.z - b.x * b.y;
    float d22 = b.y - b.x * b.x;
    float variance_of_square = b.w - b.y * b.y;
    float d33_d22 = dot(vec2(variance_of_square, -l32_d22), vec2(d22, l32_d22));
    float l32 = l32_d22 / d22;
    vec3 c = vec3(1.0, at, at * at);
    c.y -= b.x;
    c.z -= b.y + l32 * c.y;
    c.y /= d22;
    c.z *= d22 / d33_d22;
    c.y -= l32 * c.z;
    c.x -= dot(c.yz, b.xy);
    float p = c.y / c.z;
    float root = sqrt(max(0.25 * p * p - c.x / c.z, 0.0));
    float near = -0.5 * p - root;
    float far = -0.5 * p + root;
    // Before both roots nothing hides the receiver; behind the first it counts whole, between them in part.
    vec4 part = far < at ? vec4(near, at, 1.0, 1.0)
                            : (near < at ? vec4(at, near, 0.0, 1.0) : vec4(0.0));
    float quotient = (part.x * far - b.x * (part.x + far) + b.y) /
                     ((far - part.y) * (at - near));
    return 1.0 - clamp(part.z + part.w * quotient, 0.0, 1.0);
}

#endif
