#include "scene/gltf.h"

#include "base/check.h"
#include "base/parallel.h"
#include "scene/gltf_accessor.h"
#include "scene/gltf_document.h"
#include "scene/gltf_material.h"
#include "scene/gltf_mesh.h"
#include "scene/gltf_pose.h"
#include "scene/gltf_view.h"
#include "scene/load_mesh.h"
#include "scene/load_texture.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace gnomon::scene {

namespace {

// EXT_mesh_gpu_instancing: the transforms of a node's instances.
std::vector<glm::dmat4> read_gpu_instances(GltfDocument& document,
                                           const tinygltf::Value& extension) {
    const tinygltf::Value& attributes = extension.Get("attributes");
    const auto read = [&](const std::string& name, int components) -> std::vector<float> {
        const auto accessor = static_cast<int>(number_in(attributes, name, -1.0));
        if (accessor < 0) return {};
        return read_floats(document, accessor, components);
    };
    const std::vector<float> translations = read("TRANSLATION", 3);
    const std::vector<float> rotations = read("ROTATION", 4);
    const std::vector<float> scales = read("SCALE", 3);
    const std::size_t count =
        std::max({translations.size() / 3, rotations.size() / 4, scales.size() / 3});
    const auto fits = [&](const std::vector<float>& values, std::size_t width) {
        return values.empty() || values.size() == count * width;
    };
    if (!fits(translations, 3) || !fits(rotations, 4) || !fits(scales, 3)) {
        fail_input("EXT_mesh_gpu_instancing: its attributes have different lengths");
    }
    document.spend(count * sizeof(DraftInstance));
    std::vector<glm::dmat4> transforms(count);
    for (std::size_t i = 0; i < count; ++i) {
        NodeTransform transform;
        if (!translations.empty()) {
            const float* t = &translations[i * 3];
            transform.translation = {t[0], t[1], t[2]};
        }
        if (!rotations.empty()) {
            const float* r = &rotations[i * 4];  // x, y, z, w
            transform.rotation = glm::dquat(r[3], r[0], r[1], r[2]);
        }
        if (!scales.empty()) {
            const float* s = &scales[i * 3];
            transform.scale = {s[0], s[1], s[2]};
        }
        transforms[i] = transform.parent_from_node();
    }
    return transforms;
}

class GltfLoader {
public:
    GltfLoader(std::vector<std::uint8_t> file, LoadContext& context)
        : context_(context), document_(std::move(file), context) {}

    Draft load() {
        const tinygltf::Model& model = document_.model();
        GltfMaterials materials = read_materials(document_, context_, draft_.textures);
        draft_.materials = std::move(materials.materials);
        texcoord_sets_ = std::move(materials.texcoord_sets);
        pose_ = pose_nodes(document_, context_);
        const std::vector<int> nodes = visible_nodes(document_, context_);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            throw_if_cancelled(context_.progress, "loading the scene");
            context_.progress.report("loading the scene",
                                     static_cast<double>(i) / static_cast<double>(nodes.size()));
            const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(nodes[i])];
            if (node.mesh >= 0) add_node(static_cast<std::size_t>(nodes[i]), node);
        }
        read_cameras_and_lights(document_, nodes, pose_.world_from_node, context_, draft_);
        return std::move(draft_);
    }

