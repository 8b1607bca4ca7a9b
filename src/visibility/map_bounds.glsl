// What bounds of a map's tiles prove of a filter before it reads a texel: lit, where all depths
// within its reach are behind the receiver's plane; dark, where all are before it. K. Dmitriev,
// Y. Uralsky, "Soft Shadows Using Hierarchical Min-Max Shadow Maps", GDC 2007. Departures: the
// bounds are two planes of the tile's own slope, since between a least and a greatest depth ground
// that the light meets at a slant is nearer than itself; they hold for the tile's neighbours too,
// so that one texel is read; and what is proven is exactly what the filter would find. Includers
// declare kContent and kLayerCount.

#ifndef GNOMON_VISIBILITY_MAP_BOUNDS_GLSL
#define GNOMON_VISIBILITY_MAP_BOUNDS_GLSL

#include "visibility/map_filter.glsl"

const float kProvenLit = 1.0;
const float kProvenDark = 0.0;
const float kNotProven = 0.5;

// Of the numbers that a plane's depth and a bound's are added up from: sixteen roundings of a part
// in 2^24 each.
const float kBoundsRounding = 1.0 / 1048576.0;

// Texels: of places in maps of 16384.
const float kPlaceRounding = 1.0 / 64.0;

// `reach`: in texels, how far from the receiver are the centres that the filter reads; `bounded`:
// how far bounds hold, of which the narrowest that do are read.
float proven_lit(sampler2DArray bounds, float size, vec3 bounded, MapBias bias, MapPoint point,
                 vec2 reach) {
    vec2 r = reach + kPlaceRounding;
    vec2 tile = floor(clamp(point.texel, vec2(0.0), vec2(size - 1.0)) / float(kBoundsTile));
    float farthest = max(r.x, r.y) + 0.5;
    float width = (farthest > bounded.x ? 1.0 : 0.0) + (farthest > bounded.y ? 1.0 : 0.0);
    float layer = width * float(kLayerCount) + point.layer;
    vec4 bound = texelFetch(bounds, ivec3(vec3(tile, layer)), 0);
    vec2 from_middle = point.texel - float(kBoundsTile) * (tile + 0.5);
    float rise = dot(abs(point.gradient), r);
    float before = point.cone * length(r);
    float rounding = kBoundsRounding * (abs(point.depth) + rise + before +
                                        dot(abs(bound.xy), bounded.z + vec2(kBoundsTile)));
    // The receiver's plane above the tile's.
    float above = point.depth - dot(bound.xy, from_middle);
    float spread = dot(abs(point.gradient - bound.xy), r) + rounding;
    // Distances are stored with as many bits as they have, and less by the bias.
    float stored = kContent == kContentDepth ? 0.0 : quantum(kContent) + kBoundsRounding;
    float biased = kContent == kContentDepth
                       ? 0.0
                       : 1.0 - bias.distance_scale + bias.distance_offset + quantum(kContent);
    // The filter keeps planes between 0 and kNearest; a plane that is there anyway may be proven.
    bool lit = above - spread - stored >= bound.w && point.depth + rise + before <= kNearest;
    bool dark = above + spread + before + stored + biased < bound.z && point.depth - rise >= 0.0;
    // Nor does it follow planes farther away from the light.
    float least = bound.z + dot(bound.xy, from_middle) - dot(abs(bound.xy), r) - rounding;
    dark = dark && (rise <= point.fall || point.depth - point.fall + stored + biased < least);
    // Beyond the map's border a filter reads the border again.
    bool inside = farthest <= bounded.z &&
                  all(lessThanEqual(abs(point.texel - 0.5 * size) + r, vec2(0.5 * size - 0.5)));
    bool empty = kContent == kContentDepth && bound.w <= 0.0 && bound.xy == vec2(0.0);
    return !inside ? kNotProven : (lit || empty ? kProvenLit : (dark ? kProvenDark : kNotProven));
}

#endif
