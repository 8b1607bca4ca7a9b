#include "visibility/lookup_pipeline.h"

#include "visibility/light_shape.h"

#include <utility>

namespace gnomon {

LookupPipeline::LookupPipeline(const gpu::Device& device, gpu::ComputePipelineInfo info)
    : device_(&device), info_(std::move(info)) {
    info_.constants.insert(info_.constants.begin(), shared::kLightOfAnyKind);
}

const gpu::Pipeline& LookupPipeline::of(const Light& light) {
    const std::uint32_t kind = light_shape(light).kind;
    gpu::Pipeline& pipeline = by_kind_[kind];
    if (pipeline.handle() == VK_NULL_HANDLE) {
        info_.constants.front() = kind;
        pipeline = gpu::Pipeline(*device_, info_);
    }
    return pipeline;
}

}  // namespace gnomon
