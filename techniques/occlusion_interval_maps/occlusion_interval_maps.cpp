// Occlusion interval maps: each texel of the scene knows when, on the sun's way of a day, it sees
// the sun's centre; a sun with extent is the part of its way that it covers. W. Donnelly, J.
// Demers, "Generating Soft Shadows Using Occlusion Interval Maps", GPU Gems, 2004, chapter 13.
// Departures: intervals come from one traversal for a tile of texels (src/interval) instead of 256
// rays for each, and their ends from rays between steps; receivers move the edges of shadows of
// their four texels to their own time, not take the nearest texel's; where the four have not the
// same edges there are finer samples; and moments count by the height of the sun's disc there, not
// alike. Baked on the host, looked up on the device.

#include "bake/baked_texels.h"
#include "bake/circle_path.h"
#include "bake/lookup.shared.h"
#include "bake/path_place.h"
#include "bake/stored_texels.h"
#include "base/check.h"
#include "device_texels.h"
#include "lightmap/surface.h"
#include "occlusion_interval_maps.comp.spv.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace gnomon {

const TechniqueInfo& occlusion_interval_maps_info();

namespace {

namespace shared = occlusion_interval_maps::shared;
using occlusion_interval_maps::DeviceTexels;
using occlusion_interval_maps::FacetTable;

/// A light this near to the baked circle is on it: a tenth of the sun's radius.
constexpr double kOnCircle_rad = 5e-4;
constexpr unsigned kGroupSize = 8;
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

std::uint32_t bits_of(const PathEnds& ends) {
    return (ends.closed ? bake::shared::kClosed : 0u) |
           (ends.begins_up ? bake::shared::kBeginsUp : 0u) |
           (ends.ends_up ? bake::shared::kEndsUp : 0u);
}

gpu::Pipeline lookup_pipeline(const gpu::Device& device, const Options& options) {
    using enum gpu::BindingType;
    return gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .code = shaders::occlusion_interval_maps_comp,
                    .layout = {{storage_image, storage_image, storage_buffer, storage_buffer,
                                storage_buffer, storage_buffer, storage_buffer, storage_buffer,
                                storage_buffer, storage_buffer, storage_buffer, storage_buffer},
                               sizeof(shared::LookupPush)},
                    .constants = {static_cast<std::uint32_t>(options.lookup),
                                  options.weight == Weight::even ? VK_TRUE : VK_FALSE}});
}

class OcclusionIntervalMaps final : public GpuTechnique {
public:
    OcclusionIntervalMaps(Context& context, const Options& options)
        : GpuTechnique(context, occlusion_interval_maps_info()),
          options_(options),
          lookup_(lookup_pipeline(context.impl().device(), options)) {}

    /// For a bake that is there.
    OcclusionIntervalMaps(Context& context, const Options& options, const IntervalBake& bake)
        : OcclusionIntervalMaps(context, options) {
        stored_ = bake.scene;
        options_.bits = bake.bits == BakeBits::eight ? TimeBits::eight : TimeBits::sixteen;
        baked_ = std::make_unique<Baked>();
        baked_->through = {.path = bake.path,
                           .steps_per_rad = bake::steps_per_rad(bake.path),
                           .ends = path_ends(bake.path)};
        upload(bake.scene, bake::stored_texels(bake), *baked_);
    }

private:
    /// What is baked, for lights on one path.
    struct Baked {
        bake::PathThrough through;
        bool ignore_alpha = false;
        int path_codes = 0;
        int fine_parts = 1;
        std::string warning;  ///< of what the bake lost
        DeviceTexels device;
        std::shared_ptr<const FacetTable> facets;  ///< visibilities may outlive the bake
    };

