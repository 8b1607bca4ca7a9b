#include "gpu/pipeline.h"

#include "constant_test.comp.spv.h"
#include "gpu/device_test.h"
#include "other_test.comp.spv.h"
#include "triangle_test.vert.spv.h"
#include "white_test.frag.spv.h"

#include <cstring>
#include <functional>
#include <set>

namespace gnomon::gpu {
namespace {

class PipelineTest : public DeviceTest {
protected:
    static ComputePipelineInfo writer(std::uint32_t value) {
        return {.code = shaders::constant_test_comp,
                .layout = {.bindings = {BindingType::storage_buffer}},
                .constants = {value}};
    }
    static Pipeline make(const ComputePipelineInfo& info) { return {device(), info}; }
    static Pipeline make(const GraphicsPipelineInfo& info) { return {device(), info}; }

    /// What a shader of constant_test's layout writes.
    static std::uint32_t written(const Pipeline& pipeline) {
        Buffer result(device(), sizeof(std::uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                      Placement::readback);
        Submission submission(device());
        Commands commands = submission.begin();
        commands.use(result, Use::storage_write);
        commands.bind(pipeline, {StorageBuffer{&result}});
        commands.dispatch({1, 1}, 1);
        commands.use(result, Use::host_read);
        submission.submit_and_wait();
        std::uint32_t value = 0;
        std::memcpy(&value, result.mapped(), sizeof(value));
        return value;
    }

    /// `base` and what each of `changes` alone makes of it are compiled once each, however often
    /// they are made.
    template <typename Info>
    static void expect_each_once(const Info& base,
                                 const std::vector<std::function<void(Info&)>>& changes) {
        std::vector<Pipeline> kept;
        std::set<VkPipeline> handles;
        for (const bool again : {false, true}) {
            kept.push_back(make(base));
            EXPECT_EQ(handles.insert(kept.back().handle()).second, !again);
            for (std::size_t i = 0; i < changes.size(); ++i) {
                Info changed = base;
                changes[i](changed);
                kept.push_back(make(changed));
                EXPECT_EQ(handles.insert(kept.back().handle()).second, !again) << "change " << i;
            }
        }
    }
};

TEST_F(PipelineTest, TheSameComputePipelineIsCompiledOnce) {
    expect_each_once<ComputePipelineInfo>(
        writer(1),
        {[](auto& info) { info.code = shaders::other_test_comp; },
         [](auto& info) { info.layout.bindings.push_back(BindingType::texture); },
         [](auto& info) {
             info.layout.bindings = {BindingType::storage_buffer, BindingType::storage_image};
         },
         [](auto& info) { info.layout.push_bytes = 16; }, [](auto& info) { info.constants = {2}; },
         [](auto& info) { info.constants = {}; }});
}

TEST_F(PipelineTest, TheSameGraphicsPipelineIsCompiledOnce) {
    const GraphicsPipelineInfo base{.vertex = shaders::triangle_test_vert,
                                    .color_formats = {VK_FORMAT_R8G8B8A8_UNORM},
                                    .depth_format = VK_FORMAT_D32_SFLOAT_S8_UINT,
                                    .attributes = {{.format = VK_FORMAT_R32G32B32_SFLOAT}},
                                    .vertex_stride = 12};
    expect_each_once<GraphicsPipelineInfo>(
        base,
        {[](auto& info) { info.fragment = shaders::white_test_frag; },
         [](auto& info) { info.layout.push_bytes = 16; },
         [](auto& info) { info.color_formats = {VK_FORMAT_R32G32B32A32_SFLOAT}; },
         [](auto& info) { info.color_formats = {}; },
         [](auto& info) { info.depth_format = VK_FORMAT_UNDEFINED; },
         [](auto& info) { info.vertex_stride = 16; }, [](auto& info) { info.instance_stride = 12; },
         [](auto& info) {
             info.instance_stride = 12;
             info.attributes[0].binding = 1;
         },
         [](auto& info) { info.attributes[0].format = VK_FORMAT_R32G32_SFLOAT; },
         [](auto& info) { info.attributes[0].offset = 4; },
         [](auto& info) { info.depth_write = false; },
         [](auto& info) { info.depth_compare = VK_COMPARE_OP_LESS; },
         [](auto& info) { info.depth_clamp = true; }, [](auto& info) { info.add_colors = true; },
         [](auto& info) { info.stencil_count_depth_fail = true; }});
}

TEST_F(PipelineTest, ACompiledPipelineDoesWhatItWasMadeFor) {
    const Pipeline three = make(writer(3));
    EXPECT_EQ(written(make(writer(7))), 7u);
    EXPECT_EQ(written(three), 3u);
    EXPECT_EQ(written(make(writer(7))), 7u) << "made again";
    ComputePipelineInfo other = writer(7);
    other.code = shaders::other_test_comp;
    EXPECT_EQ(written(make(other)), ~7u);
}

TEST_F(PipelineTest, KeepsTheLastOfThoseThatNoOneHas) {
    const Device own(ContextOptions{.validation = true});
    const auto make_own = [&](std::uint32_t value) { return Pipeline(own, writer(value)); };
    const Pipeline held = make_own(0);
    const VkPipeline handle = held.handle();
    constexpr std::uint32_t kMade = PipelineCache::kMostSpare + 10;
    for (std::uint32_t value = 1; value <= kMade; ++value)
        make_own(value);
    EXPECT_EQ(own.pipelines().size(), 1 + PipelineCache::kMostSpare);
    EXPECT_EQ(make_own(0).handle(), handle) << "one in use was dropped";
    make_own(kMade);
    make_own(kMade - PipelineCache::kMostSpare + 1);
    EXPECT_EQ(own.pipelines().size(), 1 + PipelineCache::kMostSpare) << "a late one was dropped";
    const std::vector<std::string> messages = own.validation_messages();
    EXPECT_TRUE(messages.empty()) << messages.front();
}

}  // namespace
}  // namespace gnomon::gpu
