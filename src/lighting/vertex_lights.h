#pragma once

#include <gnomon/vertex_lighting.h>

#include "lighting/lighting.shared.h"
#include "trace/receiver.h"
#include "visibility/vertex_walls.h"

#include <array>
#include <span>
#include <vector>

namespace gnomon {

class VertexLighting::Impl {
public:
    Impl(const Scene& scene, std::span<const Light> lights, const VertexLightingOptions& options,
         Progress& progress);

    const Scene& scene() const { return scene_; }
    const vertex_grid::SceneGrid& grid() const { return grid_; }
    std::uint64_t memory_bytes() const;

    /// Throws Error{input} when they are not those that were traced, or stronger.
    void check(std::span<const Light> lights) const;

    /// What each receiver takes from the vertices of its cell, by the strengths of `lights`.
    std::vector<shared::VertexShade> at(std::span<const trace::Receiver> receivers,
                                        std::span<const Light> lights) const;

private:
    /// What a receiver takes from each corner of its cell.
    struct Corners;
    Corners corners(const trace::Receiver& receiver, const trace::Triangle& triangle,
                    const vertex_grid::GridCell& cell, std::span<const Vec3> strengths) const;
    void shade(std::span<const trace::Receiver> receivers, std::span<const Vec3> strengths,
               std::span<shared::VertexShade> out) const;

    Scene scene_;
    trace::Tracer tracer_;
    vertex_grid::SceneGrid grid_;
    std::vector<Light> lights_;
    /// Of fronts and backs, of each light, of each vertex of the grid.
    std::array<std::vector<std::vector<VertexLight>>, 2> seen_;
    float full_luminance_ = 1.0f;
    bool walls_ = true;
};

}  // namespace gnomon
