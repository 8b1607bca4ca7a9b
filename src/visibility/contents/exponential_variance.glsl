// Both of two exponential warps, and the cure of light bleeding: A. Lauritzen, M. McCool, "Layered Variance
// Shadow Maps", GI 2008.

#ifndef GNOMON_VISIBILITY_CONTENTS_EXPONENTIAL_VARIANCE_GLSL
#define GNOMON_VISIBILITY_CONTENTS_EXPONENTIAL_VARIANCE_GLSL

#include "visibility/contents/variance.glsl"

// exp(c d) and -exp(-c d) of distances from -1 to 1, and their squares: two bounds, of which the lower
// counts.
vec4 warped_moments(float along, float exponent) {
    float d = 2.0 * along - 1.0;
    float positive = exp(exponent * d);
    float negative = -exp(-exponent * d);
    return vec4(positive, positive * positive, negative, negative * negative);
}

float lit_by_warped_variance(vec4 moments, float along, float exponent, float least_variance) {
    vec4 receiver = warped_moments(along, exponent);
    // A step in distance is a step in its warp, longer by its slope.
    vec2 step = exponent * vec2(receiver.x, receiver.z);
    return min(most_behind(moments.xy, receiver.x, least_variance * step.x * step.x),
               most_behind(moments.zw, receiver.z, least_variance * step.y * step.y));
}

#endif
