#pragma once

#include <gnomon/technique.h>

#include "visibility/visibility_impl.h"

#include <memory>
#include <span>
#include <string>

namespace gnomon {

/// What all techniques do alike: checks at the door, preparing when the scene changes, times.
class TechniqueBase : public Technique {
public:
    using Technique::prepare;
    using Technique::render;
    void prepare(const Scene& scene, Progress& progress) final;
    void render(const Frame& frame, Visibility& out, Progress& progress) final;
    RenderStats last_render() const final { return stats_; }

protected:
    TechniqueBase(Context& context, const TechniqueInfo& info)
        : context_(context.impl()), info_(info) {}

    /// Once per scene.
    virtual void prepare_scene(const Scene& scene, Progress& progress) = 0;
    /// With a checked frame of the prepared scene. Fills all of `stats` but the sum of the passes.
    virtual void render_frame(const Frame& frame, Visibility& out, RenderStats& stats,
                              Progress& progress) = 0;

    Context::Impl& context() { return context_; }

private:
    Context::Impl& context_;
    const TechniqueInfo& info_;
    SceneKey prepared_;
    bool is_prepared_ = false;
    RenderStats stats_;
};

/// What a technique on the device is given to record with. All images are ready to be read as their
/// structures say.
struct RecordInput {
    const Frame& frame;
    const raster::GpuScene& scene;
    raster::Receivers& receivers;
};

/// A technique on the device. It records into a command buffer that it is given: no submit, no
/// wait but for a survey, and no allocation once a frame of the same size has been recorded.
class GpuTechnique : public TechniqueBase {
protected:
    using TechniqueBase::TechniqueBase;

    void prepare_scene(const Scene& scene, Progress& progress) override;

    /// Before a frame is recorded: makes what depends on its light and may take long, as bakes do,
    /// unless there is one for it. Throws Error{cancelled}.
    virtual void prepare_light(const Frame&, Progress&) {}
    /// Records what the host must have read of the frame before record() can plan it, and tells
    /// whether that is anything: it is then submitted and waited for.
    virtual bool survey(gpu::Commands&, const RecordInput&) { return false; }
    /// Records everything that writes `visibility`, an R32F storage image, and leaves `receivers`
    /// in the uses it found them in.
    virtual void record(gpu::Commands& commands, const RecordInput& input,
                        gpu::Image& visibility) = 0;
    /// What record() noted of its commands for later frames is void: it threw, or they did not run.
    virtual void forget() {}
    virtual std::uint64_t memory_bytes() const = 0;
    /// RenderStats::warning of what was rendered last.
    virtual std::string warning() const { return {}; }
    /// Tells `out` of the texels, for techniques that have some.
    virtual void describe_texels(const Frame& frame, Visibility::Impl& out);

private:
    void render_frame(const Frame& frame, Visibility& out, RenderStats& stats,
                      Progress& progress) final;

    std::unique_ptr<gpu::Submission> submission_;
};

/// A technique on the host: from receivers to visibility.
class HostTechnique : public TechniqueBase {
protected:
    using TechniqueBase::TechniqueBase;

    /// `out` has one value per receiver, in their order.
    virtual void compute(const Frame& frame, std::span<const trace::Receiver> receivers,
                         std::span<float> out, Progress& progress) = 0;
    virtual std::uint64_t memory_bytes() const = 0;
    /// Tells `out` of the texels, for techniques that have some.
    virtual void describe_texels(std::span<const trace::Receiver> receivers, Visibility::Impl& out);
    /// RenderStats::note of what was rendered last.
    virtual std::string note() const { return {}; }

private:
    void render_frame(const Frame& frame, Visibility& out, RenderStats& stats,
                      Progress& progress) final;
};

}  // namespace gnomon
