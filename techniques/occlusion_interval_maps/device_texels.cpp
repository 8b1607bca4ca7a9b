#include "device_texels.h"

#include "bake/interval_codes.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <span>

namespace gnomon::occlusion_interval_maps {

namespace {

using shared::kNone;

constexpr std::size_t kSides = 2;  // front, back

std::vector<std::uint32_t> facet_numbers(const Scene& scene, const lightmap::Atlas& atlas) {
    std::vector<std::uint32_t> numbers(scene.instances().size());
    for (std::size_t i = 0; i < scene.instances().size(); ++i) {
        const Mesh& mesh = scene.meshes()[scene.instances()[i].mesh];
        numbers[i] = static_cast<std::uint32_t>(numbers.size());
        numbers.insert(numbers.end(), kSides * mesh.triangles.size(), kNone);
    }
    for (const lightmap::PlacedTriangle& placed : atlas.triangles) {
        const lightmap::Chart& chart = atlas.charts[atlas.facets[placed.facet].chart];
        const std::size_t first = numbers[chart.instance] + kSides * placed.triangle;
        numbers[first + (placed.back ? 1 : 0)] = placed.facet;
    }
    return numbers;
}

shared::PageFacet page_facet(const lightmap::Atlas& atlas, const lightmap::Facet& facet) {
    const glm::dvec2 place = atlas.triangles[facet.first_triangle].corners_texels[0];
    return {.normal_ws = Vec3(facet.normal_ws),
            .point_ws = Vec3(facet.point_ws(place)),
            .place_texels = glm::vec2(place),
            .u_ws = Vec3(facet.u_ws),
            .v_ws = Vec3(facet.v_ws),
            .chart = facet.chart};
}

/// Adds the texels of pages one by one.
class TexelPacker {
public:
    explicit TexelPacker(PackedTexels& out) : out_(out) {}

    void add(const IntervalPage& page, std::size_t texel, bake::SamplePlace place) {
        const std::size_t first = out_.intervals.size();
        const std::size_t most =
            IntervalPage::kIntervalsPerPair * static_cast<std::size_t>(page.pairs);
        for (std::size_t i = 0; i < most; ++i) {
            const std::size_t at = bake::value_index(page, texel, i);
            if (page.rises[at] == IntervalPage::kNoRise) break;
            out_.intervals.push_back(page.rises[at] | std::uint32_t{page.falls[at]} << 16);
        }
        const std::span<const std::uint32_t> all(out_.intervals);
        if (std::ranges::equal(all.subspan(first), all.subspan(last_, first - last_))) {
            out_.intervals.resize(first);  // neighbours are often alike: wholly lit, wholly dark
        } else {
            last_ = first;
        }
        const auto byte = [](std::int8_t v) { return std::uint32_t{static_cast<std::uint8_t>(v)}; };
        out_.texels.push_back(
            {.first_interval = static_cast<std::uint32_t>(last_),
             .count_and_place = static_cast<std::uint32_t>(out_.intervals.size() - last_) |
                                byte(place.x) << shared::kCountBits |
                                byte(place.y) << (shared::kCountBits + shared::kPlaceBits)});
    }

private:
    PackedTexels& out_;
    std::size_t last_ = 0;  ///< the first interval of the texel before
};

/// The cells of a chart, or nothing when it has no fine ones. `first_sample`: of all, in texels.
void add_cells(const bake::FineCells& fine, std::uint32_t number, const lightmap::Chart& chart,
               std::uint32_t first_sample, PackedTexels& out) {
    const std::size_t first = out.first_samples.size();
    bool any = false;
    for (unsigned y = 0; y <= chart.size.height; ++y) {
        for (unsigned x = 0; x <= chart.size.width; ++x) {
            const auto cell = fine.find(number, static_cast<int>(chart.x + x) - 1,
                                        static_cast<int>(chart.y + y) - 1);
            out.first_samples.push_back(cell ? first_sample + *cell : kNone);
            any = any || cell;
        }
    }
    if (any) {
        out.charts[number].first_cell = static_cast<std::uint32_t>(first);
    } else {
        out.first_samples.resize(first);
    }
}

template <typename T>
gpu::Buffer storage(const gpu::Device& device, const std::vector<T>& values) {
    return gpu::make_buffer(device, std::span<const T>(values), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
}

}  // namespace

float FacetTable::texel_size_m(const trace::Receiver& receiver) const {
    const std::size_t first = numbers[receiver.id.instance] + kSides * receiver.id.primitive;
    for (std::size_t side = 0; side < kSides; ++side) {
        if (numbers[first + side] == kNone) continue;
        const shared::PageFacet& facet = facets[numbers[first + side]];
        if (glm::dot(facet.normal_ws, receiver.normal_ws) > 0.0f)
            return std::max(glm::length(facet.u_ws), glm::length(facet.v_ws));
    }
    return 0.0f;
}

PackedTexels pack(const Scene& scene, const bake::BakedTexels& baked) {
    const lightmap::Atlas& atlas = baked.atlas;
    PackedTexels packed;
    packed.facets.numbers = facet_numbers(scene, atlas);
    for (const lightmap::Facet& facet : atlas.facets)
        packed.facets.facets.push_back(page_facet(atlas, facet));
    TexelPacker texels(packed);
    std::vector<std::uint32_t> first_texels;
    for (std::size_t p = 0; p < baked.pages.size(); ++p) {
        first_texels.push_back(static_cast<std::uint32_t>(packed.texels.size()));
        for (std::size_t i = 0; i < baked.places[p].size(); ++i)
            texels.add(baked.pages[p], i, baked.places[p][i]);
    }
    const auto first_sample = static_cast<std::uint32_t>(packed.texels.size());
    for (std::size_t i = 0; i < baked.fine.places.size(); ++i)
        texels.add(baked.fine.samples, i, baked.fine.places[i]);
    for (std::uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const lightmap::Chart& chart = atlas.charts[c];
        packed.charts.push_back({.first_texel = first_texels[chart.page],
                                 .side_texels = baked.pages[chart.page].side_texels,
                                 .least_texel = {chart.x, chart.y},
                                 .size_texels = {chart.size.width, chart.size.height},
                                 .first_cell = kNone});
        if (!baked.fine.places.empty()) add_cells(baked.fine, c, chart, first_sample, packed);
    }
    return packed;
}

DeviceTexels::DeviceTexels(const gpu::Device& device, const PackedTexels& packed)
    : facet_numbers(storage(device, packed.facets.numbers)),
      facets(storage(device, packed.facets.facets)),
      charts(storage(device, packed.charts)),
      first_samples(storage(device, packed.first_samples)),
      texels(storage(device, packed.texels)),
      intervals(storage(device, packed.intervals)) {}

void DeviceTexels::use(gpu::Commands& commands) {
    for (gpu::Buffer* buffer :
         {&facet_numbers, &facets, &charts, &first_samples, &texels, &intervals})
        commands.use(*buffer, gpu::Use::storage_read);
}

std::uint64_t DeviceTexels::memory_bytes() const {
    return facet_numbers.memory_bytes() + facets.memory_bytes() + charts.memory_bytes() +
           first_samples.memory_bytes() + texels.memory_bytes() + intervals.memory_bytes();
}

}  // namespace gnomon::occlusion_interval_maps
