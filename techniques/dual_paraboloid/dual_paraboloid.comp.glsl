#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Receivers against the two hemispheres around a light. A texel is compared with where its own
// centre's ray meets the receiver's plane, which is what the plane would have stored there: on a
// plane there is no acne.

#include "dual_paraboloid.shared.h"
#include "paraboloid.glsl"
#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 1) const uint kFilter = kFilterBox3x3;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 3) uniform sampler2DArray map;
layout(set = 0, binding = 4, scalar) uniform Frame { MapFrame frame; };
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

// Of pixels without a receiver, whose values are not used: keeps their places finite.
const float kLeastDepth = 1e-12;

// A surface at 84° to the light; steeper ones are moved as this one.
const float kMaxSlope = 10.0;

// A plane at 89°: steeper ones are extended as this one, since normals of 16 bits would tell too
// little.
const float kMaxPlaneSlope = 50.0;

// A plane's depths are kept between what is no caster and what touches the light.
const float kNearest = 1.0 - 1.0 / 1048576.0;

// Of a filter's result.
const float kRounding = 1e-6;

// A receiver, from the light, in the space of its layer.
struct Point {
    vec3 direction;  // unit
    vec3 normal;
    float depth;
    vec2 texel;      // texel i reaches from i to i + 1
    int layer;
};

// Moved off its surface and towards the light, by what surfaces beside its plane may rise above it.
vec3 biased(vec3 p_ls, vec3 normal_ls) {
    float distance_m = length(p_ls);
    vec3 to_light = -p_ls / distance_m;
    float texel_rad = (1.0 + abs(to_light.z)) * 2.0 * frame.reach / frame.size_texels;
    float side_m = distance_m * texel_rad;
    float cosine = max(dot(normal_ls, to_light), 1.0 / kMaxSlope);
    float gain_m = side_m * length(cross(normal_ls, to_light));  // times 1 / cosine along the light
    return p_ls + frame.normal_offset * gain_m * normal_ls +
           (frame.bias_constant * side_m + frame.bias_slope * gain_m / cosine) * to_light;
}

Point point_of(vec3 p_ls, vec3 normal_ls) {
    bool along = p_ls.z >= 0.0 || frame.layers == 1u;
    vec3 turned = vec3(1.0, 1.0, along ? 1.0 : -1.0);
    float distance_m = length(p_ls);
    Point point;
    point.direction = turned * p_ls / distance_m;
    point.normal = turned * normal_ls;
    point.depth = frame.near_m / distance_m;
    point.texel = frame.size_texels * (0.5 * place_of(point.direction) / frame.reach + 0.5);
    point.layer = along ? 0 : 1;
    return point;
}

float lit_by_texel(Point point, vec2 texel) {
    vec2 place = frame.reach * (2.0 * (texel + 0.5) / frame.size_texels - 1.0);
    float falling = min(dot(point.normal, point.direction), -1.0 / kMaxPlaneSlope);
    float gain = dot(point.normal, direction_at(place) - point.direction) / falling;
    float plane = clamp(point.depth * (1.0 + gain), 0.0, kNearest);
    ivec2 at = ivec2(clamp(texel, vec2(0.0), vec2(frame.size_texels - 1.0)));
    return plane >= texelFetch(map, ivec3(at, point.layer), 0).x ? 1.0 : 0.0;
}

float filtered(Point point) {
    if (kFilter == kFilterNearest) return lit_by_texel(point, floor(point.texel));
    int side = kFilter == kFilterBilinear2x2 ? 2 : 3;
    vec2 first = floor(point.texel - 0.5 * float(side - 1));
    vec2 f = point.texel - 0.5 * float(side - 1) - first;
    float lit = 0.0;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            // The outermost texels have the share that the filter covers of them.
            vec2 weight = mix(mix(vec2(1.0), 1.0 - f, equal(ivec2(x, y), ivec2(0))), f,
                              equal(ivec2(x, y), ivec2(side - 1)));
            lit += weight.x * weight.y * lit_by_texel(point, first + vec2(x, y));
        }
    }
    // Weights sum to 1 but for rounding: what is all but lit or dark is.
    lit /= float((side - 1) * (side - 1));
    return clamp((1.0 + 2.0 * kRounding) * lit - kRounding, 0.0, 1.0);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    ivec2 at = ivec2(min(pixel, push.size - 1u));
    float depth = texelFetch(depths, at, 0).x;
    vec3 p_es = receiver_position(push.es_from_clip, pixel, push.size, max(depth, kLeastDepth));
    vec3 normal_ws = unpack_unit_vector(imageLoad(normals, at).x);
    mat3 ws_from_ls = mat3(frame.right, frame.up, frame.forward);
    vec3 p_ls = (p_es - push.light.position) * ws_from_ls;
    vec3 normal_ls = normal_ws * ws_from_ls;
    float lit = filtered(point_of(biased(p_ls, normal_ls), normal_ls));
    bool shines = frame.layers == 2u || length(place_of(normalize(p_ls))) <= frame.cone;
    lit = shines ? lit : 1.0;
    lit = faces_light(push.light, p_es, normal_ws) ? lit : 0.0;
    if (all(lessThan(pixel, push.size))) {
        imageStore(visibility, at, vec4(depth > 0.0 ? lit : 1.0));
    }
}
