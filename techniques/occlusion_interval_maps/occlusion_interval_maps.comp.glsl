#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

// Where on its page each receiver is, and how much of the light the texels there see: what
// bake::TexelFinder computes in double. Listing 13-1 of the chapter takes four intervals at a time,
// one a channel of two textures; here each texel has a list of up to 64.

#include "occlusion_interval_maps.shared.h"
#include "raster/scene.shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint kLookup = kLookupEdges;
layout(constant_id = 1) const bool kEven = false;

layout(set = 0, binding = 0, rg32ui) uniform readonly uimage2D ids;
layout(set = 0, binding = 1, r32f) uniform writeonly image2D visibility;
layout(set = 0, binding = 2, scalar) readonly buffer Instances { SceneInstance instances[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Slots { uint slot_of_instance[]; };
layout(set = 0, binding = 4, scalar) readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 5, scalar) readonly buffer Indices { uint indices[]; };
// FacetTable::numbers
layout(set = 0, binding = 6, scalar) readonly buffer Numbers { uint facet_numbers[]; };
layout(set = 0, binding = 7, scalar) readonly buffer Facets { PageFacet facets[]; };
layout(set = 0, binding = 8, scalar) readonly buffer Charts { PageChart charts[]; };
layout(set = 0, binding = 9, scalar) readonly buffer Cells { uint first_samples[]; };
layout(set = 0, binding = 10, scalar) readonly buffer Texels { LitTexel texels[]; };
layout(set = 0, binding = 11, scalar) readonly buffer Intervals { uint intervals[]; };
layout(push_constant, scalar) uniform Push { LookupPush push; };

#include "bake/texel_edges.glsl"
#include "raster/pixel_receiver.glsl"

const uint kNoReceiver = 0xffffffffu;

// Of a result.
const float kRounding = 1e-6;

// Texels that are nearer are at one place.
const float kLeastApart_texels = 1.0 / float(kPlaceCodes);

// The facet that a receiver is on, by its triangle and its side, or kNone.
uint facet_of(uvec2 id, vec3 normal_ws) {
    uint first = facet_numbers[id.x] + 2u * id.y;
    for (uint side = 0u; side < 2u; ++side) {
        uint facet = facet_numbers[first + side];
        if (facet != kNone && dot(facets[facet].normal_ws, normal_ws) > 0.0) return facet;
    }
    return kNone;
}

// On the page, in texels; of a chart, whose rectangle it does not leave.
vec2 page_place(PageFacet facet, PageChart chart, vec3 from_ws) {
    float uu = dot(facet.u_ws, facet.u_ws);
    float uv = dot(facet.u_ws, facet.v_ws);
    float vv = dot(facet.v_ws, facet.v_ws);
    float u = dot(facet.u_ws, from_ws);
    float v = dot(facet.v_ws, from_ws);
    vec2 place = facet.place_texels +
                 vec2(vv * u - uv * v, uu * v - uv * u) / (uu * vv - uv * uv);
    return clamp(place, vec2(chart.least_texel), vec2(chart.least_texel + chart.size_texels));
}

uint texel_at(PageChart chart, ivec2 place) {
    ivec2 least = ivec2(chart.least_texel);
    uvec2 at = uvec2(clamp(place, least, least + ivec2(chart.size_texels) - 1));
    return chart.first_texel + at.y * chart.side_texels + at.x;
}

Times times_of(LitTexel texel) {
    return Times(texel.first_interval, bitfieldExtract(texel.count_and_place, 0, kCountBits));
}

// From the texel's own place to where it asks.
vec2 asks_at(LitTexel texel) {
    int place = int(texel.count_and_place);
    return vec2(bitfieldExtract(place, kCountBits, kPlaceBits),
                bitfieldExtract(place, kCountBits + kPlaceBits, kPlaceBits)) /
           float(kPlaceCodes);
}

// The part of a window at `at` that comes after a time of a texel; one at an end of the path that is
// up is before, or after, all windows.
float part_after_time(Times times, uint number, int kind, float at) {
    float time = time_of(times, number, kind);
    if ((push.ends & kClosed) == 0u) {
        if (kind == kRise && time == 0.0 && (push.ends & kBeginsUp) != 0u) return 1.0;
        if (kind == kFall && time == push.path_codes && (push.ends & kEndsUp) != 0u) return 0.0;
    }
    return part_after(time - at, push.width_codes);
}

float seen_by(uint texel) {
    Times times = times_of(texels[texel]);
    float at = push.at_codes;
    float seen = 0.0;
    for (uint place = 0u; place <= (push.ends & kClosed); ++place) {
        for (uint i = 0u; i < times.count; ++i)
            seen += part_after_time(times, i, kRise, at) - part_after_time(times, i, kFall, at);
        at += at < 0.5 * push.path_codes ? push.path_codes : -push.path_codes;
    }
    return clamp(seen, 0.0, 1.0);
}

float by_interpolation(PageChart chart, vec2 place) {
    ivec2 corner = ivec2(floor(place - 0.5));
    vec2 f = place - 0.5 - vec2(corner);
    return mix(mix(seen_by(texel_at(chart, corner)),
                   seen_by(texel_at(chart, corner + ivec2(1, 0))), f.x),
               mix(seen_by(texel_at(chart, corner + ivec2(0, 1))),
                   seen_by(texel_at(chart, corner + ivec2(1, 1))), f.x),
               f.y);
}

// The samples of the fine cell that begins at a texel, or kNone.
uint fine_cell_at(PageChart chart, ivec2 first) {
    if (chart.first_cell == kNone) return kNone;
    uvec2 cell = uvec2(first + 1 - ivec2(chart.least_texel));
    return first_samples[chart.first_cell + cell.y * (chart.size_texels.x + 1u) + cell.x];
}

// What a place is between, but for weights.
Between texels_around(PageChart chart, vec2 place) {
    ivec2 first = ivec2(floor(place - 0.5));
    vec2 f = place - 0.5 - vec2(first);
    uint samples = fine_cell_at(chart, first);
    float parts = float(push.fine_parts);
    vec2 corner = min(floor(f * parts), vec2(parts - 1.0));
    Between between;
    for (int i = 0; i < 4; ++i) {
        ivec2 step = ivec2(i % 2, i / 2);
        LitTexel texel;
        if (samples != kNone) {
            uvec2 at = uvec2(corner) + uvec2(step);
            texel = texels[samples + at.y * (push.fine_parts + 1u) + at.x];
            between.places[i] = (corner + vec2(step)) / parts - f;
        } else {
            ivec2 least = ivec2(chart.least_texel);
            ivec2 at = clamp(first + step, least, least + ivec2(chart.size_texels) - 1);
            texel = texels[texel_at(chart, at)];
            between.places[i] = vec2(at - first) - f;
        }
        between.places[i] += asks_at(texel);
        between.times[i] = times_of(texel);
    }
    return between;
}

// Where 0 is between two places, in [0, 1].
float part_between(float from, float to) {
    if (to - from < kLeastApart_texels) return 0.5;
    return clamp(-from / (to - from), 0.0, 1.0);
}

mat2 normal_from_slope(PageFacet facet) {
    mat2 slope_from_normal =
        -mat2(dot(push.along_ws, facet.u_ws), dot(push.along_ws, facet.v_ws),
              dot(push.across_ws, facet.u_ws), dot(push.across_ws, facet.v_ws));
    float texel_m2 = length(cross(facet.u_ws, facet.v_ws));
    if (abs(determinant(slope_from_normal)) < kLeastSine * texel_m2) return mat2(0.0);
    return inverse(slope_from_normal);
}

float by_edges(PageFacet facet, PageChart chart, vec2 place) {
    Between between = texels_around(chart, place);
    vec2 at[4] = between.places;
    float upper = part_between(at[0].x, at[1].x);
    float lower = part_between(at[2].x, at[3].x);
    float down = part_between(mix(at[0].y, at[1].y, upper), mix(at[2].y, at[3].y, lower));
    between.weights = float[4]((1.0 - down) * (1.0 - upper), (1.0 - down) * upper,
                               down * (1.0 - lower), down * lower);
    return edges_visibility(between, Window(push.at_codes, push.width_codes, push.path_codes,
                                            push.ends, normal_from_slope(facet)));
}

float visibility_at(uvec2 pixel) {
    uvec2 id = imageLoad(ids, ivec2(pixel)).xy;
    if (id.x == kNoReceiver) return 1.0;
    PixelCamera camera = PixelCamera(push.es_from_clip, push.eye_ws, push.size);
    PixelReceiver receiver = receiver_on(id, pixel, camera);
    uint number = facet_of(id, receiver.normal_ws);
    if (number == kNone) return 0.0;
    PageFacet facet = facets[number];
    PageChart chart = charts[facet.chart];
    vec3 from_ws = receiver.p_es - (facet.point_ws - push.eye_ws);
    vec2 place = page_place(facet, chart, from_ws);
    if (kLookup == kLookupNearest) return seen_by(texel_at(chart, ivec2(place)));
    if (kLookup == kLookupInterpolated) return by_interpolation(chart, place);
    return by_edges(facet, chart, place);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    // Weights sum to 1 but for rounding: what is all but lit or dark is.
    float seen = clamp((1.0 + 2.0 * kRounding) * visibility_at(pixel) - kRounding, 0.0, 1.0);
    imageStore(visibility, ivec2(pixel), vec4(seen));
}
