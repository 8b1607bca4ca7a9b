#pragma once

#include <gnomon/progress.h>
#include <gnomon/scene.h>

#include "gpu/commands.h"
#include "raster/caster_mesh.h"
#include "raster/scene.shared.h"

#include <vector>

namespace gnomon::raster {

/// An instance of a mesh, or of a cluster of its triangles, as a caster.
struct CasterPart {
    std::uint32_t slot = 0;
    std::uint32_t first_index = 0;  ///< of its mesh in the casters' index buffer
    std::uint32_t cluster = 0;      ///< of its mesh
    float scale = 1.0f;             ///< most that a metre of its mesh can be in the world
};

/// A vertex with all that a mesh stores of it, side by side.
struct WholeVertex {
    Vec3 position;
    shared::VertexAttributes attributes;
};

/// All instances of one mesh that are wound the same way.
struct Draw {
    std::uint32_t mesh = 0;
    std::uint32_t material = 0;
    std::uint32_t first_index = 0, index_count = 0, first_vertex = 0;
    std::uint32_t first_slot = 0, slot_count = 0;  ///< in the instance buffer
    std::uint32_t first_part = 0, part_count = 0;  ///< in GpuScene::parts()
    bool masked = false;
    bool double_sided = true;
    bool mirrored = false;
    scene::Winding winding = scene::Winding::open;  ///< in the world; of what has holes: open
};

/// A scene in device memory, drawn in few calls: positions apart from the other attributes,
/// instances of a mesh side by side, draws in the order of their material.
class GpuScene {
public:
    /// Throws Error{cancelled}.
    GpuScene(const gpu::Device& device, const Scene& scene, Progress* progress = nullptr);

    /// Places the instances as another scene of the same contents does: uploads the matrices of
    /// what has moved.
    void place(gpu::Commands& commands, const Scene& scene);

    const Scene& scene() const { return scene_; }
    const std::vector<Draw>& draws() const { return draws_; }
    /// The index into Scene::instances() of a slot of the instance buffer.
    std::uint32_t instance_at(std::uint32_t slot) const { return order_[slot]; }
    /// What casts, part by part, and the boxes that hold the parts; together all of the scene.
    const std::vector<CasterPart>& parts() const { return parts_; }
    const std::vector<Box3>& part_bounds_ws() const { return part_bounds_; }
    /// The triangles of a part: all, then ever fewer, in indices of the casters' buffer.
    const std::vector<CasterLevel>& levels(const Draw& draw, const CasterPart& part) const {
        return casters_[draw.mesh].clusters[part.cluster].levels;
    }
    const gpu::Buffer& positions() const { return positions_; }
    const gpu::Buffer& indices() const { return indices_; }
    const gpu::Buffer& caster_indices() const { return caster_indices_; }
    const gpu::Buffer& instances() const { return instances_; }
    const gpu::Buffer& slots() const { return slots_; }  ///< slot of Scene::instances()[i]
    const gpu::Buffer& attributes() const { return attributes_; }
    const gpu::Buffer& materials() const { return materials_; }

    /// The base-colour texture of a material, white when it has none.
    gpu::Texture base_color(std::uint32_t material) const;

    std::uint64_t memory_bytes() const;

private:
    void place_instances();
    void move_instance(const Instance& instance, std::uint32_t slot);
    void add_parts(const Instance& instance, std::uint32_t slot, std::uint32_t first_index);
    void make_casters(Progress* progress);
    void upload_meshes(const gpu::Device& device);
    void upload_materials(const gpu::Device& device);

    Scene scene_;
    std::vector<Draw> draws_;
    std::vector<std::uint32_t> order_;               // by slot
    std::vector<std::uint32_t> slot_of_;             // by instance
    std::vector<shared::SceneInstance> placed_;      // by slot
    std::vector<std::uint32_t> first_part_;          // by slot
    std::vector<CasterMesh> casters_;                // by mesh, without their triangles
    std::vector<std::uint32_t> first_caster_index_;  // by mesh
    std::vector<CasterPart> parts_;
    std::vector<Box3> part_bounds_;
    gpu::Buffer positions_, indices_, caster_indices_, attributes_, instances_, slots_, materials_;
    std::vector<gpu::Image> textures_;    // Scene::textures() and, last, white
    std::vector<gpu::Sampler> samplers_;  // one for each of them
};

/// The pipelines of one pass over the scene. `opaque` binds the instances; `masked` binds
/// instances, attributes, materials and the base-colour texture, as does `surface`, which draws
/// everything when it is given.
struct ScenePass {
    const gpu::Pipeline* opaque = nullptr;
    const gpu::Pipeline* masked = nullptr;
    const gpu::Pipeline* surface = nullptr;
    bool hide_backs = false;  ///< of single-sided materials
};

/// Draws all instances within begin_drawing() / end_drawing().
void draw_scene(gpu::Commands& commands, const GpuScene& scene, const ScenePass& pass,
                const Mat4& clip_from_world, bool ignore_alpha);

/// The vertices of all meshes in the order of GpuScene::positions(), for those who want them whole.
std::vector<WholeVertex> whole_vertices(const Scene& scene);

/// What draw_scene() needs of the pipelines that it is given.
gpu::PipelineLayoutInfo opaque_layout();
gpu::PipelineLayoutInfo material_layout();
/// Location 0: position, 3 floats.
void set_position_input(gpu::GraphicsPipelineInfo& info);

}  // namespace gnomon::raster
