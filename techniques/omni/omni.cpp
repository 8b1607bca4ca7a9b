// Omnidirectional shadow maps: a light that shines all around looks into the faces of a cube, or of
// a tetrahedron. P. Gerasimov, "Omnidirectional Shadow Mapping", GPU Gems 2004, chapter 12; H.-C.
// Liao, "Shadow Mapping for Omnidirectional Light Using Tetrahedron Mapping", GPU Pro, 2010.
// Departures: the faces are layers of an array, each fitted to the receivers that it is for, and
// those that are for none are not drawn. A sphere is seen from its centre.

#include "technique/map_technique.h"
#include "visibility/light_shape.h"

namespace gnomon {

const TechniqueInfo& omni_info();

namespace {

enum class Projection { cube, tetrahedral };
enum class Fit { tight, whole };

struct Options : MapOptions {
    Options() {
        map_size = 1024;
        filter = MapFilter::box_3x3;
    }
    Projection projection = Projection::cube;
    Fit fit = Fit::tight;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "omni",
        {choice("projection", &Options::projection, {"cube", "tetrahedral"},
                "the body whose faces the light looks into: six or four maps"),
         choice("fit", &Options::fit, {"tight", "whole"},
                "tight: a face shows what receivers need of it; whole: all of it, and stays as it "
                "is when the camera moves"),
         number<Options>(
             "distance_scale", &Options::distance_scale, 0.5, 1.0, "1",
             "of contents that are distances: a receiver's, squared, is multiplied by this"),
         number<Options>("distance_offset", &Options::distance_offset, 0.0, 1.0, "1",
                         "and less by this, of the scene's farthest, squared")},
        map_rows<Options>());
    return table;
}

class Omnidirectional final : public MapTechnique {
public:
    Omnidirectional(Context& context, const Options& options)
        : MapTechnique(context, omni_info(), options), options_(options) {}

private:
    MapPlan plan(const Frame& frame, const Seen& seen) const override {
        const DVec3 position_ws = center_ws(frame.light);
        MapPlan plan{.choice = LayerChoice::by_axis};
        for (const LightView& view : options_.projection == Projection::cube
                                         ? cube_views(position_ws)
                                         : tetrahedron_views(position_ws)) {
            plan.layers.push_back(local_layer(frame, seen, view, options_.fit == Fit::tight));
        }
        return plan;
    }

    Options options_;
};

}  // namespace

const TechniqueInfo& omni_info() {
    static const TechniqueInfo info{
        .name = "omni",
        .title = "Omnidirectional shadow map",
        .source = "gerasimov2004, liao2010",
        .lights = LightKinds::point | LightKinds::sphere,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<Omnidirectional>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
