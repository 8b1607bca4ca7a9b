// Shadow volumes, counted by depth fail in the stencil buffer.
// F. Crow, "Shadow Algorithms for Computer Graphics", SIGGRAPH 1977; T. Heidmann, "Real Shadows
// Real Time", 1991; W. Bilodeau and M. Songy, 1999, and J. Carmack, 2000, for depth fail; C.
// Everitt and M. Kilgard, "Practical and Robust Stenciled Shadow Volumes", 2002, for volumes
// without end; M. McGuire, "Efficient Shadow Volume Rendering", GPU Gems 2004, chapter 9.
// Departures: meshes of any kind, by counting how often and which way each edge is used (P.
// Bergeron, "A General Version of Crow's Shadow Volumes", CG&A 1986; B. Kim et al., "A
// Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold Casters", JGT 2008).

#include "adjacency.h"
#include "base/parallel.h"
#include "resolve.comp.spv.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/light_shape.h"
#include "visibility/lookup_pipeline.h"
#include "volume.h"
#include "volume.vert.spv.h"

#include <algorithm>
#include <cstring>
#include <map>

namespace gnomon {

const TechniqueInfo& shadow_volumes_info();

namespace {

using namespace shadow_volumes;
using shadow_volumes::shared::VolumePush;
using shadow_volumes::shared::VolumeSide;
using shadow_volumes::shared::VolumeTriangle;

constexpr unsigned kGroupSize = 8;

struct Options {
    bool mend_edges = true;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "shadow_volumes", {boolean("mend_edges", &Options::mend_edges,
                                   "pixels that hang over the edge of their surface take its "
                                   "neighbouring pixels' state")});
    return table;
}

HomogeneousLight homogeneous(const Light& light) {
    if (const auto* sun = std::get_if<DirectionalLight>(&light)) return {sun->to_light_ws, 0.0f};
    if (const auto* spot = std::get_if<SpotLight>(&light)) return {spot->position_ws, 1.0f};
    return {std::get<PointLight>(light).position_ws, 1.0f};
}

/// A buffer that the host fills each frame; it grows and never shrinks.
template <typename Record>
class RecordBuffer {
public:
    void fill(const gpu::Device& device, const std::vector<std::vector<Record>>& parts) {
        count_ = 0;
        for (const std::vector<Record>& part : parts)
            count_ += part.size();
        const std::uint64_t bytes = count_ * sizeof(Record);
        if (!buffer_ || bytes > buffer_.size_bytes()) {
            buffer_ = gpu::Buffer(device, bytes + bytes / 2, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                  gpu::Placement::upload);
        }
        std::byte* target = buffer_.mapped();
        for (const std::vector<Record>& part : parts) {
            if (part.empty()) continue;
            std::memcpy(target, part.data(), part.size() * sizeof(Record));
            target += part.size() * sizeof(Record);
        }
    }

