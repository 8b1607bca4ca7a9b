// Unit vectors in 32 bits by the octahedral map, off by at most 6.1e-5 rad. Q. Meyer et al., "On
// Floating-Point Normal Vectors", EGSR 2010; Z. Cigolle et al., "A Survey of Efficient Representations
// for Independent Unit Vectors", JCGT 2014.

#ifndef GNOMON_RASTER_OCTAHEDRAL_GLSL
#define GNOMON_RASTER_OCTAHEDRAL_GLSL

vec2 sign_not_zero(vec2 v) { return vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0); }

uint pack_unit_vector(vec3 v) {
    vec2 p = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    if (v.z <= 0.0) p = (1.0 - abs(p.yx)) * sign_not_zero(p);
    return packSnorm2x16(p);
}

vec3 unpack_unit_vector(uint bits) {
    vec2 p = unpackSnorm2x16(bits);
    vec3 v = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (v.z < 0.0) v.xy = (1.0 - abs(v.yx)) * sign_not_zero(v.xy);
    return normalize(v);
}

#endif
