#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Receivers against a map of any projection and content and up to eight layers.

#include "visibility/map_lookup.shared.h"
#include "visibility/receiver_survey.shared.h"

layout(local_size_x = kSurveyBlock_px, local_size_y = kSurveyBlock_px) in;
layout(constant_id = 1) const uint kFilter = kFilterBox4x4;
layout(constant_id = 2) const uint kContent = kContentDepth;
layout(constant_id = 3) const uint kTaps = 16u;  // of filters that have no number of their own
layout(constant_id = 4) const uint kLayerCount = 1u;
layout(constant_id = 5) const uint kAffine = 1u;  // all texels of a layer are of one size
layout(constant_id = 6) const uint kLayerChoice = kChooseByDistance;
layout(constant_id = 7) const uint kProof = kProofNone;
layout(constant_id = 8) const uint kListed = 0u;  // only blocks of pixels that are listed

layout(set = 0, binding = 7) uniform usampler2DArray map_ids;  // of kContentObjectId

#include "visibility/contents/exponential.glsl"
#include "visibility/contents/exponential_variance.glsl"
#include "visibility/contents/moments.glsl"
#include "visibility/contents/variance.glsl"
#include "visibility/filters/box_3x3.glsl"
#include "visibility/filters/box_4x4.glsl"
#include "visibility/filters/disc.glsl"
#include "visibility/filters/dithered_4.glsl"
#include "visibility/filters/footprint.glsl"
#include "visibility/filters/hardware_2x2.glsl"
#include "visibility/filters/nearest.glsl"
#include "visibility/filters/taps_16.glsl"
#include "visibility/map_bias.glsl"
#include "visibility/map_bounds.glsl"
#include "visibility/receiver.glsl"

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 3) uniform sampler2DArray map;
layout(set = 0, binding = 4, scalar) uniform Frame { MapFrame frame; };
layout(set = 0, binding = 5) uniform sampler2DArray bounds;
layout(set = 0, binding = 6, scalar) readonly buffer Blocks { uint blocks[]; };
layout(set = 0, binding = 8, rg32ui) uniform readonly uimage2D receiver_ids;
layout(push_constant, scalar) uniform Push { MapLookupPush push; };

#include "visibility/filters/pcss.glsl"

// Of pixels without a receiver, whose values are not used: keeps their places finite.
const float kLeastDepth = 1e-12;

// Of a filter's result.
const float kRounding = 1e-6;

struct Layer {
    MapLayerFrame map;
    float index;
};

// The last layer that begins before the receiver, or the one along whose axis it is farthest. All are read
// and one is chosen, number by number: an index that differs between pixels would be followed pixel by pixel.
Layer layer_of(float depth, vec3 p_es, float noise) {
    Layer layer = Layer(frame.layers[push.first_layer], float(push.first_layer));
    float blended_depth = depth * (1.0 - frame.blend * noise);  // as if up to so much farther away
    for (uint i = 1u; i < kLayerCount; ++i) {
        MapLayerFrame next = frame.layers[push.first_layer + i];
        bool chosen = kLayerChoice == kChooseByDistance
                          ? blended_depth < next.first_depth
                          : dot(next.w, vec4(p_es, 1.0)) > dot(layer.map.w, vec4(p_es, 1.0));
        layer.map.u = mix(layer.map.u, next.u, bvec4(chosen));
        layer.map.v = mix(layer.map.v, next.v, bvec4(chosen));
        layer.map.z = mix(layer.map.z, next.z, bvec4(chosen));
        layer.map.w = mix(layer.map.w, next.w, bvec4(chosen));
        layer.map.steps = mix(layer.map.steps, next.steps, bvec3(chosen));
        layer.map.bias_scale = chosen ? next.bias_scale : layer.map.bias_scale;
        layer.map.space.tangents = mix(layer.map.space.tangents, next.space.tangents, bvec4(chosen));
        layer.map.space.reach = chosen ? next.space.reach : layer.map.space.reach;
        layer.index = chosen ? float(push.first_layer + i) : layer.index;
    }
    return layer;
}

