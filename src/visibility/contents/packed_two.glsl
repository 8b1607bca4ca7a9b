// A distance in two bytes of four: GPU Gems 2004, chapter 12.

#ifndef GNOMON_VISIBILITY_CONTENTS_PACKED_TWO_GLSL
#define GNOMON_VISIBILITY_CONTENTS_PACKED_TWO_GLSL

// The whole of 256ths, and the rest.
vec4 packed_in_two(float value) {
    float scaled = min(256.0 * value, 255.998);
    return vec4(floor(scaled) / 255.0, vec3(fract(scaled)));
}

float unpacked_from_two(vec4 bytes) { return (255.0 * bytes.x + bytes.y) / 256.0; }

#endif
