#include "gpu/pipeline.h"

#include "base/check.h"

#include <array>
#include <cassert>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

namespace gnomon::gpu {

namespace {

VkDescriptorType descriptor_type(BindingType type) {
    switch (type) {
        case BindingType::storage_buffer:
            return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        case BindingType::uniform_buffer:
            return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        case BindingType::storage_image:
            return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
        case BindingType::texture:
            break;
    }
    return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
}

/// A shader module, for as long as a pipeline is being made.
class ShaderModule {
public:
    ShaderModule(const Device& device, std::span<const std::uint32_t> code) : device_(device) {
        const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .codeSize = code.size_bytes(),
                                            .pCode = code.data()};
        check(vkCreateShaderModule(device.handle(), &info, nullptr, &module_), "loading a shader");
    }
    ~ShaderModule() { vkDestroyShaderModule(device_.handle(), module_, nullptr); }
    ShaderModule(const ShaderModule&) = delete;
    ShaderModule& operator=(const ShaderModule&) = delete;

    VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits stage) const {
        return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .stage = stage,
                .module = module_,
                .pName = "main"};
    }

private:
    const Device& device_;
    VkShaderModule module_ = VK_NULL_HANDLE;
};

VkPipelineDepthStencilStateCreateInfo depth_stencil(const GraphicsPipelineInfo& info) {
    VkStencilOpState front{.failOp = VK_STENCIL_OP_KEEP,
                           .passOp = VK_STENCIL_OP_KEEP,
                           .depthFailOp = VK_STENCIL_OP_DECREMENT_AND_WRAP,
                           .compareOp = VK_COMPARE_OP_ALWAYS,
                           .compareMask = 0xff,
                           .writeMask = 0xff};
    VkStencilOpState back = front;
    back.depthFailOp = VK_STENCIL_OP_INCREMENT_AND_WRAP;
    return {.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
            .depthTestEnable = info.depth_format != VK_FORMAT_UNDEFINED ? VK_TRUE : VK_FALSE,
            .depthWriteEnable = info.depth_write ? VK_TRUE : VK_FALSE,
            .depthCompareOp = info.depth_compare,
            .stencilTestEnable = info.stencil_count_depth_fail ? VK_TRUE : VK_FALSE,
            .front = front,
            .back = back};
}

VkPipelineColorBlendAttachmentState color_blend(bool adds) {
    return {.blendEnable = adds ? VK_TRUE : VK_FALSE,
            .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
            .dstColorBlendFactor = VK_BLEND_FACTOR_ONE,
            .colorBlendOp = VK_BLEND_OP_ADD,
            .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
            .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
            .alphaBlendOp = VK_BLEND_OP_ADD,
            .colorWriteMask = 0xf};
}

/// The stages of a graphics pipeline, for as long as it is being made.
class GraphicsStages {
public:
    GraphicsStages(const Device& device, const GraphicsPipelineInfo& info) {
        assert(info.tessellation_control.empty() == info.tessellation_evaluation.empty());
        add(device, VK_SHADER_STAGE_VERTEX_BIT, info.vertex);
        add(device, VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT, info.tessellation_control);
        add(device, VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT, info.tessellation_evaluation);
        add(device, VK_SHADER_STAGE_FRAGMENT_BIT, info.fragment);
    }

    /// Which of them there are.
    static VkShaderStageFlags flags(const GraphicsPipelineInfo& info) {
        constexpr VkShaderStageFlags kDrawing =
            VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
        constexpr VkShaderStageFlags kTessellation =
            VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT | VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT;
        return info.tessellation_control.empty() ? kDrawing : kDrawing | kTessellation;
    }

    const std::vector<VkPipelineShaderStageCreateInfo>& infos() const { return infos_; }

private:
    void add(const Device& device, VkShaderStageFlagBits stage,
             std::span<const std::uint32_t> code) {
        if (code.empty()) return;
        modules_.push_back(std::make_unique<ShaderModule>(device, code));
        infos_.push_back(modules_.back()->stage(stage));
    }

    std::vector<std::unique_ptr<ShaderModule>> modules_;
    std::vector<VkPipelineShaderStageCreateInfo> infos_;
};

