#pragma once

#include <gnomon/visibility.h>

#include "gpu/commands.h"
#include "raster/receivers.h"
#include "trace/tracer.h"

#include <tbb/global_control.h>

#include <memory>
#include <optional>
#include <vector>

namespace gnomon {

/// The receivers of a frame on the device, and as points on the host once these are asked for.
struct FrameReceivers {
    SceneKey scene;
    bool ignore_alpha = false;
    raster::Receivers device;
    std::vector<trace::Receiver> points;  ///< row-major, top row first; empty until asked for
};

/// What techniques share: the device, and for the scene in use its buffers, its acceleration
/// structure and the receivers of the last frame. Each is made when it is first asked for and kept
/// until another scene or view takes its place.
class Context::Impl {
public:
    explicit Impl(const ContextOptions& options);

    const gpu::Device& device() const { return device_; }

    /// For work that is recorded, submitted and waited for; never in use while a caller holds none.
    gpu::Submission& submission() { return submission_; }

    const raster::GpuScene& gpu_scene(const Scene& scene, Progress* progress = nullptr);
    /// Stays with whoever holds it.
    std::shared_ptr<const trace::Tracer> tracer(const Scene& scene, bool ignore_alpha,
                                                Progress& progress);

    /// The receivers of the frame, drawn now unless they are those of the last call.
    std::shared_ptr<FrameReceivers> receivers(const Frame& frame);
    /// The same with `points` filled.
    std::shared_ptr<FrameReceivers> receiver_points(const Frame& frame, Progress& progress);

    raster::SurfacePass& surface_pass();

private:
    struct SceneTracer {
        SceneKey scene, contents;
        bool ignore_alpha = false;
        std::shared_ptr<const trace::Tracer> tracer;
    };
    std::vector<trace::SurfaceId> read_ids(raster::Receivers& receivers);

    std::optional<tbb::global_control> threads_;
    gpu::Device device_;
    gpu::Submission submission_;
    std::optional<gpu::Submission> placing_;  // apart, as a scene may be asked for while recording
    std::optional<raster::ReceiverPass> receiver_pass_;
    std::optional<raster::SurfacePass> surface_pass_;
    std::unique_ptr<raster::GpuScene> gpu_scene_;
    std::vector<SceneTracer> tracers_;
    std::shared_ptr<FrameReceivers> receivers_;
};

}  // namespace gnomon