    void prepare_scene(const Scene& scene, Progress& progress) override {
        if (stored_) require_baked(scene);
        GpuTechnique::prepare_scene(scene, progress);
        if (stored_) return;
        baked_ = nullptr;
        for (const Light& light : scene.lights()) {
            if (const auto* sun = std::get_if<DirectionalLight>(&light)) {
                bake_for(scene, *sun, false, progress);
                return;
            }
        }
    }

    void require_baked(const Scene& scene) const {
        if (same(scene.identity(), stored_->identity())) return;
        fail_input(
            "occlusion_interval_maps: frame.scene is \"{}\"; it must be the bake's own, \"{}\"",
            scene.source(), stored_->source());
    }

    void prepare_light(const Frame& frame, Progress& progress) override {
        const auto& sun = std::get<DirectionalLight>(frame.light);
        if (stored_) {
            at_ = stored_place(sun);
            return;
        }
        if (!is_baked_for(sun, frame.ignore_alpha))
            bake_for(frame.scene, sun, frame.ignore_alpha, progress);
        at_ = circle_place(sun);
    }

    bake::PathPlace stored_place(const DirectionalLight& sun) const {
        const std::optional<bake::PathPlace> place =
            bake::place_on(baked_->through.path, DVec3(sun.to_light_ws), kOnCircle_rad);
        if (place) return *place;
        const Vec3 to = sun.to_light_ws;
        fail_input(
            "occlusion_interval_maps: light \"{}\": to_light_ws is {}, {}, {}, which is not on the "
            "bake's path; light_at() gives what is",
            sun.name, to.x, to.y, to.z);
    }

    bake::PathPlace circle_place(const DirectionalLight& sun) const {
        const DVec3 to_light = glm::normalize(DVec3(sun.to_light_ws));
        bake::PathPlace place{.at_step = bake::step_on(baked_->through, to_light, kOnCircle_rad)};
        const DVec3 along = glm::cross(baked_->through.path.pole_ws, to_light);
        if (glm::length(along) > 0.0) place.along_ws = glm::normalize(along);
        return place;
    }

    /// Times of a stored bake are no finer than a code, and its light no narrower.
    double width_steps(const DirectionalLight& sun) const {
        const auto diameter_rad = static_cast<double>(sun.angular_diameter_rad);
        if (!stored_) return diameter_rad * baked_->through.steps_per_rad;
        return bake::disc_width_steps(baked_->through.path, diameter_rad, codes_per_step(bits()));
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
        bake::BakedTexels texels;
        if (area_m2 > 0.0) {  // else nothing ever faces the light
            texels =
                bake::baked_texels(scene, baked->through.path,
                                   {.texel_size_m = texel_size_m,
                                    .bits = bits(),
                                    .most_pairs = IntervalPage::kMostPairs,
                                    .ignore_alpha = ignore_alpha,
                                    .texel_option = options_.half_resolution
                                                        ? "texel_size, doubled by half_resolution:"
                                                        : "texel_size",
                                    .resume_file = {}},
                                   {.lit_sides_only = true, .fine_parts = fine_parts()}, progress);
        }
        upload(scene, texels, *baked);
        baked_ = std::move(baked);
    }

    void upload(const Scene& scene, const bake::BakedTexels& texels, Baked& out) {
        occlusion_interval_maps::PackedTexels packed = occlusion_interval_maps::pack(scene, texels);
        out.path_codes = texels.path_codes;
        out.fine_parts = texels.fine.parts;
        const std::string closed = closed_gaps_text(texels.report);
        if (!closed.empty()) out.warning = closed + ".";
        out.device = DeviceTexels(context().device(), packed);
        out.facets = std::make_shared<const FacetTable>(std::move(packed.facets));
    }

