// What a depth map costs beside the least that drawing its triangles can cost.
//
//     depth_floor [SCENE [MAP_SIZE [FRAMES]]]
//
// SCENE is a file or a built-in scene, field-large without one. Into maps of one size, seen by its
// first directional light, fitted to a view of 1920 x 1080, device times of
//   - two floors, which know positions and one matrix: the scene's triangles as one world-space
//   mesh
//     in one draw, and a draw for each instance with its matrix in the push constants;
//   - DepthMap::record, and the pass "depth" of the technique shadow_map.
// All take turns in each frame; medians are printed, and how often they are the lower floor's. So
// is the CPU time of the process: on a device that is the CPU, other programs disturb it less.

#include <gnomon/error.h>
#include <gnomon/technique.h>

#include "base/check.h"
#include "bench_main.h"
#include "depth_floor.vert.spv.h"
#include "gpu/commands.h"
#include "visibility/context_impl.h"
#include "visibility/depth_map.h"
#include "visibility/light_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

namespace gnomon {
namespace {

constexpr Extent kView{1920, 1080};
constexpr float kMarginTexels = 3.0f;  // shadow_map's with its default filter
constexpr int kWarmUpFrames = 3;
constexpr VkFormat kFormat = VK_FORMAT_D32_SFLOAT;

/// A map, and what it takes to draw positions into it.
class Floor {
public:
    Floor(const gpu::Device& device, unsigned size_texels)
        : map_(device, {.size = {size_texels, size_texels},
                        .format = kFormat,
                        .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                 VK_IMAGE_USAGE_TRANSFER_SRC_BIT}) {
        gpu::GraphicsPipelineInfo info;
        info.vertex = shaders::depth_floor_vert;
        info.layout.push_bytes = sizeof(Mat4);
        info.depth_format = kFormat;
        raster::set_position_input(info);
        pipeline_ = gpu::Pipeline(device, info);
    }

    /// `draw` records the draws of all triangles.
    void record(gpu::Commands& commands, const gpu::Buffer& positions, const gpu::Buffer& indices,
                const std::function<void()>& draw) {
        commands.use(map_, gpu::Use::depth_target);
        commands.begin_drawing({.depth = &map_, .size = map_.size()});
        commands.bind(pipeline_, {});
        const VkBuffer vertices = positions.handle();
        const VkDeviceSize offset = 0;
        vkCmdBindVertexBuffers(commands.handle(), 0, 1, &vertices, &offset);
        vkCmdBindIndexBuffer(commands.handle(), indices.handle(), 0, VK_INDEX_TYPE_UINT32);
        draw();
        commands.end_drawing();
    }

    const gpu::Pipeline& pipeline() const { return pipeline_; }
    gpu::Image& map() { return map_; }

private:
    gpu::Pipeline pipeline_;
    gpu::Image map_;
};

/// All instances as one mesh in the world.
struct WorldMesh {
    gpu::Buffer positions, indices;
    std::uint32_t index_count = 0;