// What all graphics pipelines have alike, or all with and all without tessellation.
constexpr VkPipelineInputAssemblyStateCreateInfo kTriangles{
    .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
    .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
constexpr VkPipelineInputAssemblyStateCreateInfo kPatches{
    .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
    .topology = VK_PRIMITIVE_TOPOLOGY_PATCH_LIST};
constexpr VkPipelineTessellationStateCreateInfo kTessellation{
    .sType = VK_STRUCTURE_TYPE_PIPELINE_TESSELLATION_STATE_CREATE_INFO, .patchControlPoints = 3};
constexpr VkPipelineViewportStateCreateInfo kViewport{
    .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
    .viewportCount = 1,
    .scissorCount = 1};
constexpr VkPipelineMultisampleStateCreateInfo kMultisample{
    .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
    .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
constexpr std::array kDynamicStates = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                       VK_DYNAMIC_STATE_CULL_MODE, VK_DYNAMIC_STATE_FRONT_FACE};
constexpr VkPipelineDynamicStateCreateInfo kDynamic{
    .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
    .dynamicStateCount = static_cast<std::uint32_t>(kDynamicStates.size()),
    .pDynamicStates = kDynamicStates.data()};

/// The bytes of all that a pipeline is made from, each list after its length. Structures are taken
/// apart into all of their members, so that one added later does not compile until it is here.
class Key {
public:
    explicit Key(const ComputePipelineInfo& info) {
        const auto& [code, layout, constants] = info;
        add(code, layout, constants);
    }
    explicit Key(const GraphicsPipelineInfo& info) {
        const auto& [vertex, fragment, tessellation_control, tessellation_evaluation, layout,
                     color_formats, depth_format, attributes, vertex_stride, instance_stride,
                     depth_write, depth_compare, depth_clamp, add_colors,
                     stencil_count_depth_fail] = info;
        add(vertex, fragment, tessellation_control, tessellation_evaluation, layout, color_formats,
            depth_format, attributes, vertex_stride, instance_stride, depth_write, depth_compare,
            depth_clamp, add_colors, stencil_count_depth_fail);
    }
    std::string bytes() && { return std::move(bytes_); }

private:
    template <typename... Fields>
    void add(const Fields&... fields) {
        (add_one(fields), ...);
    }
    void add_one(const PipelineLayoutInfo& layout) {
        const auto& [bindings, push_bytes] = layout;
        add(bindings, push_bytes);
    }
    template <typename Value>
    void add_one(const std::vector<Value>& values) {
        add_one(std::span(values));
    }
    template <typename Value>
    void add_one(std::span<Value> values) {
        add_one(values.size());
        add_bytes(values);
    }
    template <typename Value>
    requires std::is_scalar_v<Value>
    void add_one(Value value) { add_bytes(std::span(&value, 1)); }
    template <typename Value>
    void add_bytes(std::span<Value> values) {
        static_assert(std::has_unique_object_representations_v<Value>,
                      "padding would make keys of equal values differ");
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    }

    std::string bytes_;
};

}  // namespace

template <typename Info>
std::shared_ptr<const CompiledPipeline> PipelineCache::find_or_make(const Device& device,
                                                                    const Info& info) {
    std::string key = Key(info).bytes();
    auto found = entries_.find(key);
    if (found == entries_.end()) {
        drop_spare();
        auto made = std::make_shared<const CompiledPipeline>(device, info);
        found = entries_.emplace(std::move(key), Entry{std::move(made)}).first;
    }
    found->second.asked = ++calls_;
    return found->second.compiled;
}

std::shared_ptr<const CompiledPipeline> PipelineCache::get(const Device& device,
                                                           const ComputePipelineInfo& info) {
    return find_or_make(device, info);
}

std::shared_ptr<const CompiledPipeline> PipelineCache::get(const Device& device,
                                                           const GraphicsPipelineInfo& info) {
    return find_or_make(device, info);
}

/// Drops the one that was asked for longest ago when there are enough.
void PipelineCache::drop_spare() {
    std::size_t spare = 0;
    auto oldest = entries_.end();
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
        if (entry->second.compiled.use_count() > 1) continue;
        ++spare;
        if (oldest == entries_.end() || entry->second.asked < oldest->second.asked) oldest = entry;
    }
    if (spare >= kMostSpare) entries_.erase(oldest);
}

Pipeline::Pipeline(const Device& device, const ComputePipelineInfo& info)
    : compiled_(device.pipelines().get(device, info)), layout_info_(info.layout) {}

Pipeline::Pipeline(const Device& device, const GraphicsPipelineInfo& info)
    : compiled_(device.pipelines().get(device, info)),
      bind_point_(VK_PIPELINE_BIND_POINT_GRAPHICS),
      stages_(GraphicsStages::flags(info)),
      layout_info_(info.layout) {}

