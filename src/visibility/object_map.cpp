#include "visibility/object_map.h"

#include "visibility/object_map.shared.h"

#include <glm/ext/matrix_double4x4.hpp>

namespace gnomon {

ObjectMap::ObjectMap(const gpu::Device& device)
    : draw_(device),
      frame_(device, sizeof(shared::ObjectMapFrame),
             VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
             gpu::Placement::device) {}

void ObjectMap::record(gpu::Commands& commands, const raster::GpuScene& scene, const LightFit& fit,
                       const Camera& camera, bool ignore_alpha) {
    draw_.record(commands, scene, Mat4(fit.clip_from_world), {fit.size_texels, fit.size_texels},
                 ignore_alpha, false, map_);
    commands.use(map_.depth, gpu::Use::sampled);
    commands.use(map_.ids, gpu::Use::storage_read);
    glm::dmat4 clip = fit.clip_from_world;
    clip[3] = clip * glm::dvec4(DVec3(camera.eye_ws()), 1.0);
    commands.update(frame_,
                    shared::ObjectMapFrame{.clip_from_es = Mat4(clip),
                                           .size_texels = static_cast<float>(fit.size_texels)});
}

}  // namespace gnomon
