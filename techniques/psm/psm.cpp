// Perspective shadow maps: one map, or the faces of a cube, in the space behind the camera's
// projection, where what is near is large. M. Stamminger, G. Drettakis, "Perspective Shadow Maps",
// SIGGRAPH 2002; S. Kozlov, "Perspective Shadow Maps: Care and Feeding", GPU Gems 2004, chapter 14.
// Departures: both projections are one matrix, whose depth is linear along the light within the
// range of the receivers; what chapter 14 needs an inverse projection for is then the matrix's
// sign.

#include "post_projective.h"
#include "technique/map_technique.h"
#include "visibility/light_shape.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace gnomon {

const TechniqueInfo& psm_info();

namespace {

enum class Map { single, cube };
enum class Virtual { none, near_quad, slide_back };

struct Options : MapOptions {
    Map map = Map::single;
    Virtual virtual_camera = Virtual::near_quad;
    double slide = 1.0;
    bool beyond_infinity = true;
    bool raise_near = true;
    bool unit_cube_clipping = true;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "psm",
        {choice("map", &Options::map, {"single", "cube"},
                "one map, or one for each face of the unit cube that the light does not see from "
                "outside; point lights take a cube"),
         choice("virtual_camera", &Options::virtual_camera, {"none", "near_quad", "slide_back"},
                "whose projection it is: the view camera's; that of one behind it with the same "
                "near plane; or of one so far behind that it sees the whole scene"),
         number("slide", &Options::slide, 0.0, 100.0, "1",
                "how far behind near_quad's camera is, of the geometric mean of the near and far "
                "distance"),
         boolean("beyond_infinity", &Options::beyond_infinity,
                 "casters behind that camera keep their shadows, else only what reaches before it "
                 "is drawn"),
         boolean("raise_near", &Options::raise_near,
                 "the near plane is at the nearest receiver instead of the camera's"),
         boolean("unit_cube_clipping", &Options::unit_cube_clipping,
                 "maps show what receivers need instead of the whole view")},
        map_rows<Options>());
    return table;
}

glm::dvec4 homogeneous(const Light& light) {
    if (const auto* sun = std::get_if<DirectionalLight>(&light))
        return {glm::normalize(DVec3(sun->to_light_ws)), 0.0};
    return {center_ws(light), 1.0};
}

/// Height towards a light at infinity, from the point where the map is finest: a perspective of it,
/// which is their depth, then keeps most of its range for heights, not for distances from it.
glm::dvec4 height_row(const psm::Projection& projection, const glm::dvec4& light_ws,
                      std::span<const DVec3> points_ws) {
    const DVec3 finest = *std::ranges::min_element(
        points_ws, {}, [&](const DVec3& p) { return projection.along(p); });
    return {DVec3(light_ws), -glm::dot(DVec3(light_ws), finest)};
}

/// Of a face's distance from the light: nearer receivers are at it.
constexpr double kLeastAlong = 1e-9;

/// Depth for a light within the world, as of a view from it: the inverse of the distance from it.
void set_depth_from_light(LightFit& fit, const psm::Projection& face, DVec3 light_ws,
                          const Box3& bounds) {
    const double near_along = near_light_m(bounds) * glm::length(DVec3(face.w));
    for (int column = 0; column < 4; ++column)
        fit.clip_from_world[column].z = column < 3 ? 0.0 : near_along;
    fit.far_m = farthest_m(bounds, light_ws);
    fit.clamps_near = false;
}

class Perspective final : public MapTechnique {
public:
    Perspective(Context& context, const Options& options)
        : MapTechnique(context, psm_info(), options), options_(options) {}

private:
    MapPlan plan(const Frame& frame, const Seen& seen) const override {
        const bool is_lamp = !std::holds_alternative<DirectionalLight>(frame.light);
        const bool is_parallel = frame.camera.ortho_height_m > 0.0f;
        if (is_parallel || seen.range.far_m <= seen.range.near_m)
            return is_lamp ? cube_of_world(frame, seen) : uniform(frame, seen);
        const psm::VirtualCamera camera = camera_for(frame, seen);
        MapPlan plan = options_.map == Map::cube || is_lamp ? cube(frame, seen, camera)
                                                            : single(frame, seen, camera);
        if (!options_.beyond_infinity) {
            for (PlannedLayer& layer : plan.layers)
                layer.lost_behind_ws = camera.infinity_ws();
        }
        return plan;
    }

