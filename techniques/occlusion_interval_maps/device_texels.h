#pragma once

#include "bake/baked_texels.h"
#include "gpu/commands.h"
#include "occlusion_interval_maps.shared.h"

#include <cstdint>
#include <vector>

namespace gnomon::occlusion_interval_maps {

/// Which facet each side of each triangle is on.
struct FacetTable {
    /// For each instance where its triangles begin here; then for each of these the facets of its
    /// front and its back, or kNone.
    std::vector<std::uint32_t> numbers;
    std::vector<shared::PageFacet> facets;

    /// Of the texels that a receiver is on; 0 when there are none.
    float texel_size_m(const trace::Receiver& receiver) const;
};

/// Baked texels as occlusion_interval_maps.comp.glsl reads them. Of intervals each texel has as
/// many as it needs, where pages have room for the most that any has.
struct PackedTexels {
    FacetTable facets;
    std::vector<shared::PageChart> charts;
    std::vector<std::uint32_t> first_samples;  ///< of each cell of charts that have fine ones
    std::vector<shared::LitTexel> texels;      ///< of the pages; then samples of fine cells
    std::vector<std::uint32_t> intervals;      ///< rise, and fall in the upper half
};

PackedTexels pack(const Scene& scene, const bake::BakedTexels& baked);

/// The same on the device.
struct DeviceTexels {
    DeviceTexels() = default;
    DeviceTexels(const gpu::Device& device, const PackedTexels& packed);
    void use(gpu::Commands& commands);
    std::uint64_t memory_bytes() const;

    gpu::Buffer facet_numbers, facets, charts, first_samples, texels, intervals;
};

}  // namespace gnomon::occlusion_interval_maps
