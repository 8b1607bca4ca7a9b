#pragma once

#include <gnomon/light.h>

#include "gpu/pipeline.h"
#include "visibility/light_shape.shared.h"

#include <array>

namespace gnomon {

/// The compute pipeline of a shader that includes receiver.glsl, compiled for each kind of light
/// when that is first looked up: shaders that know the kind are twice as fast.
class LookupPipeline {
public:
    LookupPipeline() = default;
    /// `info.constants` are the shader's specialization constants 1, 2, ...
    LookupPipeline(const gpu::Device& device, gpu::ComputePipelineInfo info);

    const gpu::Pipeline& of(const Light& light);
    explicit operator bool() const { return device_ != nullptr; }

private:
    const gpu::Device* device_ = nullptr;
    gpu::ComputePipelineInfo info_;
    std::array<gpu::Pipeline, shared::kLightOfAnyKind> by_kind_;
};

}  // namespace gnomon