void CompiledPipeline::make_layout(const PipelineLayoutInfo& info, VkShaderStageFlags stages) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const BindingType type : info.bindings) {
        bindings.push_back({.binding = static_cast<std::uint32_t>(bindings.size()),
                            .descriptorType = descriptor_type(type),
                            .descriptorCount = 1,
                            .stageFlags = stages});
    }
    const VkDescriptorSetLayoutCreateInfo set{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR,
        .bindingCount = static_cast<std::uint32_t>(bindings.size()),
        .pBindings = bindings.data()};
    check(vkCreateDescriptorSetLayout(device_.handle(), &set, nullptr, &set_layout_),
          "creating a descriptor layout");
    const VkPushConstantRange push{stages, 0, info.push_bytes};
    const VkPipelineLayoutCreateInfo layout{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                            .setLayoutCount = 1,
                                            .pSetLayouts = &set_layout_,
                                            .pushConstantRangeCount = info.push_bytes > 0 ? 1u : 0u,
                                            .pPushConstantRanges = &push};
    check(vkCreatePipelineLayout(device_.handle(), &layout, nullptr, &layout_),
          "creating a pipeline layout");
}

// Delegating makes the object whole at once, so that its destructor frees what was made before a
// step that fails.
CompiledPipeline::CompiledPipeline(const Device& device, const ComputePipelineInfo& info)
    : CompiledPipeline(device) {
    make_layout(info.layout, VK_SHADER_STAGE_COMPUTE_BIT);
    const ShaderModule shader(device, info.code);
    std::vector<VkSpecializationMapEntry> entries;
    for (std::uint32_t i = 0; i < info.constants.size(); ++i) {
        entries.push_back({i, i * 4, 4});
    }
    const VkSpecializationInfo constants{
        .mapEntryCount = static_cast<std::uint32_t>(entries.size()),
        .pMapEntries = entries.data(),
        .dataSize = info.constants.size() * 4,
        .pData = info.constants.data()};
    VkComputePipelineCreateInfo create{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                       .stage = shader.stage(VK_SHADER_STAGE_COMPUTE_BIT),
                                       .layout = layout_};
    create.stage.pSpecializationInfo = &constants;
    check(
        vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &create, nullptr, &pipeline_),
        "creating a compute pipeline");
}

CompiledPipeline::CompiledPipeline(const Device& device, const GraphicsPipelineInfo& info)
    : CompiledPipeline(device) {
    make_layout(info.layout, GraphicsStages::flags(info));
    const GraphicsStages stages(device, info);
    const bool tessellates = !info.tessellation_control.empty();
    const std::array<VkVertexInputBindingDescription, 2> bindings{
        {{0, info.vertex_stride, VK_VERTEX_INPUT_RATE_VERTEX},
         {1, info.instance_stride, VK_VERTEX_INPUT_RATE_INSTANCE}}};
    const std::uint32_t per_vertex = info.vertex_stride > 0 ? 1 : 0;
    const std::uint32_t per_instance = info.instance_stride > 0 ? 1 : 0;
    const VkPipelineVertexInputStateCreateInfo input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = per_vertex + per_instance,
        .pVertexBindingDescriptions = bindings.data(),
        .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(info.attributes.size()),
        .pVertexAttributeDescriptions = info.attributes.data()};
    const VkPipelineRasterizationStateCreateInfo raster{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .depthClampEnable = info.depth_clamp ? VK_TRUE : VK_FALSE,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .lineWidth = 1.0f};
    const VkPipelineDepthStencilStateCreateInfo depth = depth_stencil(info);
    const std::vector<VkPipelineColorBlendAttachmentState> attachments(
        info.color_formats.size(), color_blend(info.add_colors));
    const VkPipelineColorBlendStateCreateInfo blend{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = static_cast<std::uint32_t>(attachments.size()),
        .pAttachments = attachments.data()};
    const bool stencil = info.depth_format == VK_FORMAT_D32_SFLOAT_S8_UINT;
    const VkPipelineRenderingCreateInfo rendering{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = static_cast<std::uint32_t>(info.color_formats.size()),
        .pColorAttachmentFormats = info.color_formats.data(),
        .depthAttachmentFormat = info.depth_format,
        .stencilAttachmentFormat = stencil ? info.depth_format : VK_FORMAT_UNDEFINED};
    const VkGraphicsPipelineCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = &rendering,
        .stageCount = static_cast<std::uint32_t>(stages.infos().size()),
        .pStages = stages.infos().data(),
        .pVertexInputState = &input,
        .pInputAssemblyState = tessellates ? &kPatches : &kTriangles,
        .pTessellationState = tessellates ? &kTessellation : nullptr,
        .pViewportState = &kViewport,
        .pRasterizationState = &raster,
        .pMultisampleState = &kMultisample,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &kDynamic,
        .layout = layout_};
    check(
        vkCreateGraphicsPipelines(device.handle(), VK_NULL_HANDLE, 1, &create, nullptr, &pipeline_),
        "creating a graphics pipeline");
}

CompiledPipeline::~CompiledPipeline() {
    vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_.handle(), set_layout_, nullptr);
}

}  // namespace gnomon::gpu
