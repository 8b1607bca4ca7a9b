// Occlusion interval maps: each texel of the scene knows when, on the sun's way of a day, it sees
// the sun's centre; a sun with extent is the part of its way that it covers. W. Donnelly, J.
// Demers, "Generating Soft Shadows Using Occlusion Interval Maps", GPU Gems, 2004, chapter 13.
// Departures: intervals come from one traversal for a tile of texels (src/interval) instead of 256
// rays for each; receivers interpolate what their four texels see, not take the nearest one's; and
// moments count by the height of the sun's disc there, not alike. Runs on the host.

#include "bake/baked_texels.h"
#include "bake/circle_path.h"
#include "base/parallel.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace gnomon {

const TechniqueInfo& occlusion_interval_maps_info();

namespace {

/// A light this near to the baked circle is on it: a tenth of the sun's radius.
constexpr double kOnCircle_rad = 5e-4;
constexpr std::size_t kReceiversPerTask = 4096;
constexpr DVec3 kUp(0.0, 1.0, 0.0);

enum class Weight { even, disc };

struct Options {
    double latitude_deg = 48.0;
    double north_deg = 0.0;
    int steps = 255;
    double texel_size_m = 0.0;
    int texels = 200'000;
    bake::TexelLookup lookup = bake::TexelLookup::interpolated;
    Weight weight = Weight::disc;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "occlusion_interval_maps",
        {number("latitude", &Options::latitude_deg, -90.0, 90.0, "degrees",
                "of the place: the sun turns about the pole that high in the north"),
         number("north", &Options::north_deg, -360.0, 360.0, "degrees",
                "azimuth of true north in the scene, clockwise from -Z"),
         integer("steps", &Options::steps, 1, 1023, "1", "parts of the sun's way of the day"),
         number("texel_size", &Options::texel_size_m, 0.0, 1000.0, "m",
                "side of a texel; 0: such that there are as many as `texels` says"),
         integer("texels", &Options::texels, 1000, 100'000'000, "1", "about how many"),
         choice("lookup", &Options::lookup, {"nearest", "interpolated"},
                "what the texel there sees, or what the four around see, bilinearly"),
         choice("weight", &Options::weight, {"even", "disc"},
                "the sun is a line along its way, or a disc, less of which is where it begins")});
    return table;
}

double surface_area_m2(const Scene& scene) {
    double area_m2 = 0.0;
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
        const std::size_t count = scene.meshes()[scene.instances()[i].mesh].triangles.size();
        for (std::uint32_t t = 0; t < count; ++t)
            area_m2 += 0.5 * glm::length(trace::world_triangle(scene, {i, t}).front_normal_ws());
    }
    return area_m2;
}

class OcclusionIntervalMaps final : public HostTechnique {
public:
    OcclusionIntervalMaps(Context& context, const Options& options)
        : HostTechnique(context, occlusion_interval_maps_info()), options_(options) {}

private:
    /// What is baked, for lights on one circle.
    struct Baked {
        bake::PathThrough through;
        bool ignore_alpha = false;
        bake::BakedTexels texels;
        std::optional<bake::TexelFinder> finder;
    };

    void prepare_scene(const Scene& scene, Progress& progress) override {
        baked_ = nullptr;
        area_m2_ = surface_area_m2(scene);
        for (const Light& light : scene.lights()) {
            if (const auto* sun = std::get_if<DirectionalLight>(&light)) {
                if (area_m2_ > 0.0) bake_for(scene, *sun, false, progress);
                return;
            }
        }
    }

    void bake_for(const Scene& scene, const DirectionalLight& sun, bool ignore_alpha,
                  Progress& progress) {
        auto baked = std::make_unique<Baked>();
        const DVec3 pole_ws = sky_direction_ws(0.0, options_.latitude_deg,
                                               {.up = UpAxis::y, .north_deg = options_.north_deg});
        baked->through = bake::circle_through(DVec3(sun.to_light_ws), pole_ws, kUp, options_.steps);
        baked->ignore_alpha = ignore_alpha;
        const double texel_size_m = options_.texel_size_m > 0.0
                                        ? options_.texel_size_m
                                        : std::sqrt(area_m2_ / options_.texels);
        baked->texels = bake::baked_texels(scene, baked->through.path,
                                           {.texel_size_m = texel_size_m,
                                            .bits = BakeBits::sixteen,
                                            .most_pairs = 16,
                                            .ignore_alpha = ignore_alpha,
                                            .resume_file = {}},
                                           progress);
        baked->finder.emplace(baked->texels);
        baked_ = std::move(baked);
    }

    void compute(const Frame& frame, std::span<const trace::Receiver> receivers,
                 std::span<float> out, Progress& progress) override {
        std::ranges::fill(out, 1.0f);
        if (!(area_m2_ > 0.0)) return;
        const auto& sun = std::get<DirectionalLight>(frame.light);
        const DVec3 to_light(sun.to_light_ws);
        if (!baked_ || baked_->ignore_alpha != frame.ignore_alpha ||
            bake::step_on(baked_->through, to_light, kOnCircle_rad) < 0.0) {
            bake_for(frame.scene, sun, frame.ignore_alpha, progress);
        }
        const LightWindow window{.at_step = bake::step_on(baked_->through, to_light, kOnCircle_rad),
                                 .width_steps = static_cast<double>(sun.angular_diameter_rad) *
                                                baked_->through.steps_per_rad,
                                 .codes_per_step = codes_per_step(BakeBits::sixteen),
                                 .even = options_.weight == Weight::even};
        parallel_for(
            receivers.size(), kReceiversPerTask,
            [&](std::size_t first, std::size_t last) {
                for (std::size_t i = first; i < last; ++i) {
                    if (!receivers[i].exists()) continue;
                    const lightmap::Facet* facet = baked_->finder->facet_of(receivers[i]);
                    out[i] = facet == nullptr ? 0.0f
                                              : static_cast<float>(baked_->finder->visibility(
                                                    *facet, receivers[i], options_.lookup, window));
                }
            },
            "looking up intervals", &progress);
    }

    void describe_texels(std::span<const trace::Receiver> receivers,
                         Visibility::Impl& out) override {
        if (!baked_ || receivers.empty()) return;
        Image sizes_m(out.size(), 1);
        for (std::size_t i = 0; i < receivers.size(); ++i) {
            if (!receivers[i].exists()) continue;
            const lightmap::Facet* facet = baked_->finder->facet_of(receivers[i]);
            if (facet == nullptr) continue;
            sizes_m.pixels()[i] =
                static_cast<float>(std::max(glm::length(facet->u_ws), glm::length(facet->v_ws)));
        }
        const float radius_texels = options_.lookup == bake::TexelLookup::nearest ? 0.5f : 1.0f;
        out.set_texels(std::move(sizes_m), radius_texels);
    }

    std::uint64_t memory_bytes() const override {
        std::uint64_t bytes = 0;
        if (!baked_) return bytes;
        for (const IntervalPage& page : baked_->texels.pages)
            bytes += (page.rises.size() + page.falls.size()) * sizeof(std::uint16_t);
        return bytes;
    }

    Options options_;
    double area_m2_ = 0.0;
    std::unique_ptr<Baked> baked_;
};

}  // namespace

const TechniqueInfo& occlusion_interval_maps_info() {
    static const TechniqueInfo info{
        .name = "occlusion_interval_maps",
        .title = "Occlusion interval maps",
        .source = "donnelly2004",
        .lights = LightKinds::directional,
        .penumbra = Penumbra::physical,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<OcclusionIntervalMaps>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
