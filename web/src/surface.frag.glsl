// A surface of the model: lit by sun and sky, in false colours of its hours of sun, or as the numbers
// that tell what a click has hit.

precision highp float;
precision highp int;

const int kLit = 0;
const int kHours = 1;
const int kTexel = 2;  // x and y of the texel, each a low and a high byte
const int kPage = 3;   // the page + 1
const int kDepth = 4;  // of the window, in 24 bits
const int kVisibility = 5;  // in 16 bits

uniform int mode;
uniform vec4 base_color;  // linear
uniform float alpha_cutoff;
uniform vec3 to_sun_ws;
uniform float most_codes;  // at the end of the colours
uniform float page;
#ifdef HAS_MAP
uniform sampler2D map;
#endif

varying vec2 page_uv;
varying vec2 map_uv;
varying vec3 normal_ws;
varying vec4 tint;

// Strengths that look right on a screen where white is 1; the sun reddens below 15 degrees or so.
const vec3 kHighSun = vec3(0.98, 0.93, 0.84);
const vec3 kLowSun = vec3(0.92, 0.66, 0.42);
const float kLowSine = 0.26;
const vec3 kSky = vec3(0.36, 0.41, 0.48);
const vec3 kGround = vec3(0.23, 0.21, 0.19);

// Of the sun; a surface that is turned away sees none of it.
float seen(vec3 normal) {
    return dot(normal, to_sun_ws) > 0.0 ? smooth_visibility(page_uv) : 0.0;
}

vec3 lit(vec3 albedo, vec3 normal) {
    vec3 sky = mix(kGround, kSky, 0.5 + 0.5 * normal.y);
    vec3 sun = mix(kLowSun, kHighSun, smoothstep(0.0, kLowSine, to_sun_ws.y));
    return albedo * (sky + sun * dot(normal, to_sun_ws) * seen(normal));
}

// Little shading, so that edges show and colours stay those of the legend.
vec3 hours(vec3 normal) {
    return false_color(smooth_sun_codes(page_uv) / most_codes) * (0.94 + 0.06 * normal.y);
}

vec2 bytes(int number) {
    return vec2(number & 255, number >> 8 & 255) / 255.0;
}

void main() {
    vec4 color = base_color * tint;
#ifdef HAS_MAP
    color *= texture2D(map, map_uv);
#endif
    if (color.a < alpha_cutoff) discard;
    vec3 normal = normalize(gl_FrontFacing ? normal_ws : -normal_ws);
    if (mode == kLit) {
        gl_FragColor = vec4(lit(color.rgb, normal), 1.0);
        #include <colorspace_fragment>
    } else if (mode == kHours) {
        gl_FragColor = vec4(hours(normal), 1.0);  // the legend's sRGB as it stands
    } else if (mode == kTexel) {
        ivec2 side = textureSize(intervals, 0).xy;
        ivec2 texel = clamp(ivec2(floor(page_uv * vec2(side))), ivec2(0), side - 1);
        gl_FragColor = vec4(bytes(texel.x), bytes(texel.y));
    } else if (mode == kPage) {
        gl_FragColor = vec4(bytes(int(page) + 1), 0.0, 1.0);
    } else if (mode == kVisibility) {
        gl_FragColor = vec4(bytes(int(seen(normal) * 65535.0 + 0.5)), 0.0, 1.0);
    } else {
        int depth = int(gl_FragCoord.z * 16777215.0);
        gl_FragColor = vec4(bytes(depth), bytes(depth >> 16));
    }
}
