#pragma once

#include "gpu/resources.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
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

/// What the device made of a pipeline's code and state, freed before the device.
class CompiledPipeline {
public:
    CompiledPipeline(const Device& device, const ComputePipelineInfo& info);
    CompiledPipeline(const Device& device, const GraphicsPipelineInfo& info);
    ~CompiledPipeline();
    CompiledPipeline(const CompiledPipeline&) = delete;
    CompiledPipeline& operator=(const CompiledPipeline&) = delete;

    VkPipeline handle() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_; }

private:
    explicit CompiledPipeline(const Device& device) : device_(device) {}
    void make_layout(const PipelineLayoutInfo& info, VkShaderStageFlags stages);

    const Device& device_;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
};

/// A device's compiled pipelines, by all that they were made from. Techniques come and go with
/// their parameters, and compiling takes longer than a frame; so some that no Pipeline has any more
/// are kept. As its Context, not to be used from two threads at a time.
class PipelineCache {
public:
    /// Of those that no Pipeline has, the last so many that were asked for are kept: a search
    /// through parameters that change shaders is not to fill the memory.
    static constexpr std::size_t kMostSpare = 256;

    std::shared_ptr<const CompiledPipeline> get(const Device& device,
                                                const ComputePipelineInfo& info);
    std::shared_ptr<const CompiledPipeline> get(const Device& device,
                                                const GraphicsPipelineInfo& info);
    std::size_t size() const { return entries_.size(); }

private:
    struct Entry {
        std::shared_ptr<const CompiledPipeline> compiled;
        std::uint64_t asked = 0;  ///< when last: a count of calls
    };
    template <typename Info>
    std::shared_ptr<const CompiledPipeline> find_or_make(const Device& device, const Info& info);
    void drop_spare();

    std::unordered_map<std::string, Entry> entries_;
    std::uint64_t calls_ = 0;
};

/// A compute or graphics pipeline with one set of push descriptors. Cull mode and front face are
/// set while recording. The same code in the same state is compiled once (PipelineCache).
class Pipeline {
public:
    Pipeline() = default;
    Pipeline(const Device& device, const ComputePipelineInfo& info);
    Pipeline(const Device& device, const GraphicsPipelineInfo& info);

    VkPipeline handle() const { return compiled_ ? compiled_->handle() : VK_NULL_HANDLE; }
    VkPipelineLayout layout() const { return compiled_->layout(); }
    VkPipelineBindPoint bind_point() const { return bind_point_; }
    VkShaderStageFlags stages() const { return stages_; }
    const PipelineLayoutInfo& layout_info() const { return layout_info_; }

private:
    std::shared_ptr<const CompiledPipeline> compiled_;
    VkPipelineBindPoint bind_point_ = VK_PIPELINE_BIND_POINT_COMPUTE;
    VkShaderStageFlags stages_ = VK_SHADER_STAGE_COMPUTE_BIT;
    PipelineLayoutInfo layout_info_;
};

}  // namespace gnomon::gpu