// Of contents that are blurred, what is left of light.
float lit_by_blurred(MapPoint point) {
    vec2 at = clamp(point.texel, vec2(0.5), vec2(frame.size_texels - 0.5));
    vec2 corner = floor(at - 0.5);
    vec2 f = at - 0.5 - corner;
    ivec2 i = ivec2(corner);
    ivec2 j = min(i + 1, int(frame.size_texels) - 1);
    int layer = int(point.layer);
    vec4 row0 = mix(texelFetch(map, ivec3(i, layer), 0),
                    texelFetch(map, ivec3(j.x, i.y, layer), 0), f.x);
    vec4 row1 = mix(texelFetch(map, ivec3(i.x, j.y, layer), 0),
                    texelFetch(map, ivec3(j, layer), 0), f.x);
    vec4 content = mix(row0, row1, f.y);
    float along = distance_along(point.space, clamp(point.depth, 0.0, kNearest));
    MapReadingFrame reading = frame.reading;
    float lit = 1.0;
    switch (kContent) {
        case kContentExponential:
            return min(content.x / warped(along, reading.exponent), 1.0);
        case kContentVariance:
            lit = most_behind(content.xy, along, reading.least_variance);
            break;
        case kContentExponentialVariance:
            lit = lit_by_warped_variance(content, along, reading.exponent, reading.least_variance);
            break;
        case kContentMoments:
            lit = lit_by_moments(content, along);
            break;
    }
    return clamp((lit - reading.bleeding) / (1.0 - reading.bleeding), 0.0, 1.0);
}

// How far from the receiver are the centres of what the filter reads, in texels along the axes.
vec2 filter_reach(MapPoint point, TexelAt texel, vec3 to_light, mat2 footprint) {
    const float kBilinear = 1.0;
    switch (kFilter) {
        case kFilterNearest:
            return vec2(0.5);
        case kFilterHardware2x2:
            return vec2(kBilinear);
        case kFilterBox3x3:
            return vec2(1.5);
        case kFilterDithered4:
        case kFilterTaps16:
            return vec2(1.5 + kBilinear);
        case kFilterDisc:
            return vec2(frame.reading.radius_texels + kBilinear);
        case kFilterFootprint:
            return 0.5 * (abs(footprint[0]) + abs(footprint[1])) + kBilinear;
        case kFilterPcss:
            mat2 axes = transpose(at_least_a_texel(pcss_search_m(point, texel, to_light),
                                                   texels_across_light(texel, to_light)));
            return vec2(length(axes[0]), length(axes[1])) + kBilinear;
    }
    return vec2(2.0);
}

// `needed`: false where the result is not used.
float filtered(MapPoint point, TexelAt texel, vec3 to_light, mat2 footprint, uvec2 pixel,
               bool needed) {
    if (kContent >= kContentExponential) return lit_by_blurred(point);
    float size = frame.size_texels;
    uint taps = needed ? kTaps : 0u;
    if (kFilter > kFilterBox4x4) point = ended_by_fetch(map, size, point);
    switch (kFilter) {
        case kFilterNearest:
            return lit_nearest(map, size, frame.bias, point);
        case kFilterHardware2x2:
            return lit_hardware_2x2(map, size, frame.bias, point);
        case kFilterBox3x3:
            return lit_box_3x3(map, size, frame.bias, point);
        case kFilterDithered4:
            return lit_dithered_4(map, size, frame.bias, point, pixel);
        case kFilterTaps16:
            return lit_taps_16(map, size, frame.bias, point, needed ? 16u : 0u);
        case kFilterDisc:
            return lit_disc(map, size, frame.bias, point, mat2(frame.reading.radius_texels),
                            gradient_noise(pixel), taps);
        case kFilterFootprint:
            return lit_footprint(map, size, frame.bias, point, footprint, gradient_noise(pixel), taps);
        case kFilterPcss:
            return lit_pcss(point, texel, to_light, gradient_noise(pixel), taps);
    }
    return lit_box_4x4(map, size, frame.bias, point);
}

// From a pixel to the next on the receiver's plane, in texels.
vec2 step_on_plane(TexelAt texel, vec3 p_es, vec3 normal_ws, uvec2 next, float depth) {
    // Two points of the next pixel's ray.
    vec3 far = receiver_position(frame.receivers.es_from_clip, next, frame.receivers.size, depth);
    vec3 near = receiver_position(frame.receivers.es_from_clip, next, frame.receivers.size, 1.5 * depth);
    vec3 along = far - near;
    float slope = dot(normal_ws, along);
    float least = 1e-3 * length(along);
    slope = slope < 0.0 ? min(slope, -least) : max(slope, least);
    vec3 hit = far + along * dot(normal_ws, p_es - far) / slope;
    vec2 texels = vec2(dot(texel.u, hit - p_es), dot(texel.v, hit - p_es));
    return texels * min(1.0, frame.reading.most_texels / max(length(texels), 1e-6));
}

