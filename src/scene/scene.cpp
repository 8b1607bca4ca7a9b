#include <gnomon/scene.h>

#include "base/check.h"
#include "scene/bounds.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

namespace gnomon {

namespace {

bool finite(Vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <typename T>
void require_stream(const Mesh& mesh, std::string_view stream, const std::vector<T>& values) {
    if (!values.empty() && values.size() != mesh.positions.size()) {
        fail_input("mesh \"{}\": has {} {} for {} positions; it must have none or one each",
                   mesh.name, values.size(), stream, mesh.positions.size());
    }
}

void validate_mesh(const Mesh& mesh, const SceneData& data) {
    require_stream(mesh, "normals", mesh.normals);
    require_stream(mesh, "texcoords", mesh.texcoords);
    require_stream(mesh, "lightmap_texcoords", mesh.lightmap_texcoords);
    require_stream(mesh, "colors", mesh.colors);
    if (mesh.material >= data.materials.size()) {
        fail_input("mesh \"{}\": material {} of {}", mesh.name, mesh.material,
                   data.materials.size());
    }
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (!finite(mesh.positions[i])) {
            fail_input("mesh \"{}\": position {} is not finite", mesh.name, i);
        }
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const UVec3 t = mesh.triangles[i];
        if (std::max({t.x, t.y, t.z}) >= mesh.positions.size()) {
            fail_input("mesh \"{}\": triangle {} has vertex {} of {}", mesh.name, i,
                       std::max({t.x, t.y, t.z}), mesh.positions.size());
        }
    }
}

void validate_material(const Material& material, const SceneData& data) {
    if (material.base_color_texture < -1 ||
        material.base_color_texture >= static_cast<int>(data.textures.size())) {
        fail_input("material \"{}\": texture {} of {}", material.name, material.base_color_texture,
                   data.textures.size());
    }
    if (!(material.alpha_cutoff >= 0.0f)) {
        fail_input("material \"{}\": alpha_cutoff is {}; it must not be negative", material.name,
                   material.alpha_cutoff);
    }
}

void validate_instance(const Instance& instance, const SceneData& data) {
    if (instance.mesh >= data.meshes.size()) {
        fail_input("instance \"{}\": mesh {} of {}", instance.name, instance.mesh,
                   data.meshes.size());
    }
    for (int column = 0; column < 4; ++column) {
        if (!finite(Vec3(instance.world_from_local[column]))) {
            fail_input("instance \"{}\": world_from_local is not finite", instance.name);
        }
    }
}

void validate_texture(const Texture& texture) {
    const std::size_t expected =
        std::size_t{4} * texture.size.width * static_cast<std::size_t>(texture.size.height);
    if (expected == 0 || texture.rgba.size() != expected) {
        fail_input("texture \"{}\": {} bytes for {}x{} pixels; it must have 4 a pixel",
                   texture.name, texture.rgba.size(), texture.size.width, texture.size.height);
    }
}

void validate(const SceneData& data) {
    for (const Texture& texture : data.textures)
        validate_texture(texture);
    for (const Material& material : data.materials)
        validate_material(material, data);
    for (const Mesh& mesh : data.meshes)
        validate_mesh(mesh, data);
    for (const Instance& instance : data.instances)
        validate_instance(instance, data);
    for (const Camera& camera : data.cameras)
        camera.validate();
    for (const Light& light : data.lights)
        validate(light);
}

Box3 instance_bounds(const SceneData& data, const Instance& instance) {
    Box3 bounds;
    for (const UVec3 t : data.meshes[instance.mesh].triangles) {
        for (int corner = 0; corner < 3; ++corner) {
            const Vec3 p = data.meshes[instance.mesh].positions[t[corner]];
            bounds.include(Vec3(instance.world_from_local * Vec4(p, 1.0f)));
        }
    }
    return bounds;
}

Box3 mesh_bounds_of(const Mesh& mesh) {
    Box3 bounds;
    for (const UVec3 t : mesh.triangles) {
        for (int corner = 0; corner < 3; ++corner)
            bounds.include(mesh.positions[t[corner]]);
    }
    return bounds;
}

void require_in_range(const Instance& instance, const Box3& bounds) {
    if (!bounds.empty() && (!finite(bounds.min) || !finite(bounds.max))) {
        fail_input("instance \"{}\": its transform takes positions beyond float's range",
                   instance.name);
    }
}

Box3 union_of(const std::vector<Box3>& boxes) {
    Box3 all;
    for (const Box3& box : boxes) {
        if (box.empty()) continue;
        all.include(box.min);
        all.include(box.max);
    }
    return all;
}

void validate_pose(const InstancePose& pose, std::size_t instances) {
    if (pose.instance >= instances) {
        fail_input("moved: instance {} of {}", pose.instance, instances);
    }
    const Mat4& m = pose.world_from_local;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (std::isfinite(m[column][row])) continue;
            fail_input(
                "moved: world_from_local of instance {} has {} in row {}, column {}; it "
                "must be finite",
                pose.instance, m[column][row], row, column);
        }
    }
    if (m[0].w != 0.0f || m[1].w != 0.0f || m[2].w != 0.0f || m[3].w != 1.0f) {
        fail_input(
            "moved: world_from_local of instance {} has the last row {} {} {} {}; an affine "
            "matrix has 0 0 0 1",
            pose.instance, m[0].w, m[1].w, m[2].w, m[3].w);
    }
}

}  // namespace

