#pragma once

#include <gnomon/scene.h>

namespace gnomon::trace {

/// Alpha of `texture` at `uv`, in [0, 1]: bilinear between texel centres at half-integers of level
/// 0, wrapped as the texture says, as Vulkan samples it (Vulkan 1.3, section 16.6). 1 for a texture
/// without texels; a `uv` that is not finite counts as 0.
float texture_alpha(const Texture& texture, Vec2 uv);

/// Alpha of triangle `primitive` of `mesh` at the barycentric coordinates `u`, `v` of its second
/// and third corner: the material's base colour * its texture * the corners' colours.
float surface_alpha(const Scene& scene, const Mesh& mesh, std::uint32_t primitive, float u,
                    float v);

/// True where the alpha mask of the mesh's material lets light through.
bool is_hole(const Scene& scene, const Mesh& mesh, std::uint32_t primitive, float u, float v);

}  // namespace gnomon::trace