// `known`: what is known beforehand, or kNotProven.
float lit_by_map(vec3 p_es, uint object, TexelAt texel, Layer layer, vec3 to_light, mat2 footprint,
                 uvec2 pixel, float known) {
    vec4 p = vec4(p_es, 1.0);
    vec3 uvz = vec3(dot(layer.map.u, p), dot(layer.map.v, p), dot(layer.map.z, p));
    float w = kAffine != 0u ? 1.0 : dot(layer.map.w, p);
    uvz /= w;
    MapPoint point = MapPoint(frame.size_texels * uvz.xy, uvz.z,
                              frame.bias.receiver_plane * texel.gradient,
                              frame.bias.cone * length(texel.gradient),
                              kMaxFall * texel.side_m * max(dot(texel.z, to_light), 0.0), kNearest,
                              layer.index, layer.map.space, object);
    float lit = known;
    if (kProof != kProofNone) {
        float proven = proven_lit(bounds, frame.size_texels, frame.bounded_texels, frame.bias,
                                  point, filter_reach(point, texel, to_light, footprint));
        lit = lit == kNotProven ? proven : lit;
        if (kProof == kProofShown) return lit;
        // A branch for devices that leave it out; software drivers walk through both of its sides,
        // but leave the loops of `filtered` after one turn that no pixel needs.
        bool needed = lit == kNotProven;
        if (needed) lit = filtered(point, texel, to_light, footprint, pixel, needed);
    } else {
        lit = filtered(point, texel, to_light, footprint, pixel, true);
    }
    // Weights sum to 1 but for rounding: what is all but lit or dark is.
    precise float rounded = (1.0 + 2.0 * kRounding) * lit - kRounding;
    lit = clamp(rounded, 0.0, 1.0);
    // Maps that are chosen among by their axis hold all receivers, and so do the sun's; what the bias moves
    // across their border is looked up there.
    if (kLightKind == kLightDirectional || kLayerChoice == kChooseByAxis) return lit;
    bool inside = w > 0.0 && all(lessThanEqual(abs(uvz.xy - 0.5), vec2(0.5)));
    return inside ? lit : 1.0;
}

uvec2 pixel_looked_at() {
    if (kListed == 0u) return gl_GlobalInvocationID.xy;
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint block = blocks[push.first_block + group];
    return kSurveyBlock_px * uvec2(block & 0xffffu, block >> 16) + gl_LocalInvocationID.xy;
}

// Without branches: software drivers walk through both sides of each, and read constants and textures
// slowly within.
void main() {
    uvec2 pixel = pixel_looked_at();
    ivec2 at = ivec2(min(pixel, frame.receivers.size - 1u));
    float depth = texelFetch(depths, at, 0).x;
    vec3 p_es = receiver_position(frame.receivers.es_from_clip, pixel, frame.receivers.size, max(depth, kLeastDepth));
    vec3 normal_ws = unpack_unit_vector(imageLoad(normals, at).x);
    vec3 to_light = to_light_ws(frame.receivers.light, p_es);
    if (kLightKind != kLightDirectional) to_light = normalize(to_light);  // which is that already
    Layer layer = layer_of(depth, p_es, gradient_noise(pixel));
    TexelAt texel = kAffine != 0u
                        ? affine_texel(layer.map, frame.size_texels, normal_ws, to_light)
                        : projective_texel(layer.map, frame.size_texels, p_es, normal_ws);
    MapBias bias = frame.bias;
    bias.constant *= layer.map.bias_scale;
    vec3 biased_es = biased_position(p_es, normal_ws, to_light, texel, bias);
    mat2 footprint = mat2(0.0);
    if (kFilter == kFilterFootprint) {
        float near_depth = max(depth, kLeastDepth);
        footprint = mat2(step_on_plane(texel, p_es, normal_ws, pixel + uvec2(1u, 0u), near_depth),
                         step_on_plane(texel, p_es, normal_ws, pixel + uvec2(0u, 1u), near_depth));
    }
    bool faces = faces_light(frame.receivers.light, p_es, normal_ws);
    float known = depth > 0.0 ? (faces ? kNotProven : kProvenDark) : kProvenLit;
    uint object = kContent == kContentObjectId ? imageLoad(receiver_ids, at).x : 0u;
    float lit = lit_by_map(biased_es, object, texel, layer, to_light, footprint, pixel, known);
    lit = faces ? lit : 0.0;
    if (all(lessThan(pixel, frame.receivers.size))) {
        imageStore(visibility, at, vec4(depth > 0.0 ? lit : 1.0));
    }
}
