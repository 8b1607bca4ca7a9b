// From a mesh to the screen, the same to the last bit in every pass that includes this: depths of
// receivers, shadow-volume caps and surfaces must be equal where their triangles are.

#ifndef GNOMON_RASTER_TRANSFORM_GLSL
#define GNOMON_RASTER_TRANSFORM_GLSL

vec3 to_world(mat4x3 world_from_local, vec3 p_local) {
    precise vec3 p_ws = world_from_local[0] * p_local.x + world_from_local[1] * p_local.y +
                        world_from_local[2] * p_local.z + world_from_local[3];
    return p_ws;
}

vec4 to_clip(mat4 clip_from_world, vec4 p_ws) {
    precise vec4 p_cs = clip_from_world[0] * p_ws.x + clip_from_world[1] * p_ws.y +
                        clip_from_world[2] * p_ws.z + clip_from_world[3] * p_ws.w;
    return p_cs;
}

#endif