    std::uint32_t count() const { return static_cast<std::uint32_t>(count_); }
    const gpu::Buffer& buffer() const { return buffer_; }

private:
    gpu::Buffer buffer_;
    std::size_t count_ = 0;
};

gpu::Pipeline volume_pipeline(const gpu::Device& device, bool depth_clamp) {
    using enum gpu::BindingType;
    gpu::GraphicsPipelineInfo info;
    info.vertex = shaders::volume_vert;
    info.layout = {{storage_buffer, storage_buffer, storage_buffer, storage_buffer},
                   sizeof(VolumePush)};
    info.depth_format = VK_FORMAT_D32_SFLOAT_S8_UINT;
    info.depth_write = false;
    info.depth_clamp = depth_clamp;
    info.stencil_count_depth_fail = true;
    return gpu::Pipeline(device, info);
}

class ShadowVolumes final : public GpuTechnique {
public:
    ShadowVolumes(Context& context, const Options& options)
        : GpuTechnique(context, shadow_volumes_info()), options_(options) {
        const gpu::Device& device = context.impl().device();
        using enum gpu::BindingType;
        volume_ = volume_pipeline(device, false);
        volume_clamped_ = volume_pipeline(device, true);
        gpu::ComputePipelineInfo resolve;
        resolve.code = shaders::resolve_comp;
        resolve.layout = {
            {texture, storage_image, storage_image, texture, storage_image, storage_buffer,
             storage_buffer, storage_buffer, storage_buffer, uniform_buffer},
            sizeof(gnomon::shared::ReceiverPush)};
        resolve.constants = {options.mend_edges ? 1u : 0u};
        resolve_ = LookupPipeline(device, resolve);
        view_ = gpu::Buffer(device, sizeof(Mat4),
                            VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            gpu::Placement::device);
        nearest_ = gpu::Sampler(device, {});
    }

private:
    void prepare_scene(const Scene& scene, Progress& progress) override {
        GpuTechnique::prepare_scene(scene, progress);
        find_edges(scene, progress);
        sources_.assign(scene.instances().size(), {});
        const raster::GpuScene& gpu_scene = context().gpu_scene(scene);
        for (const raster::Draw& draw : gpu_scene.draws()) {
            for (std::uint32_t i = 0; i < draw.slot_count; ++i) {
                const std::uint32_t slot = draw.first_slot + i;
                sources_[gpu_scene.instance_at(slot)] = {slot, draw.first_vertex};
            }
        }
    }

    // Those of meshes: they stay when instances move.
    void find_edges(const Scene& scene, Progress& progress) {
        if (same(adjacencies_of_, scene.contents_identity())) return;
        adjacencies_of_ = {};
        adjacencies_.assign(scene.meshes().size(), {});
        parallel_for(
            adjacencies_.size(), 1,
            [&](std::size_t first, std::size_t last) {
                for (std::size_t i = first; i < last; ++i) {
                    adjacencies_[i] = find_adjacency(scene.meshes()[i]);
                }
            },
            "finding edges", &progress);
        adjacencies_of_ = scene.contents_identity();
    }

