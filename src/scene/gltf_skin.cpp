#include "base/check.h"
#include "scene/gltf_accessor.h"
#include "scene/gltf_mesh.h"

#include <glm/gtc/matrix_inverse.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <optional>

namespace gnomon::scene {

namespace {

constexpr std::size_t kInfluencesPerSet = 4;
constexpr std::size_t kNumbersPerMatrix = 16;

// How far, roughly, a skinned mesh reaches from its first joint: decides only whether its vertices
// need an origin of their own.
constexpr double kSkinReach_m = 1.0;

struct Influences {
    std::vector<std::uint32_t> joints;  // kInfluencesPerSet for each vertex
    std::vector<float> weights;
};

std::vector<Influences> read_influences(GltfDocument& document,
                                        const tinygltf::Primitive& primitive, const Mesh& mesh,
                                        Warnings& warnings) {
    std::vector<Influences> sets;
    for (int set = 0;; ++set) {
        const auto joints = primitive.attributes.find(fmt::format("JOINTS_{}", set));
        const auto weights = primitive.attributes.find(fmt::format("WEIGHTS_{}", set));
        const bool none = joints == primitive.attributes.end();
        if (none != (weights == primitive.attributes.end())) {
            warnings.add("joints without weights, or weights without joints, are left out",
                         mesh.name);
            return sets;
        }
        if (none) return sets;
        Influences influences{
            read_integers(document, joints->second, static_cast<int>(kInfluencesPerSet)),
            read_floats(document, weights->second, static_cast<int>(kInfluencesPerSet))};
        const std::size_t needed = mesh.positions.size() * kInfluencesPerSet;
        if (influences.joints.size() != needed || influences.weights.size() != needed) {
            warnings.add("joints of another number than positions are left out", mesh.name);
            return sets;
        }
        sets.push_back(std::move(influences));
    }
}

std::vector<glm::dmat4> read_bind_matrices(GltfDocument& document, const tinygltf::Skin& skin,
                                           Warnings& warnings) {
    std::vector<glm::dmat4> matrices(skin.joints.size(), glm::dmat4(1.0));
    if (skin.inverseBindMatrices < 0) return matrices;
    const std::vector<float> numbers =
        read_floats(document, skin.inverseBindMatrices, static_cast<int>(kNumbersPerMatrix));
    if (numbers.size() < skin.joints.size() * kNumbersPerMatrix) {
        warnings.add("a skin has fewer bind matrices than joints", skin.name);
    }
    const std::size_t count = std::min(matrices.size(), numbers.size() / kNumbersPerMatrix);
    for (std::size_t m = 0; m < count; ++m) {
        for (std::size_t i = 0; i < kNumbersPerMatrix; ++i) {
            matrices[m][static_cast<int>(i / 4)][static_cast<int>(i % 4)] =
                numbers[m * kNumbersPerMatrix + i];
        }
    }
    return matrices;
}

// Blends the joints' matrices of one vertex; the mean is affine whatever the weights add up to.
std::optional<glm::dmat4> blended(const std::vector<Influences>& sets, std::size_t vertex,
                                  std::span<const glm::dmat4> world_from_bind, bool& faulty) {
    glm::dmat4 sum(0.0);
    double total = 0.0;
    for (const Influences& set : sets) {
        for (std::size_t i = 0; i < kInfluencesPerSet; ++i) {
            const double weight = set.weights[vertex * kInfluencesPerSet + i];
            const std::uint32_t joint = set.joints[vertex * kInfluencesPerSet + i];
            if (weight == 0.0) continue;
            if (joint >= world_from_bind.size() || !(weight > 0.0) || !std::isfinite(weight)) {
                faulty = true;
                continue;
            }
            sum += weight * world_from_bind[joint];
            total += weight;
        }
    }
    if (!(total > 0.0)) return std::nullopt;
    return sum / total;
}

}  // namespace

bool bake_skin(GltfDocument& document, const tinygltf::Primitive& primitive, int skin_index,
               std::span<const glm::dmat4> world_from_node, DraftMesh& draft, Warnings& warnings) {
    Mesh& mesh = draft.mesh;
    const tinygltf::Skin& skin = document.model().skins[static_cast<std::size_t>(skin_index)];
    if (skin.joints.empty()) fail_input("skins[{}]: has no joints", skin_index);
    const std::vector<Influences> sets = read_influences(document, primitive, mesh, warnings);
    if (sets.empty()) return false;
    std::vector<glm::dmat4> world_from_bind = read_bind_matrices(document, skin, warnings);
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        world_from_bind[i] =
            world_from_node[static_cast<std::size_t>(skin.joints[i])] * world_from_bind[i];
    }
    // The same for all primitives of the skin, so that they still meet.
    const DVec3 first_joint(world_from_bind.front()[3]);
    draft.origin_m = recentring_offset_m({first_joint - kSkinReach_m, first_joint + kSkinReach_m});

    std::size_t faulty_count = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        bool faulty = false;
        const std::optional<glm::dmat4> blend = blended(sets, v, world_from_bind, faulty);
        const glm::dmat4 world_from_local = blend.value_or(world_from_bind.front());
        if (faulty || !blend) ++faulty_count;
        const glm::dvec4 p = world_from_local * glm::dvec4(mesh.positions[v], 1.0);
        mesh.positions[v] = Vec3(DVec3(p) - draft.origin_m);
        if (!mesh.normals.empty()) {
            const glm::dmat3 normal_matrix = glm::inverseTranspose(glm::dmat3(world_from_local));
            mesh.normals[v] = Vec3(normal_matrix * DVec3(mesh.normals[v]));
        }
    }
    if (faulty_count > 0) {
        warnings.add("vertices with impossible joints or weights follow the others or the first",
                     mesh.name, faulty_count);
    }
    return true;
}

}  // namespace gnomon::scene
