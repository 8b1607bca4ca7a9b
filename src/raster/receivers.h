#pragma once

#include <gnomon/scene.h>

#include "gpu/commands.h"
#include "raster/gpu_scene.h"

namespace gnomon::raster {

/// In `Receivers::ids`: nothing is seen at this pixel.
inline constexpr std::uint32_t kNoReceiver = 0xffffffffu;

/// What is seen from somewhere, in device memory.
struct SeenIds {
    gpu::Image depth;  ///< D32S8, reversed Z, 0 = nothing; the stencil is for anyone to use
    gpu::Image ids;    ///< RG32UI: index into Scene::instances(), triangle of its mesh
};

/// What the camera sees.
struct Receivers : SeenIds {
    Extent size;
    Camera camera;
    gpu::Image normals;  ///< R32UI: geometric normal towards the viewer, octahedral

    /// From pixel (x, y, depth) in NDC to the world, of the camera that was drawn.
    Mat4 world_from_clip() const;
    /// The same with the camera's eye as the world's origin: exact far from that too.
    Mat4 eye_from_clip() const;
};

/// What the camera sees looks like; for lighting.
struct Surfaces {
    gpu::Image albedo;        ///< RGBA8 sRGB: base colour; alpha = specular reflectance
    gpu::Image normal_gloss;  ///< RGBA16F: shading normal in the world, or zero; shininess
};

/// Draws depth and ids.
class IdPass {
public:
    explicit IdPass(const gpu::Device& device);

    /// Allocates `out` when its size is another one; it is in use as targets afterwards. The
    /// stencil is cleared. `hide_backs`: of single-sided materials.
    void record(gpu::Commands& commands, const GpuScene& scene, const Mat4& clip_from_world,
                Extent size, bool ignore_alpha, bool hide_backs, SeenIds& out);

private:
    const gpu::Device& device_;
    gpu::Pipeline opaque_, masked_;
};

/// Draws receivers: their depth, ids and normals.
class ReceiverPass {
public:
    explicit ReceiverPass(const gpu::Device& device);

    /// Allocates `out` when its size is another one.
    void record(gpu::Commands& commands, const GpuScene& scene, const Camera& camera, Extent size,
                bool ignore_alpha, Receivers& out);

private:
    const gpu::Device& device_;
    IdPass ids_;
    gpu::Pipeline normal_;
};

/// Draws the looks of the surfaces that a ReceiverPass found.
class SurfacePass {
public:
    explicit SurfacePass(const gpu::Device& device);

    void record(gpu::Commands& commands, const GpuScene& scene, Receivers& receivers,
                Surfaces& out);

private:
    const gpu::Device& device_;
    gpu::Pipeline surface_;
};

}  // namespace gnomon::raster
