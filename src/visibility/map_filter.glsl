// How much of a depth map's filter is lit. Each texel is compared with the receiver's own plane at that
// texel's centre, where the plane's stored depth is just that, so that a plane needs no bias however wide
// the filter. G. King, "Shadow Mapping Algorithms", NVIDIA 2004; J. Isidoro, "Shadow Mapping: GPU-based Tips
// and Techniques", GDC 2006, for receiver planes; here at texel centres, from the exact normal. Includers
// declare kContent and kTaps, and bind map_ids.

#ifndef GNOMON_VISIBILITY_MAP_FILTER_GLSL
#define GNOMON_VISIBILITY_MAP_FILTER_GLSL

#include "visibility/contents/packed.glsl"
#include "visibility/contents/packed_two.glsl"
#include "visibility/map_content.glsl"
#include "visibility/map_lookup.shared.h"

// A plane's depths are kept between what is no caster and what is clamped to the near plane: neither hides
// nor lights a receiver for being extended or biased beyond.
const float kNearest = 1.0 - 1.0 / 1048576.0;

// What is looked up, in texels of a layer.
struct MapPoint {
    vec2 texel;      // texel i reaches from i to i + 1
    float depth;     // reversed; a texel that is nearer to the light hides it
    vec2 gradient;   // of the receiver's plane, depth per texel
    float cone;      // depth that texels may be nearer to the light, for each texel that they are away
    float fall;      // depth that the plane is followed away from the light, and no farther
    float end;       // the depth that it is followed to towards the light
    float layer;
    MapSpace space;  // of its layer
    uint object;     // whose surface it is
};

// The receiver's own plane at texels' centres. Where it falls away steeply it soon ends at another surface,
// which lies before the plane and yet behind the receiver, and does not hide it.
vec4 plane_depths(MapPoint point, vec4 dx, vec4 dy) {
    vec4 planes = point.depth + point.gradient.x * dx + point.gradient.y * dy;
    if (kFilter >= kFilterDisc) planes += point.cone * sqrt(dx * dx + dy * dy);  // else it is 0
    return clamp(planes, max(point.depth - point.fall, 0.0), point.end);
}

const bool kStoresDepths = kContent == kContentDepth || kContent == kContentObjectId;

// As if nothing were there, where the map sees the receiver's own object.
float of_others(float depth, float size, vec2 texel, MapPoint point) {
    if (kContent != kContentObjectId) return depth;
    ivec3 at = ivec3(vec3(clamp(texel, vec2(0.0), vec2(size - 1.0)), point.layer));
    return texelFetch(map_ids, at, 0).x == point.object ? 0.0 : depth;
}

// Or the depth, where that is stored.
float stored_distance(sampler2DArray map, float size, vec2 texel, MapPoint point) {
    vec4 bytes = texelFetch(map, ivec3(vec3(clamp(texel, vec2(0.0), vec2(size - 1.0)), point.layer)), 0);
    if (kStoresDepths) return of_others(bytes.x, size, texel, point);
    return kContent == kContentPackedTwo ? unpacked_from_two(bytes)
                                         : (kContent == kContentPacked ? unpacked_from_four(bytes)
                                                                       : bytes.x);
}

// The distance that a depth would have been stored as, made less by what the bias allows.
float compared_distance(MapPoint point, MapBias bias, float size, vec2 texel, float depth) {
    float distance = distance_of(point.space, (texel + 0.5) / size, depth);
    return distance * bias.distance_scale - bias.distance_offset - quantum(kContent);
}

// Where the nearest texel is that the receiver's plane falls away to: its own surface is no nearer to the
// light there than itself.
vec2 fallen_texel(MapPoint point) {
    return floor(point.texel - 0.5) + vec2(lessThan(point.gradient, vec2(0.0)));
}

// The point, its plane followed no farther towards the light than halfway to what hides the texel that it
// falls away to. A wall ends below the eaves that hide it, but its plane goes on through the roof, and would
// be lit above.
MapPoint ended(MapPoint point, float size, float stored) {
    float depth = stored;
    if (!kStoresDepths) {
        depth = depth_of(point.space, (fallen_texel(point) + 0.5) / size, stored);
    }
    bool hidden = depth - point.depth > point.fall;
    point.end = min(hidden ? 0.5 * (point.depth + depth) : kNearest, kNearest);
    return point;
}

// What is stored in the square with the corner (i, j): in (i, j+1), (i+1, j+1), (i+1, j), (i, j), the order
// of a gather.
vec4 stored_quad(sampler2DArray map, float size, MapPoint point, vec2 corner) {
    if (kContent == kContentDepth) {
        return textureGather(map, vec3((corner + 1.0) / size, point.layer));
    }
    return vec4(stored_distance(map, size, corner + vec2(0.0, 1.0), point),
                stored_distance(map, size, corner + vec2(1.0, 1.0), point),
                stored_distance(map, size, corner + vec2(1.0, 0.0), point),
                stored_distance(map, size, corner, point));
}

// Of a square's four texels, the one in the column and row that are chosen.
float chosen(vec4 quad, bvec2 second) {
    vec2 row = second.y ? quad.xy : quad.wz;
    return second.x ? row.y : row.x;
}

// Which of them are lit.
vec4 lit_quad(vec4 stored, float size, MapBias bias, MapPoint point, vec2 corner) {
    vec2 d = corner + 0.5 - point.texel;
    vec4 planes = plane_depths(point, d.x + vec4(0.0, 1.0, 1.0, 0.0), d.y + vec4(1.0, 1.0, 0.0, 0.0));
    if (kStoresDepths) return vec4(greaterThanEqual(planes, stored));
    vec4 distances = vec4(
        compared_distance(point, bias, size, corner + vec2(0.0, 1.0), planes.x),
        compared_distance(point, bias, size, corner + vec2(1.0, 1.0), planes.y),
        compared_distance(point, bias, size, corner + vec2(1.0, 0.0), planes.z),
        compared_distance(point, bias, size, corner, planes.w));
    return vec4(lessThanEqual(distances, stored));
}

float mixed(vec4 quad, vec2 f) { return mix(mix(quad.w, quad.z, f.x), mix(quad.x, quad.y, f.x), f.y); }

float lit_bilinear(sampler2DArray map, float size, MapBias bias, MapPoint point, vec2 at) {
    vec2 corner = floor(at - 0.5);
    vec4 stored = stored_quad(map, size, point, corner);
    return mixed(lit_quad(stored, size, bias, point, corner), at - 0.5 - corner);
}

// The point, for filters whose taps are anywhere.
MapPoint ended_by_fetch(sampler2DArray map, float size, MapPoint point) {
    return ended(point, size, stored_distance(map, size, fallen_texel(point), point));
}

// Of a pixel, in [0, 1): neighbours differ as much as they can. J. Jimenez, "Next Generation Post
// Processing in Call of Duty: Advanced Warfare", SIGGRAPH 2014 courses.
float gradient_noise(uvec2 pixel) {
    return fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))));
}

#endif
