#include "raster/gpu_scene.h"

#include "base/parallel.h"
#include "raster/texture_upload.h"
#include "scene/bounds.h"

#include <glm/matrix.hpp>
#include <glm/packing.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>

namespace gnomon::raster {

namespace {

/// Triangles of a caster's cluster: few enough to follow the sides of a map, enough for a draw.
constexpr std::uint32_t kClusterTriangles = 1024;

constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;

/// Where each mesh lies in the concatenated buffers.
struct MeshRange {
    std::uint32_t first_vertex = 0, first_index = 0;
};

std::vector<MeshRange> mesh_ranges(const Scene& scene) {
    std::vector<MeshRange> ranges;
    MeshRange next;
    for (const Mesh& mesh : scene.meshes()) {
        ranges.push_back(next);
        next.first_vertex += static_cast<std::uint32_t>(mesh.positions.size());
        next.first_index += static_cast<std::uint32_t>(3 * mesh.triangles.size());
    }
    return ranges;
}

/// Most that a metre of an instance's mesh can be in the world.
float scale_of(const Instance& instance) {
    const glm::mat3 linear(instance.world_from_local);
    return std::sqrt(glm::dot(linear[0], linear[0]) + glm::dot(linear[1], linear[1]) +
                     glm::dot(linear[2], linear[2]));
}

bool mirrors(const Instance& instance) {
    return glm::determinant(glm::mat3(instance.world_from_local)) < 0.0f;
}

shared::VertexAttributes attributes_of(const Mesh& mesh, std::size_t vertex) {
    const Vec4 color = mesh.colors.empty() ? Vec4(1.0f) : mesh.colors[vertex];
    return {mesh.normals.empty() ? Vec3(0.0f) : mesh.normals[vertex],
            mesh.texcoords.empty() ? Vec2(0.0f) : mesh.texcoords[vertex], glm::packUnorm4x8(color)};
}

template <typename T>
gpu::Buffer storage(const gpu::Device& device, const std::vector<T>& values,
                    VkBufferUsageFlags more = 0) {
    return gpu::make_buffer(device, std::span<const T>(values), kStorage | more);
}

}  // namespace

GpuScene::GpuScene(const gpu::Device& device, const Scene& scene, Progress* progress)
    : scene_(scene) {
    make_casters(progress);
    upload_meshes(device);
    upload_materials(device);
    place_instances();
    instances_ = storage(device, placed_);
    slots_ = storage(device, slot_of_);
}

void GpuScene::make_casters(Progress* progress) {
    casters_.resize(scene_.meshes().size());
    parallel_for(
        casters_.size(), 1,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const Mesh& mesh = scene_.meshes()[i];
                const bool masked = scene_.materials()[mesh.material].masked();
                casters_[i] =
                    caster_mesh(mesh, kClusterTriangles, masked ? Simplify::no : Simplify::yes);
            }
        },
        "simplifying casters", progress);
}

