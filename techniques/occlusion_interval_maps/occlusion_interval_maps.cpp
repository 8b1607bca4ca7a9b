// Occlusion interval maps: each texel of the scene knows when, on the sun's way of a day, it sees
// the sun's centre; a sun with extent is the part of its way that it covers. W. Donnelly, J.
// Demers, "Generating Soft Shadows Using Occlusion Interval Maps", GPU Gems, 2004, chapter 13.
// Departures: intervals come from one traversal for a tile of texels (src/interval) instead of 256
// rays for each, and their ends from rays between steps; receivers move the edges of shadows of
// their four texels to their own time, not take the nearest texel's; where the four have not the
// same edges there are finer samples; and moments count by the height of the sun's disc there, not
// alike. Runs on the host.

#include "bake/baked_texels.h"
#include "bake/circle_path.h"
#include "base/parallel.h"
#include "lightmap/surface.h"
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

enum class TimeBits { eight, sixteen };
enum class Weight { even, disc };

struct Options {
    double latitude_deg = 48.0;
    double north_deg = 0.0;
    int steps = 511;
    double texel_size_m = 0.0;
    int texels = 400'000;
    bool half_resolution = false;
    int fine_parts = 4;
    TimeBits bits = TimeBits::sixteen;
    bake::TexelLookup lookup = bake::TexelLookup::edges;
    Weight weight = Weight::disc;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "occlusion_interval_maps",
        {number("latitude", &Options::latitude_deg, -90.0, 90.0, "degrees",
                "of the place: the sun turns about the pole that high in the north"),
         number("north", &Options::north_deg, -360.0, 360.0, "degrees",
                "azimuth of true north in the scene, clockwise from -Z"),
         integer("steps", &Options::steps, 1, most_steps(BakeBits::sixteen), "1",
                 "parts of the sun's way of the day; what is dark for less can be missed"),
         number("texel_size", &Options::texel_size_m, 0.0, 1000.0, "m",
                "side of a texel; 0: such that there are as many as `texels` says"),
         integer("texels", &Options::texels, 1000, 100'000'000, "1", "about how many"),
         boolean("half_resolution", &Options::half_resolution,
                 "texels of twice that size, a quarter as many"),
         integer("fine_parts", &Options::fine_parts, 1, 8, "1",
                 "along each side of what is between four texels that have not the same edges of "
                 "shadows; for `lookup` edges"),
         choice("bits", &Options::bits, {"8", "16"},
                "of a time: steps, no more than 255 of which are used, or 64ths of them"),
         choice("lookup", &Options::lookup, {"nearest", "interpolated", "edges"},
                "what the texel there sees; what the four around see, bilinearly; or that once "
                "their edges have been moved to the receiver"),
         choice("weight", &Options::weight, {"even", "disc"},
                "the sun is a line along its way, or a disc, less of which is where it begins")});
    return table;
}