bool same(const SceneKey& a, const SceneKey& b) {
    return !a.owner_before(b) && !b.owner_before(a);
}

Scene::Scene()
    : contents_(std::make_shared<const Contents>()),
      placement_(std::make_shared<const Placement>()) {}

Scene::Scene(SceneData data) {
    validate(data);
    auto contents = std::make_shared<Contents>();
    auto placement = std::make_shared<Placement>();
    for (const Mesh& mesh : data.meshes)
        contents->mesh_bounds.push_back(mesh_bounds_of(mesh));
    for (const Instance& instance : data.instances) {
        const Box3& box = placement->instance_bounds.emplace_back(instance_bounds(data, instance));
        require_in_range(instance, box);
        contents->triangle_count += data.meshes[instance.mesh].triangles.size();
    }
    placement->bounds = union_of(placement->instance_bounds);
    placement->instances = std::move(data.instances);
    data.instances = {};
    contents->data = std::move(data);
    contents_ = std::move(contents);
    placement_ = std::move(placement);
}

Scene Scene::moved(std::span<const InstancePose> poses) const {
    for (const InstancePose& pose : poses)
        validate_pose(pose, instances().size());
    auto placement = std::make_shared<Placement>(*placement_);
    std::vector<std::uint32_t> moving;
    for (const InstancePose& pose : poses) {
        Instance& instance = placement->instances[pose.instance];
        if (instance.world_from_local == pose.world_from_local) continue;
        instance.world_from_local = pose.world_from_local;
        Box3& bounds = placement->instance_bounds[pose.instance];
        bounds = scene::placed_bounds(instance.world_from_local, mesh_bounds(instance.mesh));
        require_in_range(instance, bounds);
        moving.push_back(pose.instance);
    }
    if (moving.empty()) return *this;
    std::ranges::sort(moving);
    placement->moving.clear();
    std::ranges::set_union(moving, this->moving(), std::back_inserter(placement->moving));
    std::vector<std::uint32_t>& all = placement->moving;
    all.erase(std::unique(all.begin(), all.end()), all.end());
    placement->bounds = union_of(placement->instance_bounds);
    Scene result = *this;
    result.placement_ = std::move(placement);
    return result;
}

SceneData Scene::data() const {
    SceneData data = contents_->data;
    data.instances = instances();
    return data;
}

}  // namespace gnomon
