#ifndef GNOMON_RASTER_SCENE_SHARED_H
#define GNOMON_RASTER_SCENE_SHARED_H

#ifdef __cplusplus
#include "gpu/shared_types.h"
namespace gnomon::raster::shared {
using namespace gpu::shared;
#endif

/// One placement of a mesh, in the order of the draws.
struct SceneInstance {
    mat4x3 world_from_local;
    uint instance;      // index into Scene::instances()
    uint first_index;   // of the mesh in the index buffer
    uint first_vertex;  // of the mesh in the vertex buffers
    uint material;
};

/// What shading and alpha masks need of a vertex.
struct VertexAttributes {
    vec3 normal;  // zero: use the geometric normal
    vec2 texcoord;
    uint color;  // RGBA8, linear
};

struct SceneMaterial {
    vec4 base_color;
    mat2 uv_scale_rotation;
    vec2 uv_offset;
    float alpha_cutoff;
    float specular;
    float shininess;
};

struct ScenePush {
    mat4 clip_from_world;
    uint material;
};

struct CasterPush {
    uint material;
};

struct NormalPush {
    vec3 eye_ws;        // perspective
    float perspective;  // 1, or 0: `eye_ws` is the direction towards the viewer
    uvec2 size;
};

#ifdef __cplusplus
}  // namespace gnomon::raster::shared
#endif

#endif
