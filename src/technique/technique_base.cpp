#include "technique/technique_base.h"

#include "base/check.h"

#include <chrono>

namespace gnomon {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

void TechniqueBase::prepare(const Scene& scene, Progress& progress) {
    is_prepared_ = false;
    prepare_scene(scene, progress);
    prepared_ = scene.identity();
    is_prepared_ = true;
}

void TechniqueBase::render(const Frame& frame, Visibility& out, Progress& progress) {
    frame.validate();
    if (!supports(info_.lights, frame.light)) {
        fail_input("{}: cannot shadow a {} light (\"{}\")", info_.name, light_kind(frame.light),
                   light_name(frame.light));
    }
    if (!is_prepared_ || !same(prepared_, frame.scene.identity())) prepare(frame.scene, progress);
    stats_ = {};
    render_frame(frame, out, stats_, progress);
    for (const PassTime& pass : stats_.passes)
        stats_.gpu_ms += pass.ms;
}

void GpuTechnique::prepare_scene(const Scene& scene, Progress& progress) {
    context().gpu_scene(scene, &progress);
}

void GpuTechnique::describe_texels(const Frame&, Visibility::Impl&) {}

void GpuTechnique::render_frame(const Frame& frame, Visibility& out, RenderStats& stats,
                                Progress& progress) {
    prepare_light(frame, progress);
    const std::shared_ptr<FrameReceivers> receivers = context().receivers(frame);
    const raster::GpuScene& scene = context().gpu_scene(frame.scene);
    gpu::Image& visibility = out.impl().device_target(context(), frame.size);
    if (!submission_) submission_ = std::make_unique<gpu::Submission>(context().device());

    const RecordInput input{frame, scene, receivers->device};
    const auto submit = [&] {
        submission_->submit_and_wait();
        for (const gpu::PassTimer::Time& time : submission_->times())
            stats.passes.push_back({time.name, time.ms});
    };
    try {
        Clock::time_point recording = Clock::now();
        gpu::Commands commands = submission_->begin();
        if (survey(commands, input)) {
            stats.cpu_ms = ms_since(recording);
            submit();
            recording = Clock::now();
            commands = submission_->begin();
        }
        record(commands, input, visibility);
        commands.use(visibility, gpu::Use::storage_read);
        stats.cpu_ms += ms_since(recording);
        submit();
    } catch (...) {
        forget();
        out.impl().forget();
        throw;
    }
    stats.memory_bytes = memory_bytes();
    stats.warning = warning();
    describe_texels(frame, out.impl());
}

void HostTechnique::describe_texels(std::span<const trace::Receiver>, Visibility::Impl&) {}

void HostTechnique::render_frame(const Frame& frame, Visibility& out, RenderStats& stats,
                                 Progress& progress) {
    const std::shared_ptr<FrameReceivers> receivers = context().receiver_points(frame, progress);
    Image& target = out.impl().host_target(context(), frame.size);
    const Clock::time_point start = Clock::now();
    compute(frame, receivers->points, target.pixels(), progress);
    stats.cpu_ms = ms_since(start);
    stats.memory_bytes = memory_bytes();
    stats.note = note();
    describe_texels(receivers->points, out.impl());
}

}  // namespace gnomon
