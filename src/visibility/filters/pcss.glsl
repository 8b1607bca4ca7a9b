// The light's own penumbra: R. Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH 2005 sketches. Departures:
// in metres, from the light's own size, and over ellipses of the map, so that it is as wide in any map.
// Includers declare `map` and `frame`.

#ifndef GNOMON_VISIBILITY_FILTERS_PCSS_GLSL
#define GNOMON_VISIBILITY_FILTERS_PCSS_GLSL

#include "visibility/filters/disc.glsl"

// The mean depth of what hides the receiver within an ellipse of the map; 0 where nothing does.
float blocker_depth(sampler2DArray map, float size, MapBias bias, MapPoint point, mat2 spread,
                    float turn, uint taps) {
    float sum = 0.0;
    float blockers = 0.0;
    for (uint i = 0u; i < taps; ++i) {
        vec2 at = point.texel + spread * disc_sample(i, turn);
        vec2 texel = clamp(floor(at), 0.0, size - 1.0);
        vec2 d = texel + 0.5 - point.texel;
        float plane = plane_depths(point, vec4(d.x), vec4(d.y)).x;
        float stored = stored_distance(map, size, texel, point);
        float depth = stored;
        bool hides = stored > plane;
        if (!kStoresDepths) {
            depth = depth_of(point.space, (texel + 0.5) / size, stored);
            hides = compared_distance(point, bias, size, texel, plane) > stored;
        }
        sum += hides ? depth : 0.0;
        blockers += hides ? 1.0 : 0.0;
    }
    return sum / max(blockers, 1.0);
}

// Texels of the map that the light, seen from the receiver, covers for each metre across it.
mat2 texels_across_light(TexelAt texel, vec3 to_light) {
    vec3 aside = abs(to_light.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 across = normalize(cross(to_light, aside));
    vec3 other = cross(to_light, across);
    return mat2(dot(texel.u, across), dot(texel.v, across), dot(texel.u, other), dot(texel.v, other));
}

// How far PCSS searches, in metres across the light: no penumbra of the sun is wider.
float pcss_search_m(MapPoint point, TexelAt texel, vec3 to_light) {
    float most_m = frame.reading.most_texels * texel.side_m;
    float depth_per_m = max(dot(texel.z, to_light), 1e-20);
    float search_m = frame.receivers.light.radius * (1.0 - point.depth) / depth_per_m;
    return kLightKind == kLightDirectional ? min(search_m, most_m) : most_m;
}

// The map's ellipse of a disc of this radius, no narrower than a texel whichever way texels are long:
// a matrix to it from the unit disc. As P. Heckbert, "Fundamentals of Texture Mapping and Image Warping",
// 1989, adds the footprint of a texel to that of a pixel.
mat2 at_least_a_texel(float radius_m, mat2 texels_per_m) {
    mat2 spread = radius_m * texels_per_m;
    mat2 squared = spread * transpose(spread) + mat2(1.0);
    float along_u = sqrt(squared[0][0]);
    float shear = squared[0][1] / along_u;
    return mat2(along_u, shear, 0.0, sqrt(max(squared[1][1] - shear * shear, 1.0)));
}

// The light's own penumbra: as wide as the light looks from what hides it, in metres across the light.
float lit_pcss(MapPoint point, TexelAt texel, vec3 to_light, float turn, uint taps) {
    float most_m = frame.reading.most_texels * texel.side_m;
    float depth_per_m = max(dot(texel.z, to_light), 1e-20);
    bool at_infinity = kLightKind == kLightDirectional;
    mat2 texels = texels_across_light(texel, to_light);
    mat2 search = at_least_a_texel(pcss_search_m(point, texel, to_light), texels);
    float blocker = blocker_depth(map, frame.size_texels, frame.bias, point, search, turn, taps);
    float behind = at_infinity ? (blocker - point.depth) / depth_per_m
                               : blocker / max(point.depth, 1e-20) - 1.0;
    float penumbra_m = clamp(frame.receivers.light.radius * behind, 0.0, most_m);
    float lit = lit_disc(map, frame.size_texels, frame.bias, point,
                         at_least_a_texel(penumbra_m, texels), turn, taps);
    return blocker > 0.0 ? lit : 1.0;
}

#endif