    psm::VirtualCamera camera_for(const Frame& frame, const Seen& seen) const {
        DepthRange range = seen.range;
        if (!options_.raise_near) range.near_m = static_cast<double>(frame.camera.near_m);
        const psm::VirtualCamera camera = psm::virtual_camera(frame.camera, frame.size, range);
        switch (options_.virtual_camera) {
            case Virtual::near_quad:
                return psm::slid(camera, options_.slide * std::sqrt(range.near_m * range.far_m));
            case Virtual::slide_back:
                return psm::slid_behind(camera, frame.scene.bounds());
            case Virtual::none:
                break;
        }
        return camera;
    }

    MapPlan uniform(const Frame& frame, const Seen& seen) const {
        const LightFit fit =
            fit_directional(std::get<DirectionalLight>(frame.light),
                            visible_corners(frame.camera, frame.size, seen.bounds, seen.range),
                            frame.scene.bounds(), options_.size_texels(), options_.margin_texels());
        return {.layers = {directional_layer(frame, seen, fit, seen.range)}};
    }

    MapPlan cube_of_world(const Frame& frame, const Seen& seen) const {
        MapPlan plan{.choice = LayerChoice::by_axis};
        for (const LightView& view : cube_views(DVec3(homogeneous(frame.light))))
            plan.layers.push_back(local_layer(frame, seen, view, options_.unit_cube_clipping));
        return plan;
    }

    MapPlan single(const Frame& frame, const Seen& seen, const psm::VirtualCamera& camera) const {
        const std::vector<DVec3> receivers_ws =
            visible_corners(frame.camera, frame.size, seen.bounds, seen.range);
        const std::vector<DVec3> shown_ws =
            options_.unit_cube_clipping ? receivers_ws : camera.corners_ws();
        if (receivers_ws.empty()) return uniform(frame, seen);
        const glm::dvec4 light_ws = homogeneous(frame.light);
        const psm::Projection projection = psm::light_camera(camera, light_ws, shown_ws);
        // A light that looks into the camera is all but in the view: no one picture shows it all.
        if (std::ranges::any_of(shown_ws,
                                [&](const DVec3& p) { return !(projection.along(p) > 0.0); })) {
            return uniform(frame, seen);
        }
        const LightFit fit =
            fit_image(projection.image_from_world(height_row(projection, light_ws, shown_ws)),
                      shown_ws, options_.size_texels(), options_.margin_texels());
        return {.layers = {directional_layer(frame, seen, fit, seen.range)}};
    }

    MapPlan cube(const Frame& frame, const Seen& seen, const psm::VirtualCamera& camera) const {
        const glm::dvec4 light_ws = homogeneous(frame.light);
        MapPlan plan{.choice = LayerChoice::by_axis};
        for (const psm::Projection& face : psm::cube_faces(camera, light_ws))
            plan.layers.push_back(face_layer(frame, seen, face, light_ws));
        return plan;
    }

    PlannedLayer face_layer(const Frame& frame, const Seen& seen, const psm::Projection& face,
                            const glm::dvec4& light_ws) const {
        std::vector<DVec3> shown_ws =
            visible_corners(frame.camera, frame.size, seen.bounds, seen.range, face.planes());
        // Around the light itself, if receivers can be there, the others tell all directions.
        std::erase_if(shown_ws, [&](const DVec3& p) { return !(face.along(p) > kLeastAlong); });
        const bool needed = !shown_ws.empty();
        if (!needed || !options_.unit_cube_clipping) {
            shown_ws.insert(shown_ws.end(), face.corners_ws.begin(), face.corners_ws.end());
        }
        LightFit fit = fit_image(face.image_from_world(height_row(face, light_ws, shown_ws)),
                                 shown_ws, options_.size_texels(), options_.margin_texels());
        if (std::holds_alternative<DirectionalLight>(frame.light)) {
            PlannedLayer layer = directional_layer(frame, seen, fit, seen.range);
            layer.needed = needed;
            return layer;
        }
        set_depth_from_light(fit, face, DVec3(light_ws), frame.scene.bounds());
        return {{fit},
                CasterVolume(fit, visible_planes(frame.camera, frame.size, seen.bounds, seen.range),
                             DVec3(light_ws)),
                needed};
    }

    Options options_;
};

}  // namespace

const TechniqueInfo& psm_info() {
    static const TechniqueInfo info{
        .name = "psm",
        .title = "Perspective shadow map",
        .source = "stamminger2002, kozlov2004",
        .lights = LightKinds::directional | LightKinds::point | LightKinds::sphere,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<Perspective>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
