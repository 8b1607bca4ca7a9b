// Per-vertex shadows: how much of a light that stands still each vertex sees, traced once, and
// receivers between them. S. Dietrich, "More on Shadowing", developer's journal, GameDev.net,
// undated. What is different here, and why: vertex_bake.cpp.

#include "base/parallel.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "vertex_bake.h"
#include "visibility/light_shape.h"

#include <fmt/format.h>

#include <optional>

namespace gnomon {

const TechniqueInfo& vertex_occlusion_info();

namespace {

using vertex_grid::SceneGrid;
using vertex_occlusion::VertexBake;
using vertex_occlusion::VertexLookup;

constexpr std::size_t kReceiversPerTask = 4096;
constexpr std::uint64_t kThousand = 1000;

struct Options {
    double tessellate = 0.03;
    int vertices = 1000;
    int samples = 32;
    bool walls = true;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "vertex_occlusion",
        {number("tessellate", &Options::tessellate, 0.0, 1e6, "m",
                "triangles are cut until no edge is longer; 0: the mesh as it is"),
         integer("vertices", &Options::vertices, 1, 10'000, "thousand",
                 "most vertices of triangles that are cut: in large scenes edges stay longer"),
         integer("samples", &Options::samples, 1, 65536, "rays",
                 "rays per vertex for a light with extent; others take one"),
         boolean("walls", &Options::walls,
                 "receivers take nothing from vertices that something stands before")});
    return table;
}

class VertexOcclusion final : public HostTechnique {
public:
    VertexOcclusion(Context& context, const Options& options)
        : HostTechnique(context, vertex_occlusion_info()), options_(options) {}

private:
    /// For which light the bake is, and for which casters.
    struct Baked {
        Light light;
        bool ignore_alpha = false;
        VertexBake bake;
    };

    void prepare_scene(const Scene& scene, Progress& progress) override {
        baked_.reset();
        context().tracer(scene, false, progress);
        grid_ = SceneGrid(scene, options_.tessellate,
                          kThousand * static_cast<std::uint64_t>(options_.vertices));
    }

    void compute(const Frame& frame, std::span<const trace::Receiver> receivers,
                 std::span<float> out, Progress& progress) override {
        const std::shared_ptr<const trace::Tracer> kept =
            context().tracer(frame.scene, frame.ignore_alpha, progress);
        const trace::Tracer& tracer = *kept;
        if (!baked_ || baked_->ignore_alpha != frame.ignore_alpha ||
            !same_place(baked_->light, frame.light)) {
            baked_.reset();  // first, so that two bakes never are in memory at once
            baked_ = Baked{
                frame.light, frame.ignore_alpha,
                VertexBake(frame.scene, grid_, tracer, frame.light, options_.samples, progress)};
        }
        const VertexLookup lookup(frame.scene, grid_, baked_->bake, tracer, frame.light,
                                  options_.walls);
        parallel_for(
            receivers.size(), kReceiversPerTask,
            [&](std::size_t first, std::size_t last) {
                lookup.look_up(receivers.subspan(first, last - first),
                               out.subspan(first, last - first));
            },
            "interpolating vertices", &progress);
    }

    std::uint64_t memory_bytes() const override {
        return grid_.memory_bytes() + (baked_ ? baked_->bake.memory_bytes() : 0);
    }

    void describe_texels(std::span<const trace::Receiver> receivers,
                         Visibility::Impl& out) override {
        Image texel_size_m(out.size(), 1);
        for (std::size_t i = 0; i < receivers.size(); ++i) {
            if (!receivers[i].exists()) continue;
            texel_size_m.pixels()[i] = grid_.of(receivers[i].id).cell_m;
        }
        // Interpolation reaches the corners of a cell, as reading one texel does.
        out.set_texels(std::move(texel_size_m), 0.0f);
    }

    std::string note() const override {
        if (!(grid_.edge_m() > options_.tessellate)) return {};
        return fmt::format("Edges of {:.2g} m, as {} thousand vertices are too few for {} m.",
                           grid_.edge_m(), options_.vertices, options_.tessellate);
    }

    Options options_;
    SceneGrid grid_;
    std::optional<Baked> baked_;
};

}  // namespace

const TechniqueInfo& vertex_occlusion_info() {
    static const TechniqueInfo info{
        .name = "vertex_occlusion",
        .title = "Per-vertex occlusion",
        .source = "dietrich_journal",
        .lights = LightKinds::all,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<VertexOcclusion>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