    shared::LookupPush push(const Frame& frame, const raster::Receivers& receivers) const {
        const auto& sun = std::get<DirectionalLight>(frame.light);
        const DVec3 to_light = glm::normalize(DVec3(sun.to_light_ws));
        const double codes = codes_per_step(bits());
        shared::LookupPush push{.es_from_clip = receivers.eye_from_clip(),
                                .eye_ws = receivers.camera.eye_ws(),
                                .along_ws = Vec3(0.0f),
                                .across_ws = Vec3(0.0f),
                                .at_codes = static_cast<float>(codes * at_.at_step),
                                .width_codes = static_cast<float>(codes * width_steps(sun)),
                                .path_codes = static_cast<float>(baked_->path_codes),
                                .ends = bits_of(baked_->through.ends),
                                .fine_parts = static_cast<std::uint32_t>(baked_->fine_parts),
                                .size = {receivers.size.width, receivers.size.height}};
        // A light that stands still has neither.
        push.along_ws = Vec3(at_.along_ws);
        push.across_ws = Vec3(glm::cross(to_light, at_.along_ws));
        return push;
    }

    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        const gpu::Pass pass(commands, "lookup");
        commands.use(visibility, gpu::Use::storage_write);
        DeviceTexels& texels = baked_->device;
        const raster::GpuScene& scene = input.scene;
        texels.use(commands);
        commands.bind(
            lookup_,
            {gpu::StorageImage{input.receivers.ids.view()}, gpu::StorageImage{visibility.view()},
             gpu::StorageBuffer{&scene.instances()}, gpu::StorageBuffer{&scene.slots()},
             gpu::StorageBuffer{&scene.positions()}, gpu::StorageBuffer{&scene.indices()},
             gpu::StorageBuffer{&texels.facet_numbers}, gpu::StorageBuffer{&texels.facets},
             gpu::StorageBuffer{&texels.charts}, gpu::StorageBuffer{&texels.first_samples},
             gpu::StorageBuffer{&texels.texels}, gpu::StorageBuffer{&texels.intervals}});
        commands.push(lookup_, push(input.frame, input.receivers));
        commands.dispatch(input.frame.size, kGroupSize);
    }

    void describe_texels(const Frame& frame, Visibility::Impl& out) override {
        const float radius_texels = options_.lookup == bake::TexelLookup::nearest ? 0.5f : 1.0f;
        out.set_texels(
            [facets = baked_->facets](const trace::Receiver& receiver) {
                return facets->texel_size_m(receiver);
            },
            radius_texels, frame);
    }

    std::uint64_t memory_bytes() const override {
        return baked_ ? baked_->device.memory_bytes() : 0;
    }

    std::string warning() const override { return baked_->warning; }

    Options options_;
    gpu::Pipeline lookup_;
    std::unique_ptr<Baked> baked_;
    std::optional<Scene> stored_;  ///< of a bake that is there, which is never made anew
    bake::PathPlace at_;           ///< of the frame's light
};

/// How maps are looked up; the others say how they are baked.
constexpr std::array<std::string_view, 2> kLookupParams{"lookup", "weight"};

}  // namespace

const TechniqueInfo& occlusion_interval_maps_info() {
    static const TechniqueInfo info{
        .name = "occlusion_interval_maps",
        .title = "Occlusion interval maps",
        .source = "donnelly2004",
        .lights = LightKinds::directional,
        .penumbra = Penumbra::physical,
        .lookup_params = kLookupParams,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<OcclusionIntervalMaps>(context, param_table().options(params));
        }};
    return info;
}

std::unique_ptr<Technique> make_technique(Context& context, const IntervalBake& bake,
                                          const Params& params) {
    const std::string_view technique = occlusion_interval_maps_info().name;
    for (const auto& [name, value] : params.values()) {
        const ParamInfo& info = find_param(technique, param_table().infos(), name);
        if (std::ranges::count(kLookupParams, info.name) > 0) continue;
        fail_input("{}: {}: is the bake's own; of one that is there these can be set: {}",
                   technique, info.name, fmt::join(kLookupParams, ", "));
    }
    return std::make_unique<OcclusionIntervalMaps>(context, param_table().options(params), bake);
}

}  // namespace gnomon
