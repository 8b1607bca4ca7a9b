#include "bake/buried.h"

#include "base/parallel.h"
#include "scene/winding.h"
#include "trace/caster.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace gnomon::bake {

namespace {

using scene::Winding;

constexpr std::size_t kReceiversPerTask = 1024;

/// Vertices at one place are one here.
Winding welded_winding(const Mesh& mesh) {
    if (mesh.triangles.empty()) return Winding::open;
    std::vector<UVec3> welded(mesh.triangles.size());
    meshopt_generateShadowIndexBuffer(&welded.front().x, &mesh.triangles.front().x,
                                      3 * mesh.triangles.size(), mesh.positions.data(),
                                      mesh.positions.size(), sizeof(Vec3), sizeof(Vec3));
    return scene::winding_of(mesh.positions, welded);
}

/// The scene's solids, seen from both sides, and how each mesh is wound. Instances keep their
/// numbers.
struct Solids {
    Scene scene;
    std::vector<Winding> windings;

    explicit Solids(const Scene& from) {
        SceneData data = from.data();
        for (Mesh& mesh : data.meshes) {
            const Material& material = data.materials[mesh.material];
            windings.push_back(material.masked() ? Winding::open : welded_winding(mesh));
            if (!material.masked() && !material.double_sided) windings.back() = Winding::outward;
            if (windings.back() == Winding::open) mesh.triangles.clear();
        }
        for (Material& material : data.materials)
            material.double_sided = true;
        scene = Scene(std::move(data));
    }
};

/// The middle one of the directions that the normal faces.
std::optional<Vec3> middle_facing(std::span<const DVec3> to_light_ws, Vec3 normal_ws) {
    const auto faces = [&](const DVec3& d) { return glm::dot(DVec3(normal_ws), d) > 0.0; };
    auto facing = std::ranges::count_if(to_light_ws, faces);
    if (facing == 0) return std::nullopt;
    facing /= 2;
    for (const DVec3& direction : to_light_ws) {
        if (faces(direction) && facing-- == 0) return Vec3(direction);
    }
    return std::nullopt;
}

/// Rays along a wall go so far aside that they do not run in it.
constexpr float kAside = 0.01f;
/// The height of the normal of what is no wall, but a ground or a ceiling.
constexpr float kNoWall = 0.5f;

/// Where the ground is a sheet, nothing tells its inner side; but below it there is nothing. The
/// foot of a wall is there when it has something above it and nothing below.
bool is_underground(const trace::Caster& caster, const trace::Receiver& receiver) {
    const Vec3 normal_ws = receiver.normal_ws;
    if (std::abs(normal_ws.y) > kNoWall) return false;
    const Vec3 up_wall_ws = glm::normalize(Vec3(0, 1, 0) - normal_ws.y * normal_ws);
    trace::ShadowRays rays(true);
    rays.add(receiver, glm::normalize(up_wall_ws + kAside * normal_ws));
    rays.add(receiver, glm::normalize(-up_wall_ws + kAside * normal_ws));
    caster.trace(rays);
    return rays.blocked(0) && !rays.blocked(1);
}

/// Whether a ray meets an inner side first.
bool begins_inside(const Solids& solids, const trace::Caster& caster, Vec3 origin_ws,
                   Vec3 direction_ws) {
    const trace::SurfaceId hit =
        caster.first_seen(origin_ws, direction_ws, 0.0f, std::numeric_limits<float>::infinity());
    if (hit.instance == trace::kNoReceiver) return false;
    const trace::Triangle triangle = trace::world_triangle(solids.scene, hit);
    const std::uint32_t mesh = solids.scene.instances()[hit.instance].mesh;
    const double outward = solids.windings[mesh] == Winding::outward ? 1.0 : -1.0;
    return outward * glm::dot(triangle.front_normal_ws(), DVec3(direction_ws)) > 0.0;
}

}  // namespace

std::vector<bool> are_buried(const Scene& scene, std::span<const trace::Receiver> receivers,
                             std::span<const std::uint32_t> asked,
                             std::span<const DVec3> to_light_ws, Progress& progress) {
    std::vector<std::uint8_t> buried(asked.size(), 0);
    if (asked.empty()) return {};
    const Solids solids(scene);
    const trace::Caster caster(solids.scene, true, progress);
    const trace::Caster everything(scene, false, progress);
    parallel_for(
        asked.size(), kReceiversPerTask,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const trace::Receiver& receiver = receivers[asked[i]];
                const Vec3 origin_ws = trace::lifted_position_ws(receiver);
                const std::optional<Vec3> to_light = middle_facing(to_light_ws, receiver.normal_ws);
                const bool is_buried =
                    begins_inside(solids, caster, origin_ws, receiver.normal_ws) ||
                    (to_light && begins_inside(solids, caster, origin_ws, *to_light)) ||
                    is_underground(everything, receiver);
                buried[i] = is_buried ? 1 : 0;
            }
        },
        "finding buried texels", &progress);
    return {buried.begin(), buried.end()};
}

}  // namespace gnomon::bake