private:
    void add_node(std::size_t index, const tinygltf::Node& node) {
        const tinygltf::Mesh& mesh = document_.model().meshes[static_cast<std::size_t>(node.mesh)];
        std::vector<glm::dmat4> placements{pose_.world_from_node[index]};
        const tinygltf::Value* gpu = find_extension(node.extensions, "EXT_mesh_gpu_instancing");
        if (gpu != nullptr && gpu->Has("attributes") && gpu->Get("attributes").IsObject()) {
            placements = read_gpu_instances(document_, *gpu);
            for (glm::dmat4& placement : placements)
                placement = pose_.world_from_node[index] * placement;
        }
        const std::vector<double>& weights =
            pose_.morph_weights[index].empty() ? mesh.weights : pose_.morph_weights[index];
        const std::string& name = node.name.empty() ? mesh.name : node.name;
        for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
            const tinygltf::Primitive& primitive = mesh.primitives[p];
            if (node.skin >= 0) {
                if (add_skinned(primitive, mesh.name, weights, node.skin, name)) continue;
            }
            add_instances(mesh_for(node.mesh, p, weights), placements, name);
        }
        next_object_ += static_cast<std::uint32_t>(placements.size());
    }

    bool add_skinned(const tinygltf::Primitive& primitive, const std::string& mesh_name,
                     const std::vector<double>& weights, int skin, const std::string& name) {
        DraftMesh draft{read(primitive, mesh_name, weights)};
        if (draft.mesh.triangles.empty()) return false;
        if (!bake_skin(document_, primitive, skin, pose_.world_from_node, draft,
                       context_.warnings)) {
            return false;
        }
        add_instances(keep(std::move(draft)), {glm::dmat4(1.0)}, name);
        return true;
    }

    // Nodes share a mesh, unless morph weights tell them apart. Nothing when it has no triangles.
    std::optional<std::uint32_t> mesh_for(int mesh_index, std::size_t primitive_index,
                                          const std::vector<double>& weights) {
        const tinygltf::Mesh& mesh = document_.model().meshes[static_cast<std::size_t>(mesh_index)];
        const tinygltf::Primitive& primitive = mesh.primitives[primitive_index];
        const MeshKey key{mesh_index, primitive_index,
                          primitive.targets.empty() ? std::vector<double>() : weights};
        const auto [entry, is_new] = meshes_.try_emplace(key);
        if (is_new) entry->second = keep({read(primitive, mesh.name, weights)});
        return entry->second;
    }

    Mesh read(const tinygltf::Primitive& primitive, const std::string& name,
              const std::vector<double>& weights) {
        const int material = primitive.material;
        const bool textured =
            material >= 0 &&
            draft_.materials[static_cast<std::size_t>(material)].base_color_texture >= 0;
        const int texcoord_set = textured ? texcoord_sets_[static_cast<std::size_t>(material)] : -1;
        Mesh mesh =
            read_primitive(document_, primitive, name, weights, texcoord_set, context_.warnings);
        mesh.material = material >= 0 ? static_cast<std::uint32_t>(material) : default_material();
        return mesh;
    }

    std::optional<std::uint32_t> keep(DraftMesh draft) {
        repair_mesh(draft.mesh, context_.warnings);
        if (draft.mesh.triangles.empty()) return std::nullopt;
        draft_.meshes.push_back(std::move(draft));
        return static_cast<std::uint32_t>(draft_.meshes.size() - 1);
    }

    void add_instances(std::optional<std::uint32_t> mesh, const std::vector<glm::dmat4>& placements,
                       const std::string& name) {
        if (!mesh) return;
        for (std::size_t i = 0; i < placements.size(); ++i) {
            draft_.instances.push_back(
                {*mesh, next_object_ + static_cast<std::uint32_t>(i), placements[i], name});
        }
    }

    std::uint32_t default_material() {
        if (!default_material_) {
            default_material_ = static_cast<std::uint32_t>(draft_.materials.size());
            draft_.materials.push_back(default_gltf_material());
        }
        return *default_material_;
    }

    struct MeshKey {
        int mesh;
        std::size_t primitive;
        std::vector<double> weights;
        auto operator<=>(const MeshKey&) const = default;
    };

    LoadContext& context_;
    GltfDocument document_;
    Draft draft_;
    std::vector<int> texcoord_sets_;
    Pose pose_;
    std::map<MeshKey, std::optional<std::uint32_t>> meshes_;
    std::optional<std::uint32_t> default_material_;
    std::uint32_t next_object_ = 0;
};

}  // namespace

Draft load_gltf(std::vector<std::uint8_t> file, LoadContext& context) {
    return GltfLoader(std::move(file), context).load();
}

}  // namespace gnomon::scene