/// Of the sides that face the path at some time.
double lit_area_m2(const Scene& scene, const BakePath& path) {
    double area_m2 = 0.0;
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i)
        area_m2 += lightmap::Surface(scene, i, true, path.to_light_ws).area_m2();
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
        for (const Light& light : scene.lights()) {
            if (const auto* sun = std::get_if<DirectionalLight>(&light)) {
                bake_for(scene, *sun, false, progress);
                return;
            }
        }
    }

    int steps() const {
        return options_.bits == TimeBits::eight
                   ? std::min(options_.steps, most_steps(BakeBits::eight))
                   : options_.steps;
    }
    /// Only where edges are asked for do finer cells count.
    int fine_parts() const {
        return options_.lookup == bake::TexelLookup::edges ? options_.fine_parts : 1;
    }
    BakeBits bits() const {
        return options_.bits == TimeBits::eight ? BakeBits::eight : BakeBits::sixteen;
    }

    /// Whether the light's way is baked.
    bool is_baked_for(const DirectionalLight& sun, bool ignore_alpha) const {
        if (!baked_ || baked_->ignore_alpha != ignore_alpha) return false;
        return bake::step_on(baked_->through, DVec3(sun.to_light_ws), kOnCircle_rad) >= 0.0;
    }

    void bake_for(const Scene& scene, const DirectionalLight& sun, bool ignore_alpha,
                  Progress& progress) {
        auto baked = std::make_unique<Baked>();
        const DVec3 pole_ws = sky_direction_ws(0.0, options_.latitude_deg,
                                               {.up = UpAxis::y, .north_deg = options_.north_deg});
        baked->through = bake::circle_through(DVec3(sun.to_light_ws), pole_ws, kUp, steps());
        baked->ignore_alpha = ignore_alpha;
        const double area_m2 = lit_area_m2(scene, baked->through.path);
        double texel_size_m = options_.texel_size_m > 0.0 ? options_.texel_size_m
                                                          : std::sqrt(area_m2 / options_.texels);
        if (options_.half_resolution) texel_size_m *= 2.0;
        if (!(area_m2 > 0.0)) {  // nothing ever faces the light
            baked_ = std::move(baked);
            return;
        }
        baked->texels =
            bake::baked_texels(scene, baked->through.path,
                               {.texel_size_m = texel_size_m,
                                .bits = bits(),
                                .most_pairs = 16,
                                .ignore_alpha = ignore_alpha,
                                .resume_file = {}},
                               {.lit_sides_only = true, .fine_parts = fine_parts()}, progress);
        baked->finder.emplace(baked->texels);
        baked_ = std::move(baked);
    }

    void compute(const Frame& frame, std::span<const trace::Receiver> receivers,
                 std::span<float> out, Progress& progress) override {
        std::ranges::fill(out, 1.0f);
        const auto& sun = std::get<DirectionalLight>(frame.light);
        const DVec3 to_light(sun.to_light_ws);
        if (!is_baked_for(sun, frame.ignore_alpha))
            bake_for(frame.scene, sun, frame.ignore_alpha, progress);
        bake::LightOnPath light;
        const DVec3 along = glm::cross(baked_->through.path.pole_ws, glm::normalize(to_light));
        if (glm::length(along) > 0.0) {  // else it stands still, and has neither
            light.along_ws = glm::normalize(along);
            light.across_ws = glm::cross(glm::normalize(to_light), light.along_ws);
        }
        light.window = {.at_step = bake::step_on(baked_->through, to_light, kOnCircle_rad),
                        .width_steps = static_cast<double>(sun.angular_diameter_rad) *
                                       baked_->through.steps_per_rad,
                        .codes_per_step = codes_per_step(bits()),
                        .even = options_.weight == Weight::even};
        parallel_for(
            receivers.size(), kReceiversPerTask,
            [&](std::size_t first, std::size_t last) {
                for (std::size_t i = first; i < last; ++i) {
                    if (!receivers[i].exists()) continue;
                    const lightmap::Facet* facet =
                        baked_->finder ? baked_->finder->facet_of(receivers[i]) : nullptr;
                    out[i] = facet == nullptr ? 0.0f
                                              : static_cast<float>(baked_->finder->visibility(
                                                    *facet, receivers[i], options_.lookup, light));
                }
            },
            "looking up intervals", &progress);
    }

    void describe_texels(std::span<const trace::Receiver> receivers,
                         Visibility::Impl& out) override {
        if (!baked_ || !baked_->finder || receivers.empty()) return;
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
        const auto add = [&](const IntervalPage& page, const bake::SamplePlaces& places) {
            bytes += (page.rises.size() + page.falls.size()) * sizeof(std::uint16_t) +
                     places.size() * sizeof(bake::SamplePlace);
        };
        const bake::BakedTexels& texels = baked_->texels;
        for (std::size_t i = 0; i < texels.pages.size(); ++i)
            add(texels.pages[i], texels.places[i]);
        add(texels.fine.samples, texels.fine.places);
        return bytes;
    }

    Options options_;
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
