#include "base/check.h"
#include "visibility/context_impl.h"

#include <cstring>

namespace gnomon {

namespace {

bool same_camera(const Camera& a, const Camera& b) {
    return a.view_from_world == b.view_from_world && a.fov_y_rad == b.fov_y_rad &&
           a.near_m == b.near_m && a.ortho_height_m == b.ortho_height_m &&
           a.ortho_depth_m == b.ortho_depth_m;
}

// The solid and the masked one of a scene, so that comparing both does not build them in turns.
constexpr std::size_t kKeptTracers = 2;

}  // namespace

Context::Context(const ContextOptions& options) {
    if (options.threads < 0) {
        fail_input("context: threads is {}; it must be 0 (all cores) or above", options.threads);
    }
    impl_ = std::make_unique<Impl>(options);
}

Context::~Context() = default;

const DeviceInfo& Context::device() const {
    return impl_->device().info();
}

std::vector<std::string> Context::validation_messages() const {
    return impl_->device().validation_messages();
}

Context::Impl::Impl(const ContextOptions& options) : device_(options), submission_(device_) {
    if (options.threads > 0) {
        threads_.emplace(tbb::global_control::max_allowed_parallelism,
                         static_cast<std::size_t>(options.threads));
    }
}

const raster::GpuScene& Context::Impl::gpu_scene(const Scene& scene, Progress* progress) {
    if (!gpu_scene_ || !same(gpu_scene_->scene().contents_identity(), scene.contents_identity())) {
        gpu_scene_.reset();  // first, so that two scenes never are in device memory at once
        gpu_scene_ = std::make_unique<raster::GpuScene>(device_, scene, progress);
    } else if (!same(gpu_scene_->scene().identity(), scene.identity())) {
        if (!placing_) placing_.emplace(device_);
        gpu::Commands commands = placing_->begin();
        gpu_scene_->place(commands, scene);
        placing_->submit_and_wait();
    }
    return *gpu_scene_;
}

std::shared_ptr<const trace::Tracer> Context::Impl::tracer(const Scene& scene, bool ignore_alpha,
                                                           Progress& progress) {
    for (const SceneTracer& kept : tracers_) {
        if (kept.ignore_alpha == ignore_alpha && same(kept.scene, scene.identity()))
            return kept.tracer;
    }
    // Scenes whose instances move come one after the other: none comes back.
    std::erase_if(tracers_, [&](const SceneTracer& kept) {
        return same(kept.contents, scene.contents_identity()) &&
               !same(kept.scene, scene.identity());
    });
    if (tracers_.size() == kKeptTracers) tracers_.erase(tracers_.begin());
    tracers_.push_back({scene.identity(), scene.contents_identity(), ignore_alpha,
                        std::make_shared<const trace::Tracer>(scene, ignore_alpha, progress)});
    return tracers_.back().tracer;
}

std::shared_ptr<FrameReceivers> Context::Impl::receivers(const Frame& frame) {
    if (receivers_ && same(receivers_->scene, frame.scene.identity()) &&
        receivers_->ignore_alpha == frame.ignore_alpha && receivers_->device.size == frame.size &&
        same_camera(receivers_->device.camera, frame.camera)) {
        return receivers_;
    }
    const raster::GpuScene& scene = gpu_scene(frame.scene);
    if (!receiver_pass_) receiver_pass_.emplace(device_);
    // The old ones stay with whoever still holds them; else their images serve again.
    if (!receivers_ || receivers_.use_count() > 1) receivers_ = std::make_shared<FrameReceivers>();
    receivers_->scene = frame.scene.identity();
    receivers_->ignore_alpha = frame.ignore_alpha;
    receivers_->points.clear();
    gpu::Commands commands = submission_.begin();
    receiver_pass_->record(commands, scene, frame.camera, frame.size, frame.ignore_alpha,
                           receivers_->device);
    submission_.submit_and_wait();
    return receivers_;
}

std::vector<trace::SurfaceId> Context::Impl::read_ids(raster::Receivers& receivers) {
    std::vector<trace::SurfaceId> ids(static_cast<std::size_t>(receivers.size.width) *
                                      receivers.size.height);
    const std::uint64_t bytes = ids.size() * sizeof(trace::SurfaceId);
    gpu::Buffer staging(device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Placement::readback);
    gpu::Commands commands = submission_.begin();
    commands.use(receivers.ids, gpu::Use::copy_source);
    commands.use(staging, gpu::Use::copy_target);
    commands.copy(receivers.ids, staging);
    commands.use(staging, gpu::Use::host_read);
    commands.use(receivers.ids, gpu::Use::storage_read);
    submission_.submit_and_wait();
    std::memcpy(ids.data(), staging.mapped(), bytes);
    return ids;
}

std::shared_ptr<FrameReceivers> Context::Impl::receiver_points(const Frame& frame,
                                                               Progress& progress) {
    std::shared_ptr<FrameReceivers> found = receivers(frame);
    if (found->points.empty()) {
        const std::vector<trace::SurfaceId> ids = read_ids(found->device);
        found->points = tracer(frame.scene, frame.ignore_alpha, progress)
                            ->receivers(frame.camera, frame.size, ids);
    }
    return found;
}

raster::SurfacePass& Context::Impl::surface_pass() {
    if (!surface_pass_) surface_pass_.emplace(device_);
    return *surface_pass_;
}

}  // namespace gnomon
