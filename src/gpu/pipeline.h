#pragma once

#include "gpu/resources.h"

#include <span>
#include <vector>

namespace gnomon::gpu {

/// What a shader's binding n of set 0 is, in order from 0.
enum class BindingType { storage_buffer, uniform_buffer, storage_image, texture };

struct PipelineLayoutInfo {
    std::vector<BindingType> bindings;
    std::uint32_t push_bytes = 0;  ///< push constants, at most 128
};

struct ComputePipelineInfo {
    std::span<const std::uint32_t> code;
    PipelineLayoutInfo layout;
    std::vector<std::uint32_t> constants;  ///< specialization constants 0, 1, ...
};

struct GraphicsPipelineInfo {
    std::span<const std::uint32_t> vertex;
    std::span<const std::uint32_t> fragment;  ///< empty = depth only
    /// Both or neither: triangles are patches of three corners (Device::tessellates).
    std::span<const std::uint32_t> tessellation_control = {}, tessellation_evaluation = {};
    PipelineLayoutInfo layout;
    std::vector<VkFormat> color_formats;
    VkFormat depth_format = VK_FORMAT_UNDEFINED;
    std::vector<VkVertexInputAttributeDescription> attributes;
    std::uint32_t vertex_stride = 0;    ///< of vertex buffer 0, one element a vertex
    std::uint32_t instance_stride = 0;  ///< of vertex buffer 1, one element an instance
    bool depth_write = true;
    VkCompareOp depth_compare = VK_COMPARE_OP_GREATER;  ///< reversed Z
    bool depth_clamp = false;
    bool add_colors = false;  ///< to what is in the colour targets; else they are replaced
    /// Stencil counted by depth fail, wrapping: front faces down, back faces up.
    bool stencil_count_depth_fail = false;
};

/// A compute or graphics pipeline with one set of push descriptors. Cull mode and front face are
/// set while recording.
class Pipeline {
public:
    Pipeline() = default;
    Pipeline(const Device& device, const ComputePipelineInfo& info);
    Pipeline(const Device& device, const GraphicsPipelineInfo& info);
    ~Pipeline();
    Pipeline(Pipeline&& other) noexcept;
    Pipeline& operator=(Pipeline&& other) noexcept;

    VkPipeline handle() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_; }
    VkPipelineBindPoint bind_point() const { return bind_point_; }
    VkShaderStageFlags stages() const { return stages_; }
    const PipelineLayoutInfo& layout_info() const { return layout_info_; }

private:
    void make_layout();

    const Device* device_ = nullptr;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineBindPoint bind_point_ = VK_PIPELINE_BIND_POINT_COMPUTE;
    VkShaderStageFlags stages_ = VK_SHADER_STAGE_COMPUTE_BIT;
    PipelineLayoutInfo layout_info_;
};

}  // namespace gnomon::gpu