void GpuScene::upload_meshes(const gpu::Device& device) {
    std::vector<Vec3> positions;
    std::vector<UVec3> triangles;
    std::vector<UVec3> caster_triangles;
    std::vector<shared::VertexAttributes> attributes;
    for (const Mesh& mesh : scene_.meshes()) {
        positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
        triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
        CasterMesh& caster = casters_[first_caster_index_.size()];
        first_caster_index_.push_back(static_cast<std::uint32_t>(3 * caster_triangles.size()));
        caster_triangles.insert(caster_triangles.end(), caster.triangles.begin(),
                                caster.triangles.end());
        caster.triangles = {};
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            attributes.push_back(attributes_of(mesh, i));
    }
    positions_ = storage(device, positions, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    indices_ = storage(device, triangles, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    caster_indices_ = gpu::make_buffer(device, std::span<const UVec3>(caster_triangles),
                                       VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    attributes_ = storage(device, attributes);
}

void GpuScene::upload_materials(const gpu::Device& device) {
    std::vector<shared::SceneMaterial> materials;
    for (const Material& m : scene_.materials()) {
        materials.push_back({m.base_color, m.uv_scale_rotation, m.uv_offset, m.alpha_cutoff,
                             m.specular, m.shininess});
    }
    materials_ = storage(device, materials);
    for (const gnomon::Texture& texture : scene_.textures()) {
        textures_.push_back(upload_texture(device, texture));
        samplers_.push_back(texture_sampler(device, texture));
    }
    const gnomon::Texture white{.name = "white", .size = {1, 1}, .rgba = {255, 255, 255, 255}};
    textures_.push_back(upload_texture(device, white));
    samplers_.push_back(texture_sampler(device, white));
}

void GpuScene::place_instances() {
    draws_.clear();
    parts_.clear();
    part_bounds_.clear();
    placed_.clear();
    first_part_.clear();
    const std::vector<MeshRange> ranges = mesh_ranges(scene_);
    const std::vector<Instance>& instances = scene_.instances();
    const auto key = [&](std::uint32_t i) {
        const Mesh& mesh = scene_.meshes()[instances[i].mesh];
        const Material& material = scene_.materials()[mesh.material];
        return std::tuple(material.masked(), material.double_sided, mesh.material,
                          instances[i].mesh, mirrors(instances[i]));
    };
    order_.resize(instances.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });

    slot_of_.resize(instances.size());
    for (const std::uint32_t i : order_) {
        const Instance& instance = instances[i];
        const Mesh& mesh = scene_.meshes()[instance.mesh];
        const MeshRange range = ranges[instance.mesh];
        const auto slot = static_cast<std::uint32_t>(placed_.size());
        slot_of_[i] = slot;
        first_part_.push_back(static_cast<std::uint32_t>(parts_.size()));
        placed_.push_back({glm::mat4x3(instance.world_from_local), i, range.first_index,
                           range.first_vertex, mesh.material});
        if (mesh.triangles.empty()) continue;
        if (slot == 0 || draws_.empty() || key(i) != key(placed_[slot - 1].instance)) {
            const Material& material = scene_.materials()[mesh.material];
            draws_.push_back({.mesh = instance.mesh,
                              .material = mesh.material,
                              .first_index = range.first_index,
                              .index_count = static_cast<std::uint32_t>(3 * mesh.triangles.size()),
                              .first_vertex = range.first_vertex,
                              .first_slot = slot,
                              .first_part = static_cast<std::uint32_t>(parts_.size()),
                              .masked = material.masked(),
                              .double_sided = material.double_sided,
                              .mirrored = mirrors(instance),
                              .winding = mirrors(instance)
                                             ? scene::mirrored(casters_[instance.mesh].winding)
                                             : casters_[instance.mesh].winding});
        }
        ++draws_.back().slot_count;
        add_parts(instance, slot, first_caster_index_[instance.mesh]);
        draws_.back().part_count =
            static_cast<std::uint32_t>(parts_.size()) - draws_.back().first_part;
    }
}

void GpuScene::add_parts(const Instance& instance, std::uint32_t slot, std::uint32_t first_index) {
    const std::vector<MeshCluster>& clusters = casters_[instance.mesh].clusters;
    for (std::uint32_t i = 0; i < clusters.size(); ++i) {
        parts_.push_back({slot, first_index, i, scale_of(instance)});
        part_bounds_.push_back(scene::placed_bounds(instance.world_from_local, clusters[i].bounds));
    }
}

void GpuScene::place(gpu::Commands& commands, const Scene& scene) {
    assert(same(scene.contents_identity(), scene_.contents_identity()));
    const Scene before = std::exchange(scene_, scene);
    std::vector<std::uint32_t> apart;  // where instances can differ
    std::ranges::set_union(before.moving(), scene.moving(), std::back_inserter(apart));
    bool keeps_order = true;
    std::uint32_t first = static_cast<std::uint32_t>(placed_.size());
    std::uint32_t end = 0;
    for (const std::uint32_t i : apart) {
        const Instance& instance = scene.instances()[i];
        if (instance.world_from_local == before.instances()[i].world_from_local) continue;
        keeps_order = keeps_order && mirrors(instance) == mirrors(before.instances()[i]);
        move_instance(instance, slot_of_[i]);
        first = std::min(first, slot_of_[i]);
        end = std::max(end, slot_of_[i] + 1);
    }
    if (!keeps_order) {
        place_instances();
        commands.update(slots_, std::as_bytes(std::span(slot_of_)), gpu::Use::vertex_read);
        first = 0;
        end = static_cast<std::uint32_t>(placed_.size());
    }
    if (first >= end) return;
    commands.update(instances_, std::as_bytes(std::span(placed_).subspan(first, end - first)),
                    gpu::Use::vertex_read, first * sizeof(shared::SceneInstance));
}

void GpuScene::move_instance(const Instance& instance, std::uint32_t slot) {
    placed_[slot].world_from_local = glm::mat4x3(instance.world_from_local);
    const std::vector<MeshCluster>& clusters = casters_[instance.mesh].clusters;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
        parts_[first_part_[slot] + i].scale = scale_of(instance);
        part_bounds_[first_part_[slot] + i] =
            scene::placed_bounds(instance.world_from_local, clusters[i].bounds);
    }
}

gpu::Texture GpuScene::base_color(std::uint32_t material) const {
    const int texture = scene_.materials()[material].base_color_texture;
    const std::size_t index =
        texture < 0 ? textures_.size() - 1 : static_cast<std::size_t>(texture);
    return {textures_[index].view(), &samplers_[index]};
}

std::uint64_t GpuScene::memory_bytes() const {
    std::uint64_t bytes = 0;
    for (const gpu::Buffer* buffer : {&positions_, &indices_, &caster_indices_, &attributes_,
                                      &instances_, &slots_, &materials_}) {
        bytes += buffer->memory_bytes();
    }
    for (const gpu::Image& texture : textures_)
        bytes += texture.memory_bytes();
    return bytes;
}

std::vector<WholeVertex> whole_vertices(const Scene& scene) {
    std::vector<WholeVertex> vertices;
    for (const Mesh& mesh : scene.meshes()) {
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            vertices.push_back({mesh.positions[i], attributes_of(mesh, i)});
    }
    return vertices;
}

gpu::PipelineLayoutInfo opaque_layout() {
    return {{gpu::BindingType::storage_buffer}, sizeof(shared::ScenePush)};
}

gpu::PipelineLayoutInfo material_layout() {
    using enum gpu::BindingType;
    return {{storage_buffer, storage_buffer, storage_buffer, texture}, sizeof(shared::ScenePush)};
}

void set_position_input(gpu::GraphicsPipelineInfo& info) {
    info.attributes = {{.location = 0, .binding = 0, .format = VK_FORMAT_R32G32B32_SFLOAT}};
    info.vertex_stride = sizeof(Vec3);
}

void draw_scene(gpu::Commands& commands, const GpuScene& scene, const ScenePass& pass,
                const Mat4& clip_from_world, bool ignore_alpha) {
    const VkCommandBuffer handle = commands.handle();
    const VkBuffer positions = scene.positions().handle();
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(handle, 0, 1, &positions, &offset);
    vkCmdBindIndexBuffer(handle, scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);

    const gpu::Pipeline* bound = nullptr;
    std::uint32_t bound_material = 0;
    for (const Draw& draw : scene.draws()) {
        const gpu::Pipeline* pipeline = pass.surface;
        if (pipeline == nullptr) {
            pipeline = draw.masked && !ignore_alpha ? pass.masked : pass.opaque;
        }
        const bool needs_material = pipeline != pass.opaque;
        if (pipeline != bound || (needs_material && draw.material != bound_material)) {
            if (needs_material) {
                commands.bind(*pipeline, {gpu::StorageBuffer{&scene.instances()},
                                          gpu::StorageBuffer{&scene.attributes()},
                                          gpu::StorageBuffer{&scene.materials()},
                                          scene.base_color(draw.material)});
            } else {
                commands.bind(*pipeline, {gpu::StorageBuffer{&scene.instances()}});
            }
            commands.push(*pipeline, shared::ScenePush{clip_from_world, draw.material});
            bound = pipeline;
            bound_material = draw.material;
        }
        if (pass.hide_backs) {
            vkCmdSetCullMode(handle, draw.double_sided ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
            vkCmdSetFrontFace(
                handle, draw.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
        }
        vkCmdDrawIndexed(handle, draw.index_count, draw.slot_count, draw.first_index,
                         static_cast<std::int32_t>(draw.first_vertex), draw.first_slot);
    }
}

}  // namespace gnomon::raster
