#include "scene/caster_changes.h"

#include <algorithm>
#include <map>
#include <utility>

namespace gnomon::scene {

namespace {

bool same_texture(const Scene& a, int index_a, const Scene& b, int index_b) {
    if (index_a < 0 || index_b < 0) return index_a == index_b;
    const Texture& one = a.textures()[static_cast<std::size_t>(index_a)];
    const Texture& other = b.textures()[static_cast<std::size_t>(index_b)];
    return one.size == other.size && one.wrap_u == other.wrap_u && one.wrap_v == other.wrap_v &&
           one.rgba == other.rgba;
}

/// Colours count, as their alpha cuts holes.
bool same_holes(const Scene& a, const Mesh& mesh_a, const Scene& b, const Mesh& mesh_b) {
    const Material& one = a.materials()[mesh_a.material];
    const Material& other = b.materials()[mesh_b.material];
    if (one.masked() != other.masked()) return false;
    if (!one.masked()) return true;
    return one.alpha_cutoff == other.alpha_cutoff && one.base_color == other.base_color &&
           one.uv_scale_rotation == other.uv_scale_rotation && one.uv_offset == other.uv_offset &&
           mesh_a.texcoords == mesh_b.texcoords && mesh_a.colors == mesh_b.colors &&
           same_texture(a, one.base_color_texture, b, other.base_color_texture);
}

bool cast_alike(const Scene& a, const Mesh& mesh_a, const Scene& b, const Mesh& mesh_b) {
    return mesh_a.positions == mesh_b.positions && mesh_a.triangles == mesh_b.triangles &&
           same_holes(a, mesh_a, b, mesh_b);
}

}  // namespace

std::optional<std::vector<std::uint32_t>> changed_casters(const Scene& before, const Scene& after) {
    const std::size_t count = after.instances().size();
    if (before.instances().size() != count) return {};
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> alike;  // by mesh before and after
    std::vector<std::uint32_t> changed;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Instance& one = before.instances()[i];
        const Instance& other = after.instances()[i];
        const auto [meshes, is_new] = alike.try_emplace({one.mesh, other.mesh});
        if (is_new) {
            meshes->second =
                cast_alike(before, before.meshes()[one.mesh], after, after.meshes()[other.mesh]);
        }
        if (!meshes->second || one.world_from_local != other.world_from_local) changed.push_back(i);
    }
    if (changed.size() == count) return {};
    return changed;
}

}  // namespace gnomon::scene
