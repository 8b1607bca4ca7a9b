// The receiver of a pixel as trace::receiver_on() finds it in double: where the ray through the
// pixel's centre meets the plane of its triangle, moved into that. Depths are too coarse for places
// on a light map, and a centre beside a triangle that is seen edge on is far off. Includers bind
// `instances`, `slot_of_instance`, `positions` and `indices`, as normal.comp.glsl does.

#ifndef GNOMON_RASTER_PIXEL_RECEIVER_GLSL
#define GNOMON_RASTER_PIXEL_RECEIVER_GLSL

#include "raster/scene.shared.h"

// `_es`: the axes of the world with the camera's eye as origin.
struct PixelReceiver {
    vec3 p_es;
    vec3 normal_ws;  // towards the viewer; not a unit vector
};

struct PixelCamera {
    mat4 es_from_clip;
    vec3 eye_ws;
    uvec2 size;  // of the picture
};

PixelReceiver receiver_on(uvec2 id, uvec2 pixel, PixelCamera camera) {
    SceneInstance placed = instances[slot_of_instance[id.x]];
    mat3 linear = mat3(placed.world_from_local);
    vec3 origin_es = placed.world_from_local[3] - camera.eye_ws;
    vec3 corners[3];
    for (int i = 0; i < 3; ++i) {
        uint vertex = indices[placed.first_index + 3u * id.y + uint(i)];
        corners[i] = linear * positions[placed.first_vertex + vertex] + origin_es;
    }
    vec2 ndc = 2.0 * (vec2(pixel) + 0.5) / vec2(camera.size) - 1.0;
    vec4 first = camera.es_from_clip * vec4(ndc, 1.0, 1.0);
    vec4 last = camera.es_from_clip * vec4(ndc, 0.0, 1.0);
    vec3 begin = first.xyz / first.w;
    vec3 way = last.xyz - begin * last.w;  // a far plane may be infinitely far: w = 0

    vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    float facing = dot(normal, way);
    PixelReceiver receiver;
    receiver.p_es = (corners[0] + corners[1] + corners[2]) / 3.0;
    receiver.normal_ws = facing > 0.0 ? -normal : normal;
    if (facing == 0.0) return receiver;
    vec3 hit = begin + dot(normal, corners[0] - begin) / facing * way;
    vec3 weights;
    for (int i = 0; i < 3; ++i) {
        vec3 from = corners[(i + 1) % 3];
        weights[i] = max(dot(cross(corners[(i + 2) % 3] - from, hit - from), normal), 0.0);
    }
    float sum = weights.x + weights.y + weights.z;
    if (sum > 0.0) {
        receiver.p_es =
            (weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2]) / sum;
    }
    return receiver;
}

#endif
