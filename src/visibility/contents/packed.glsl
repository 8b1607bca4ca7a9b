// A distance in four bytes: GPU Gems 2004, chapter 12.

#ifndef GNOMON_VISIBILITY_CONTENTS_PACKED_GLSL
#define GNOMON_VISIBILITY_CONTENTS_PACKED_GLSL

// Four bytes, the first of the most weight.
vec4 packed_in_four(float value) {
    vec4 scaled = fract(value * vec4(1.0, 256.0, 65536.0, 16777216.0) * (1.0 - 1.0 / 16777216.0));
    return floor(256.0 * scaled) / 255.0;
}

float unpacked_from_four(vec4 bytes) {
    return dot(bytes, 255.0 / 256.0 * vec4(1.0, 1.0 / 256.0, 1.0 / 65536.0, 1.0 / 16777216.0));
}

#endif