    WorldMesh(const gpu::Device& device, const Scene& scene) {
        std::vector<Vec3> positions_ws;
        std::vector<UVec3> triangles;
        for (const Instance& instance : scene.instances()) {
            const Mesh& mesh = scene.meshes()[instance.mesh];
            const auto first = static_cast<std::uint32_t>(positions_ws.size());
            for (const Vec3 p : mesh.positions)
                positions_ws.emplace_back(instance.world_from_local * Vec4(p, 1.0f));
            for (const UVec3 triangle : mesh.triangles)
                triangles.push_back(triangle + first);
        }
        positions = gpu::make_buffer(device, std::span<const Vec3>(positions_ws),
                                     VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
        indices = gpu::make_buffer(device, std::span<const UVec3>(triangles),
                                   VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
        index_count = static_cast<std::uint32_t>(3 * triangles.size());
    }
};

/// A draw for each instance.
void draw_instances(gpu::Commands& commands, const gpu::Pipeline& pipeline,
                    const raster::GpuScene& scene, const Mat4& clip_from_world) {
    for (const raster::Draw& draw : scene.draws()) {
        for (std::uint32_t i = 0; i < draw.slot_count; ++i) {
            const std::uint32_t instance = scene.instance_at(draw.first_slot + i);
            commands.push(pipeline,
                          clip_from_world * scene.scene().instances()[instance].world_from_local);
            vkCmdDrawIndexed(commands.handle(), draw.index_count, 1, draw.first_index,
                             static_cast<std::int32_t>(draw.first_vertex), 0);
        }
    }
}

struct Contestant {
    std::string name;
    std::function<double()> run_ms;  ///< returns the time on the device
    bool more_than_map = false;      ///< its CPU time tells nothing
    std::vector<double> device_ms = {}, cpu_ms = {};
};

/// CPU time of all threads so far.
double process_ms() {
    return 1000.0 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Fraction of the map's texels that something was drawn into: contestants that draw the same
/// agree.
double covered(const gpu::Device& device, gpu::Image& map) {
    const std::size_t texels = std::size_t{map.size().width} * map.size().height;
    gpu::Buffer staging(device, texels * sizeof(float), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                        gpu::Placement::readback);
    gpu::Submission submission(device);
    gpu::Commands commands = submission.begin();
    commands.use(map, gpu::Use::copy_source);
    commands.use(staging, gpu::Use::copy_target);
    commands.copy(map, staging);
    commands.use(staging, gpu::Use::host_read);
    submission.submit_and_wait();
    const auto* depth = reinterpret_cast<const float*>(staging.mapped());
    return static_cast<double>(
               std::count_if(depth, depth + texels, [](float z) { return z > 0; })) /
           static_cast<double>(texels);
}

double timed(gpu::Submission& submission, const std::function<void(gpu::Commands&)>& record) {
    gpu::Commands commands = submission.begin();
    {
        const gpu::Pass pass(commands, "draw");
        record(commands);
    }
    submission.submit_and_wait();
    return submission.times().front().ms;
}

void compete(std::vector<Contestant>& contestants, int frames) {
    for (int i = 0; i < kWarmUpFrames + frames; ++i) {
        for (Contestant& contestant : contestants) {
            const double cpu_start_ms = process_ms();
            const double device_ms = contestant.run_ms();
            if (i < kWarmUpFrames) continue;
            contestant.device_ms.push_back(device_ms);
            contestant.cpu_ms.push_back(process_ms() - cpu_start_ms);
        }
    }
}

/// The first two contestants are the floors.
void print(const std::vector<Contestant>& contestants) {
    const auto floor_of = [&](std::vector<double> Contestant::*times) {
        return std::min(median(contestants[0].*times), median(contestants[1].*times));
    };
    const double device_ms = floor_of(&Contestant::device_ms);
    const double cpu_ms = floor_of(&Contestant::cpu_ms);
    for (const Contestant& contestant : contestants) {
        fmt::print("{:32} device {:8.2f} ms, {:5.2f} of the floor", contestant.name,
                   median(contestant.device_ms), median(contestant.device_ms) / device_ms);
        if (contestant.more_than_map) {
            fmt::print("\n");
            continue;
        }
        fmt::print("   CPU {:8.2f} ms, {:5.2f} of the floor\n", median(contestant.cpu_ms),
                   median(contestant.cpu_ms) / cpu_ms);
    }
}

DirectionalLight directional_light(const Scene& scene) {
    for (const Light& light : scene.lights()) {
        if (const auto* found = std::get_if<DirectionalLight>(&light)) return *found;
    }
    return sun(radians(35.0f), radians(120.0f));
}

int run(int argc, char** argv) {
    const Scene scene = load_scene(argc > 1 ? argv[1] : "field-large");
    const int map_size = argc > 2 ? std::atoi(argv[2]) : 2048;
    const int frames = argc > 3 ? std::atoi(argv[3]) : 21;
    if (frames < 1) fail_input("depth_floor: {} frames, must be at least 1", frames);
    const auto size_texels = static_cast<unsigned>(map_size);
    Context context;
    const gpu::Device& device = context.impl().device();
    const raster::GpuScene& gpu_scene = context.impl().gpu_scene(scene);
    const Frame frame{scene, scene.cameras().at(0), directional_light(scene), kView};
    const LightFit fit = fit_directional(directional_light(scene),
                                         visible_corners(frame.camera, kView, scene.bounds()),
                                         scene.bounds(), size_texels, kMarginTexels);
    const Mat4 clip_from_world(fit.clip_from_world);

    gpu::Submission submission(device);
    const WorldMesh world(device, scene);
    Floor one_draw(device, size_texels), draws(device, size_texels);
    DepthMap depth_map(device);
    const auto technique = make_technique(
        context, "shadow_map",
        {{"map_size", map_size}, {"cull_casters", false}, {"faces", "all"}, {"caster_error", 0.0}});
    Visibility visibility;

    const auto record_one_draw = [&](gpu::Commands& commands) {
        one_draw.record(commands, world.positions, world.indices, [&] {
            commands.push(one_draw.pipeline(), clip_from_world);
            vkCmdDrawIndexed(commands.handle(), world.index_count, 1, 0, 0, 0);
        });
    };
    const auto record_draws = [&](gpu::Commands& commands) {
        draws.record(commands, gpu_scene.positions(), gpu_scene.indices(), [&] {
            draw_instances(commands, draws.pipeline(), gpu_scene, clip_from_world);
        });
    };
    const auto record_map = [&](gpu::Commands& commands) {
        depth_map.record(commands, gpu_scene, std::array{MapLayer{fit, CasterVolume()}}, {});
    };
    std::vector<Contestant> contestants = {
        {"floor: one draw in the world", [&] { return timed(submission, record_one_draw); }},
        {"floor: a draw for each instance", [&] { return timed(submission, record_draws); }},
        {"DepthMap::record", [&] { return timed(submission, record_map); }},
        {"shadow_map, pass depth",
         [&] {
             technique->render(frame, visibility);
             return technique->last_render().passes.front().ms;
         },
         true}};
    compete(contestants, frames);
    fmt::print("{}: {} triangles, {} instances, {} draws, map of {} texels, {} frames\n",
               context.device().name, world.index_count / 3, scene.instances().size(),
               gpu_scene.draws().size(), size_texels, frames);
    fmt::print("texels drawn into: one draw {:.3f} %, draws {:.3f} %\n",
               100.0 * covered(device, one_draw.map()), 100.0 * covered(device, draws.map()));
    print(contestants);
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
