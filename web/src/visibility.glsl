// Occlusion interval maps: W. Donnelly, J. Demers, "Generating Soft Shadows Using Occlusion Interval
// Maps", GPU Gems, 2004, chapter 13. The light counts as a disc, not as a line along its path, and
// what four texels see is mixed, not their times: those of different intervals have no mean.

// Layer 2 p holds the rises of pair p, layer 2 p + 1 its falls, in codes.
uniform highp usampler2DArray intervals;
uniform float at_codes;     // the light's centre on its path
uniform float width_codes;  // of its disc, > 0
uniform float path_codes;
// What is before the path's first step and after its last, as PathEnds has it.
uniform bool closed;
uniform bool begins_up;
uniform bool ends_up;

const vec4 kAlways = vec4(1e9);  // codes

// The part of a disc of radius 1 that lies before x.
vec4 disc_before(vec4 x) {
    vec4 c = clamp(x, -1.0, 1.0);
    return 0.5 + (c * sqrt(1.0 - c * c) + asin(c)) / 3.14159265;
}

vec4 part_seen(vec4 rises, vec4 falls, float at) {
    float radius = 0.5 * width_codes;
    return disc_before((falls - at) / radius) - disc_before((rises - at) / radius);
}

// In [0, 1], as interval_visibility() has it.
float visibility(ivec2 texel) {
    float other_at = at_codes < 0.5 * path_codes ? at_codes + path_codes : at_codes - path_codes;
    float seen = 0.0;
    for (int pair = 0; pair < PAIRS; ++pair) {
        vec4 rises = vec4(texelFetch(intervals, ivec3(texel, 2 * pair), 0));
        vec4 falls = vec4(texelFetch(intervals, ivec3(texel, 2 * pair + 1), 0));
        vec4 exists = vec4(greaterThan(falls, rises));
        if (!closed && begins_up) rises = mix(rises, -kAlways, equal(rises, vec4(0.0)));
        if (!closed && ends_up) falls = mix(falls, kAlways, equal(falls, vec4(path_codes)));
        seen += dot(part_seen(rises, falls, at_codes), exists);
        if (closed) seen += dot(part_seen(rises, falls, other_at), exists);
    }
    return min(seen, 1.0);
}

// How long the texel sees the light, in codes.
float sun_codes(ivec2 texel) {
    float sum = 0.0;
    for (int pair = 0; pair < PAIRS; ++pair) {
        vec4 rises = vec4(texelFetch(intervals, ivec3(texel, 2 * pair), 0));
        vec4 falls = vec4(texelFetch(intervals, ivec3(texel, 2 * pair + 1), 0));
        sum += dot(max(falls - rises, 0.0), vec4(1.0));
    }
    return sum;
}

// Bilinear weights of four results, of the texels from `first` on.
struct Blend {
    ivec2 first, last;
    vec2 part;
};

Blend blend_at(vec2 page_uv) {
    ivec2 side = textureSize(intervals, 0).xy;
    vec2 at = page_uv * vec2(side) - 0.5;
    ivec2 first = ivec2(floor(at));
    return Blend(clamp(first, ivec2(0), side - 1), clamp(first + 1, ivec2(0), side - 1),
                 fract(at));
}

float mixed(Blend b, float upper_left, float upper_right, float lower_left, float lower_right) {
    return mix(mix(upper_left, upper_right, b.part.x), mix(lower_left, lower_right, b.part.x),
               b.part.y);
}

float smooth_visibility(vec2 page_uv) {
    Blend b = blend_at(page_uv);
    return mixed(b, visibility(b.first), visibility(ivec2(b.last.x, b.first.y)),
                 visibility(ivec2(b.first.x, b.last.y)), visibility(b.last));
}

float smooth_sun_codes(vec2 page_uv) {
    Blend b = blend_at(page_uv);
    return mixed(b, sun_codes(b.first), sun_codes(ivec2(b.last.x, b.first.y)),
                 sun_codes(ivec2(b.first.x, b.last.y)), sun_codes(b.last));
}
