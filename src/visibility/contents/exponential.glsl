// Distances warped so that their mean over what is nearer hides little: T. Annen et al., "Exponential Shadow
// Maps", GI 2008.

#ifndef GNOMON_VISIBILITY_CONTENTS_EXPONENTIAL_GLSL
#define GNOMON_VISIBILITY_CONTENTS_EXPONENTIAL_GLSL

// exp(c d) of a distance from -1 to 1, over exp(c).
float warped(float along, float exponent) { return exp(2.0 * exponent * (along - 1.0)); }

#endif
