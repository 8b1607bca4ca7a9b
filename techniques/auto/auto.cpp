// The technique for who does not want to choose: looks at the device, the light and the view, and
// hands the frame to another.

#include "choice.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/seen.h"

#include <memory>
#include <utility>

namespace gnomon {

const TechniqueInfo& auto_info();

namespace {

enum class Device { actual, software, gpu };

struct Options {
    Device device = Device::actual;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "auto", {choice("device", &Options::device, {"actual", "software", "gpu"},
                        "what to choose for: the device that there is, or as if there were one of "
                        "that kind")});
    return table;
}

class Automatic final : public TechniqueBase {
public:
    Automatic(Context& context, const Options& options)
        : TechniqueBase(context, auto_info()), handle_(context), options_(options) {}

private:
    // What is chosen depends on the frame, and prepares itself with the first, and again where
    // instances have moved.
    void prepare_scene(const Scene& scene, Progress&) override {
        if (!same(chosen_for_, scene.contents_identity())) chosen_.reset();
        chosen_for_ = scene.contents_identity();
    }

    void render_frame(const Frame& frame, Visibility& out, RenderStats& stats,
                      Progress& progress) override {
        const automatic::Choice choice = choose_for(frame, progress);
        if (!chosen_ || choice.technique != name_ || choice.params.values() != params_.values()) {
            chosen_ = make_technique(handle_, choice.technique, choice.params);
            name_ = choice.technique;
            params_ = choice.params;
            chosen_->prepare(frame.scene, progress);
        }
        chosen_->render(frame, out, progress);
        stats = chosen_->last_render();
        stats.gpu_ms = 0.0;  // summed up from the passes again
        stats.note = automatic::explanation(choice);
    }

    automatic::Choice choose_for(const Frame& frame, Progress& progress) {
        const bool software = options_.device == Device::actual
                                  ? handle_.device().type == DeviceType::cpu
                                  : options_.device == Device::software;
        DepthRange seen{0.0, 0.0};
        if (!software) {
            seen = seen_part(frame.camera, frame.size,
                             context().gpu_scene(frame.scene, &progress).part_bounds_ws())
                       .range;
        }
        return automatic::choose(frame, seen, software);
    }

    Context& handle_;
    Options options_;
    std::unique_ptr<Technique> chosen_;
    SceneKey chosen_for_;  // contents
    std::string name_;
    Params params_;
};

}  // namespace

const TechniqueInfo& auto_info() {
    static const TechniqueInfo info{
        .name = "auto",
        .title = "Chosen by itself",
        .source = "gnomon",
        .lights = LightKinds::all,
        .penumbra = Penumbra::physical,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<Automatic>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
