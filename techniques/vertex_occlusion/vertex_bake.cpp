// Visibility at vertices, once for a light that stands still, and at receivers by interpolation: S.
// Dietrich, "More on Shadowing", developer's journal, GameDev.net, undated.
//
// Departures:
// - A vertex has a value for each triangle that it belongs to and for each of its sides, with that
//   triangle's own normal: edges stay hard, and a light that is behind a face is behind its
//   vertices.
// - The share of light is kept apart from its attenuation, which the lighting computes for each
//   pixel.
// - Receivers take nothing from vertices behind a wall, which are dark within whatever stands on
//   the ground: else a dark hem goes around it, a cell wide, on its lit side.

#include "vertex_bake.h"

#include "base/parallel.h"
#include "trace/light_sample.h"
#include "visibility/vertex_walls.h"

#include <algorithm>
#include <cassert>

namespace gnomon::vertex_occlusion {

namespace {

using trace::Receiver;
using trace::Triangle;
using vertex_grid::GridCell;

/// Vertices that are traced together: enough for all threads, few enough that what they are traced
/// from takes some megabytes.
constexpr std::uint64_t kBatchVertices = 1 << 17;
constexpr std::size_t kTrianglesPerTask = 256;

/// Apart from the truth's seed, and from that of other techniques' rays.
constexpr unsigned kFirstSeed = 3;

/// Tells of a part of a task as of the whole.
class PartProgress final : public Progress {
public:
    PartProgress(Progress& whole, std::uint64_t done, std::uint64_t part, std::uint64_t all)
        : whole_(whole),
          begin_(static_cast<double>(done) / static_cast<double>(all)),
          share_(static_cast<double>(part) / static_cast<double>(all)) {}
    void report(std::string_view, double fraction) override {
        whole_.report("baking vertices", begin_ + share_ * fraction);
    }
    bool cancelled() const override { return whole_.cancelled(); }

private:
    Progress& whole_;
    double begin_, share_;
};

/// The vertices of a triangle as receivers; none where no part of the light is above their side.
void add_vertices(const Scene& scene, const TriangleGrid& grid, bool front, const Light& light,
                  std::span<Receiver> out) {
    vertex_grid::place_vertices(scene, grid, front, out);
    for (Receiver& vertex : out) {
        if (!trace::faces_light(vertex, light)) vertex = {};
    }
}

/// A receiver whose vertices differ.
struct Mixed {
    std::size_t index = 0;  ///< among the receivers
    DVec3 weights{0.0};
    std::array<float, 3> values{};
};

/// The mean of what vertices hold by their weights; 0 when none holds anything.
float mean(const std::array<float, 3>& values, DVec3 weights) {
    double sum = 0.0, all = 0.0;
    for (int k = 0; k < 3; ++k) {
        if (values[k] == VertexBake::kUnlit) continue;
        sum += weights[k] * static_cast<double>(values[k]);
        all += weights[k];
    }
    return all > 0.0 ? static_cast<float>(std::min(sum / all, 1.0)) : 0.0f;
}

/// The same of those vertices alone that are seen; of all when that leaves none.
float mean_of_seen(const Mixed& mixed, std::span<const std::uint8_t> hidden) {
    std::array<float, 3> seen = mixed.values;
    double all = 0.0;
    for (int k = 0; k < 3; ++k) {
        if (hidden[k] != 0) seen[k] = VertexBake::kUnlit;
        if (seen[k] != VertexBake::kUnlit) all += mixed.weights[k];
    }
    return mean(all > 0.0 ? seen : mixed.values, mixed.weights);
}

bool differ(const std::array<float, 3>& values) {
    return values[0] != values[1] || values[0] != values[2];
}

}  // namespace

VertexBake::VertexBake(const Scene& scene, const SceneGrid& grid, const trace::Tracer& tracer,
                       const Light& light, int samples, Progress& progress) {
    for (const bool front : {true, false})
        trace_side(scene, grid, tracer, light, samples, front, progress);
}

void VertexBake::trace_side(const Scene& scene, const SceneGrid& grid, const trace::Tracer& tracer,
                            const Light& light, int samples, bool front, Progress& progress) {
    const std::span<const TriangleGrid> triangles = grid.triangles();
    const std::uint64_t all = grid.vertex_count();
    std::vector<float>& values = values_[front ? 0 : 1];
    values.assign(all, kUnlit);
    std::vector<Receiver> vertices;
    unsigned seed = kFirstSeed;
    for (std::size_t first = 0, last = 0; first < triangles.size(); first = last, ++seed) {
        const std::uint64_t begin = triangles[first].first;
        std::uint64_t end = begin;
        for (; last < triangles.size() && (end == begin || end - begin < kBatchVertices); ++last)
            end = triangles[last].first + vertex_grid::vertex_count(triangles[last].parts);
        vertices.assign(end - begin, {});
        parallel_for(last - first, kTrianglesPerTask, [&](std::size_t from, std::size_t to) {
            for (const TriangleGrid& triangle : triangles.subspan(first + from, to - from)) {
                add_vertices(
                    scene, triangle, front, light,
                    std::span(vertices).subspan(triangle.first - begin,
                                                vertex_grid::vertex_count(triangle.parts)));
            }
        });
        PartProgress part(progress, (front ? 0 : all) + begin, end - begin, 2 * all);
        tracer.visibility(vertices, {static_cast<unsigned>(end - begin), 1}, light, samples, seed,
                          std::span(values).subspan(begin, end - begin), part);
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            if (!vertices[i].exists()) values[begin + i] = kUnlit;
        }
    }
}

std::uint64_t VertexBake::memory_bytes() const {
    return (values_[0].size() + values_[1].size()) * sizeof(float);
}

void VertexLookup::look_up(std::span<const Receiver> receivers, std::span<float> out) const {
    std::vector<Mixed> mixed;
    std::vector<vertex_grid::CornerRays> rays;
    for (std::size_t index = 0; index < receivers.size(); ++index) {
        const Receiver& receiver = receivers[index];
        if (!trace::faces_light(receiver, light_)) {
            out[index] = receiver.exists() ? 0.0f : 1.0f;
            continue;
        }
        const Triangle triangle = trace::world_triangle(scene_, receiver.id);
        const TriangleGrid& grid = grid_.of(receiver.id);
        const DVec3 normal_ws(receiver.normal_ws);
        const DVec3 p_ws(receiver.position_ws);
        const bool front = glm::dot(triangle.front_normal_ws(), normal_ws) > 0.0;
        const GridCell cell = vertex_grid::cell_at(grid.parts, triangle.barycentric(p_ws));
        std::array<float, 3> values{};
        for (int k = 0; k < 3; ++k) {
            values[k] = bake_.value(
                front, grid.first + vertex_grid::vertex_index(grid.parts, cell.vertices[k]));
        }
        out[index] = mean(values, cell.weights);
        if (!walls_ || !differ(values)) continue;
        mixed.push_back({index, cell.weights, values});
        rays.push_back(vertex_grid::corner_rays(receiver, triangle, grid, cell));
    }
    const auto hidden = vertex_grid::hidden_corners(tracer_, rays);
    for (std::size_t i = 0; i < mixed.size(); ++i)
        out[mixed[i].index] = mean_of_seen(mixed[i], hidden[i]);
}

}  // namespace gnomon::vertex_occlusion
