// Ray-traced shadows: the z-buffer says what each pixel sees, shadow feelers say what it sees of
// the light. A. Appel, "Some Techniques for Shading Machine Renderings of Solids", AFIPS 1968; T.
// Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980; R. Cook et al.,
// "Distributed Ray Tracing", SIGGRAPH 1984, for lights with extent. The rays are those of the
// ground truth (trace/tracer.h).

#include "technique/param_table.h"
#include "technique/technique_base.h"

namespace gnomon {

const TechniqueInfo& ray_traced_info();

namespace {

struct Options {
    int samples = 16;
    // Other rays than those of the truth, whose default seed is 1.
    int seed = 2;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "ray_traced", {integer("samples", &Options::samples, 1, 65536, "rays",
                               "rays per receiver for a light with extent; others take one"),
                       integer("seed", &Options::seed, 0, 1 << 30, "1",
                               "another seed, another choice of points on the light")});
    return table;
}

class RayTraced final : public HostTechnique {
public:
    RayTraced(Context& context, const Options& options)
        : HostTechnique(context, ray_traced_info()), options_(options) {}

private:
    void prepare_scene(const Scene& scene, Progress& progress) override {
        context().tracer(scene, false, progress);
    }

    void compute(const Frame& frame, std::span<const trace::Receiver> receivers,
                 std::span<float> out, Progress& progress) override {
        context()
            .tracer(frame.scene, frame.ignore_alpha, progress)
            ->visibility(receivers, frame.size, frame.light, options_.samples,
                         static_cast<unsigned>(options_.seed), out, progress);
    }

    std::uint64_t memory_bytes() const override { return 0; }

    Options options_;
};

}  // namespace

const TechniqueInfo& ray_traced_info() {
    static const TechniqueInfo info{
        .name = "ray_traced",
        .title = "Ray-traced shadows",
        .source = "appel1968, whitted1980, cook1984",
        .lights = LightKinds::all,
        .penumbra = Penumbra::physical,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<RayTraced>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