    void build_volumes(const Scene& scene, HomogeneousLight light_ws) {
        const std::size_t count = scene.instances().size();
        std::vector<std::vector<VolumeTriangle>> caps(2 * count);  // clockwise ones last
        std::vector<std::vector<VolumeSide>> sides(count);
        parallel_for(count, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const Instance& instance = scene.instances()[i];
                Volume volume =
                    build_volume(scene.meshes()[instance.mesh], adjacencies_[instance.mesh],
                                 instance.world_from_local, light_ws, sources_[i]);
                caps[i] = std::move(volume.caps);
                caps[count + i] = std::move(volume.clockwise_caps);
                sides[i] = std::move(volume.sides);
            }
        });
        caps_.fill(context().device(), caps);
        clockwise_caps_ = 0;
        for (std::size_t i = count; i < caps.size(); ++i)
            clockwise_caps_ += static_cast<std::uint32_t>(caps[i].size());
        sides_.fill(context().device(), sides);
    }

    void draw_part(gpu::Commands& commands, const gpu::Pipeline& pipeline, VolumePush push,
                   std::uint32_t part, std::uint32_t vertices, std::uint32_t first = 0) {
        if (vertices == 0) return;
        push.part = part;
        commands.push(pipeline, push);
        vkCmdDraw(commands.handle(), vertices, 1, first, 0);
    }

    void draw_caps(gpu::Commands& commands, const gpu::Pipeline& pipeline, const VolumePush& push,
                   std::uint32_t part) {
        const std::uint32_t first_clockwise = 3 * (caps_.count() - clockwise_caps_);
        draw_part(commands, pipeline, push, part, first_clockwise);
        vkCmdSetFrontFace(commands.handle(), VK_FRONT_FACE_CLOCKWISE);
        draw_part(commands, pipeline, push, part, 3 * clockwise_caps_, first_clockwise);
        vkCmdSetFrontFace(commands.handle(), VK_FRONT_FACE_COUNTER_CLOCKWISE);
    }

    void draw_volumes(gpu::Commands& commands, const RecordInput& input,
                      HomogeneousLight light_ws) {
        const gpu::Pass pass(commands, "volumes");
        gpu::Image& depth = input.receivers.depth;
        // A parallel camera has a far plane, beyond which volumes must go on.
        const bool parallel = input.frame.camera.ortho_height_m > 0.0f;
        const gpu::Pipeline& pipeline = parallel ? volume_clamped_ : volume_;
        const VolumePush push{
            .clip_from_world = input.frame.camera.clip_from_world(input.frame.size),
            .light_ws = light_ws};
        const bool at_infinity = light_ws.w == 0.0f;
        gpu::Targets targets{
            .depth = &depth, .size = input.frame.size, .clear_depth = false, .clear_stencil = true};
        commands.use(depth, gpu::Use::depth_test);
        commands.begin_drawing(targets);
        commands.bind(pipeline,
                      {gpu::StorageBuffer{&input.scene.instances()},
                       gpu::StorageBuffer{&input.scene.positions()},
                       gpu::StorageBuffer{&caps_.buffer()}, gpu::StorageBuffer{&sides_.buffer()}});
        draw_caps(commands, pipeline, push, shadow_volumes::shared::kNearCaps);
        if (!at_infinity) draw_caps(commands, pipeline, push, shadow_volumes::shared::kFarCaps);
        draw_part(commands, pipeline, push, shadow_volumes::shared::kSides,
                  (at_infinity ? 3u : 6u) * sides_.count());
        commands.end_drawing();
        commands.use(depth, gpu::Use::sampled);
    }

    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        const HomogeneousLight light_ws = homogeneous(input.frame.light);
        build_volumes(input.frame.scene, light_ws);
        draw_volumes(commands, input, light_ws);
        const gpu::Pass pass(commands, "resolve");
        commands.update(view_, input.frame.camera.clip_from_world(input.frame.size));
        commands.use(visibility, gpu::Use::storage_write);
        const gpu::Pipeline& resolve = resolve_.of(input.frame.light);
        commands.bind(
            resolve,
            {gpu::Texture{input.receivers.depth.view(), &nearest_},
             gpu::StorageImage{input.receivers.normals.view()},
             gpu::StorageImage{visibility.view()},
             gpu::Texture{input.receivers.depth.stencil_view(), &nearest_},
             gpu::StorageImage{input.receivers.ids.view()},
             gpu::StorageBuffer{&input.scene.instances()}, gpu::StorageBuffer{&input.scene.slots()},
             gpu::StorageBuffer{&input.scene.positions()},
             gpu::StorageBuffer{&input.scene.indices()}, gpu::UniformBuffer{&view_}});
        commands.push(resolve, receiver_push(input.receivers, input.frame.light));
        commands.dispatch(input.frame.size, kGroupSize);
    }

    std::uint64_t memory_bytes() const override {
        return caps_.buffer().memory_bytes() + sides_.buffer().memory_bytes();
    }

    Options options_;
    gpu::Pipeline volume_, volume_clamped_;
    LookupPipeline resolve_;
    gpu::Sampler nearest_;
    gpu::Buffer view_;                    // clip_from_world of the camera
    std::vector<Adjacency> adjacencies_;  // of each mesh
    SceneKey adjacencies_of_;             // of which contents
    std::vector<VolumeSource> sources_;   // of each instance
    RecordBuffer<VolumeTriangle> caps_;
    std::uint32_t clockwise_caps_ = 0;  // of them, at the end
    RecordBuffer<VolumeSide> sides_;
};

}  // namespace

const TechniqueInfo& shadow_volumes_info() {
    static const TechniqueInfo info{
        .name = "shadow_volumes",
        .title = "Shadow volumes",
        .source = "crow1977, heidmann1991, everitt2002, mcguire2004, bergeron1986, kim2008",
        .lights = LightKinds::directional | LightKinds::point | LightKinds::spot,
        .penumbra = Penumbra::none,
        .honors_alpha = false,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<ShadowVolumes>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
