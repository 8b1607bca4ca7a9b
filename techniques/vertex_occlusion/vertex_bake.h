#pragma once

#include <gnomon/light.h>
#include <gnomon/progress.h>

#include "trace/tracer.h"
#include "visibility/vertex_grid.h"

#include <array>
#include <span>
#include <vector>

namespace gnomon::vertex_occlusion {

using vertex_grid::SceneGrid;
using vertex_grid::TriangleGrid;

/// Visibility of one light at the vertices of a scene's grid, on both sides of each triangle.
class VertexBake {
public:
    VertexBake() = default;
    /// Traces as Tracer::visibility() does, `samples` rays a vertex for lights with extent. Throws
    /// Error{cancelled}.
    VertexBake(const Scene& scene, const SceneGrid& grid, const trace::Tracer& tracer,
               const Light& light, int samples, Progress& progress);

    /// What a vertex holds whose side of the triangle sees nothing of the light, even if nothing
    /// were in the way.
    static constexpr float kUnlit = -1.0f;

    /// Visibility at a vertex, on the side of its triangle's front or of its back, or kUnlit.
    float value(bool front, std::uint64_t vertex) const { return values_[front ? 0 : 1][vertex]; }
    std::uint64_t memory_bytes() const;

private:
    void trace_side(const Scene& scene, const SceneGrid& grid, const trace::Tracer& tracer,
                    const Light& light, int samples, bool front, Progress& progress);

    std::array<std::vector<float>, 2> values_;  ///< front, back
};

/// What the receivers of a picture take from the vertices around them.
class VertexLookup {
public:
    /// `walls`: a receiver takes nothing from a vertex that something stands before.
    VertexLookup(const Scene& scene, const SceneGrid& grid, const VertexBake& bake,
                 const trace::Tracer& tracer, const Light& light, bool walls)
        : scene_(scene), grid_(grid), bake_(bake), tracer_(tracer), light_(light), walls_(walls) {}

    /// Visibility at receivers [first, last), on the calling thread.
    void look_up(std::span<const trace::Receiver> receivers, std::span<float> out) const;

private:
    const Scene& scene_;
    const SceneGrid& grid_;
    const VertexBake& bake_;
    const trace::Tracer& tracer_;
    const Light& light_;
    bool walls_;
};

}  // namespace gnomon::vertex_occlusion
