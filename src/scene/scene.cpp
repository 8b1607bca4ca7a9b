#include <gnomon/scene.h>

#include "base/check.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

Scene::Scene() : data_(std::make_shared<const SceneData>()) {}

Scene::Scene(SceneData data) {
    validate(data);
    data_ = std::make_shared<const SceneData>(std::move(data));
    for (const Instance& instance : data_->instances) {
        const Box3 box = instance_bounds(*data_, instance);
        if (box.empty()) continue;
        if (!finite(box.min) || !finite(box.max)) {
            fail_input("instance \"{}\": its transform takes positions beyond float's range",
                       instance.name);
        }
        bounds_.include(box.min);
        bounds_.include(box.max);
        triangle_count_ += data_->meshes[instance.mesh].triangles.size();
    }
}

}  // namespace gnomon
