// What lights give to the vertices of a scene, and to receivers between them: S. Dietrich, "More on
// Shadowing", developer's journal, GameDev.net, undated. As in the technique vertex_occlusion a
// vertex has a value for each of its triangles and for each side of that, with the triangle's own
// normal; and triangles are cut.

#include "lighting/vertex_lights.h"

#include "base/check.h"
#include "base/parallel.h"
#include "lighting/averaged_light.h"
#include "visibility/light_shape.h"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

using trace::Receiver;
using vertex_grid::TriangleGrid;

constexpr std::size_t kTrianglesPerTask = 256;
constexpr std::size_t kReceiversPerTask = 4096;

void check(const VertexLightingOptions& options) {
    lighting::check_samples(options.samples);
    if (!(options.edge_m >= 0.0 && std::isfinite(options.edge_m)))
        fail_input("vertex lighting: edge_m is {}; it must be 0 or above", options.edge_m);
    if (options.most_vertices == 0)
        fail_input("vertex lighting: most_vertices is 0; it must be 1 or above");
    if (!(options.least_irradiance >= 0.0f && std::isfinite(options.least_irradiance))) {
        fail_input("vertex lighting: least_irradiance is {}; it must be 0 or above",
                   options.least_irradiance);
    }
}

std::vector<Receiver> vertices_of(const Scene& scene, const vertex_grid::SceneGrid& grid,
                                  bool front) {
    std::vector<Receiver> vertices(grid.vertex_count());
    const std::span<const TriangleGrid> triangles = grid.triangles();
    parallel_for(triangles.size(), kTrianglesPerTask, [&](std::size_t first, std::size_t last) {
        for (const TriangleGrid& triangle : triangles.subspan(first, last - first)) {
            vertex_grid::place_vertices(
                scene, triangle, front,
                std::span(vertices).subspan(triangle.first,
                                            vertex_grid::vertex_count(triangle.parts)));
        }
    });
    return vertices;
}

/// Those that the light gives no less than that; others do not exist.
std::vector<Receiver> within_reach(std::vector<Receiver> vertices, const Light& light,
                                   float least_irradiance) {
    if (least_irradiance == 0.0f || std::holds_alternative<DirectionalLight>(light))
        return vertices;
    const Vec3 place_ws(center_ws(light));
    const float reach_m = light_reach_m(light_strength(light), least_irradiance);
    for (Receiver& vertex : vertices) {
        if (glm::distance(vertex.position_ws, place_ws) > reach_m) vertex = {};
    }
    return vertices;
}

/// Tells of a part of a task as of the whole.
class OfAll final : public Progress {
public:
    OfAll(Progress& whole, std::size_t part, std::size_t parts)
        : whole_(whole), part_(static_cast<double>(part)), parts_(static_cast<double>(parts)) {}
    void report(std::string_view task, double fraction) override {
        whole_.report(task, (part_ + fraction) / parts_);
    }
    bool cancelled() const override { return whole_.cancelled(); }

private:
    Progress& whole_;
    double part_, parts_;
};

bool same_cone(const Light& a, const Light& b) {
    const auto* p = std::get_if<SpotLight>(&a);
    const auto* q = std::get_if<SpotLight>(&b);
    return p == nullptr || q == nullptr ||
           (p->direction_ws == q->direction_ws && p->inner_angle_rad == q->inner_angle_rad &&
            p->outer_angle_rad == q->outer_angle_rad);
}

TangentFrame frame_about(Vec3 normal_ws) {
    const Vec3 aside = std::abs(normal_ws.x) < 0.5f ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 tangent_ws = normalize(glm::cross(aside, normal_ws));
    return {tangent_ws, glm::cross(normal_ws, tangent_ws), normal_ws};
}

Vec3 world_from(const TangentFrame& frame, Vec3 v_ts) {
    return v_ts.x * frame.tangent_ws + v_ts.y * frame.bitangent_ws + v_ts.z * frame.normal_ws;
}

/// The mean over vertices that see any light of how bright all is there; 1 without any.
float mean_luminance(std::span<const std::vector<std::vector<VertexLight>>> seen,
                     std::span<const Light> lights) {
    double sum = 0.0;
    std::uint64_t count = 0;
    for (const auto& side : seen) {
        for (std::size_t v = 0; !side.empty() && v < side.front().size(); ++v) {
            double here = 0.0;
            for (std::size_t l = 0; l < lights.size(); ++l) {
                here += static_cast<double>(lighting::luminance(light_strength(lights[l])) *
                                            side[l][v].share);
            }
            sum += here;
            count += here > 0.0 ? 1 : 0;
        }
    }
    return sum > 0.0 ? static_cast<float>(sum / static_cast<double>(count)) : 1.0f;
}

}  // namespace

VertexLighting::Impl::Impl(const Scene& scene, std::span<const Light> lights,
                           const VertexLightingOptions& options, Progress& progress)
    : scene_(scene),
      tracer_(scene, options.ignore_alpha, progress),
      lights_(lights.begin(), lights.end()),
      walls_(options.walls) {
    gnomon::check(options);
    for (const Light& light : lights)
        validate(light);
    grid_ = vertex_grid::SceneGrid(scene, options.edge_m, options.most_vertices);
    for (const bool front : {true, false}) {
        const std::vector<Receiver> vertices = vertices_of(scene, grid_, front);
        std::vector<std::vector<VertexLight>>& side = seen_[front ? 0 : 1];
        for (std::size_t l = 0; l < lights.size(); ++l) {
            OfAll part(progress, (front ? 0 : lights.size()) + l, 2 * lights.size());
            side.push_back(lighting::trace_vertex_light(
                tracer_, within_reach(vertices, lights[l], options.least_irradiance), lights[l],
                options.samples, lighting::kVertexSeed, part));
        }
    }
    full_luminance_ = mean_luminance(seen_, lights_);
}

std::uint64_t VertexLighting::Impl::memory_bytes() const {
    return grid_.memory_bytes() +
           seen_.size() * lights_.size() * grid_.vertex_count() * sizeof(VertexLight);
}

void VertexLighting::Impl::check(std::span<const Light> lights) const {
    if (lights.size() != lights_.size()) {
        fail_input("vertex lighting: {} lights; {} were traced", lights.size(), lights_.size());
    }
    for (std::size_t l = 0; l < lights.size(); ++l) {
        validate(lights[l]);
        const std::string& name = light_name(lights[l]);
        if (!same_place(lights[l], lights_[l]) || !same_cone(lights[l], lights_[l])) {
            fail_input(
                "vertex lighting: light \"{}\" is not as it was traced: trace it where it is",
                name);
        }
        const Vec3 now = light_strength(lights[l]);
        const Vec3 most = light_strength(lights_[l]);
        if (glm::any(glm::greaterThan(now, most))) {
            fail_input(
                "vertex lighting: light \"{}\" has the strength {}, {}, {}; it was traced for at "
                "most {}, {}, {}",
                name, now.x, now.y, now.z, most.x, most.y, most.z);
        }
    }
}

struct VertexLighting::Impl::Corners {
    std::size_t index = 0;  ///< among the receivers
    TangentFrame frame;
    DVec3 weights{0.0};
    std::array<Vec3, 3> irradiances{}, averages_ts{};

    bool differ() const {
        return irradiances[0] != irradiances[1] || irradiances[0] != irradiances[2];
    }
    /// Without the weights of corners that a wall hides, unless that leaves none.
    void leave_out(const std::array<std::uint8_t, 3>& hidden) {
        DVec3 seen = weights;
        for (int k = 0; k < 3; ++k) {
            if (hidden[static_cast<std::size_t>(k)] != 0) seen[k] = 0.0;
        }
        const double sum = seen.x + seen.y + seen.z;
        if (sum > 0.0) weights = seen / sum;
    }
    shared::VertexShade mean() const {
        Vec3 irradiance(0.0f), averaged_ts(0.0f);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto weight = static_cast<float>(weights[static_cast<int>(k)]);
            irradiance += weight * irradiances[k];
            averaged_ts += weight * averages_ts[k];
        }
        // None of the three is below the face: their mean has a length.
        return {.irradiance = irradiance, .averaged_ws = world_from(frame, normalize(averaged_ts))};
    }
};

VertexLighting::Impl::Corners VertexLighting::Impl::corners(const Receiver& receiver,
                                                            const trace::Triangle& triangle,
                                                            const vertex_grid::GridCell& cell,
                                                            std::span<const Vec3> strengths) const {
    const TriangleGrid& grid = grid_.of(receiver.id);
    const bool front = glm::dot(triangle.front_normal_ws(), DVec3(receiver.normal_ws)) > 0.0;
    Corners corners{.frame = frame_about(receiver.normal_ws), .weights = cell.weights};
    std::vector<StrongVertexLight> lights(strengths.size());
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint64_t vertex =
            grid.first + vertex_grid::vertex_index(grid.parts, cell.vertices[k]);
        for (std::size_t l = 0; l < lights.size(); ++l)
            lights[l] = {seen_[front ? 0 : 1][l][vertex], strengths[l]};
        corners.irradiances[k] = vertex_irradiance(lights, receiver.normal_ws);
        corners.averages_ts[k] = averaged_light_ts(lights, corners.frame, full_luminance_);
    }
    return corners;
}

void VertexLighting::Impl::shade(std::span<const Receiver> receivers,
                                 std::span<const Vec3> strengths,
                                 std::span<shared::VertexShade> out) const {
    std::vector<Corners> mixed;
    std::vector<vertex_grid::CornerRays> rays;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const Receiver& receiver = receivers[i];
        if (!receiver.exists()) continue;
        const trace::Triangle triangle = trace::world_triangle(scene_, receiver.id);
        const TriangleGrid& grid = grid_.of(receiver.id);
        const vertex_grid::GridCell cell =
            vertex_grid::cell_at(grid.parts, triangle.barycentric(DVec3(receiver.position_ws)));
        Corners found = corners(receiver, triangle, cell, strengths);
        out[i] = found.mean();
        if (!walls_ || !found.differ()) continue;
        found.index = i;
        mixed.push_back(found);
        rays.push_back(vertex_grid::corner_rays(receiver, triangle, grid, cell));
    }
    const auto hidden = vertex_grid::hidden_corners(tracer_, rays);
    for (std::size_t i = 0; i < mixed.size(); ++i) {
        mixed[i].leave_out(hidden[i]);
        out[mixed[i].index] = mixed[i].mean();
    }
}

std::vector<shared::VertexShade> VertexLighting::Impl::at(std::span<const Receiver> receivers,
                                                          std::span<const Light> lights) const {
    std::vector<Vec3> strengths;
    for (const Light& light : lights)
        strengths.push_back(light_strength(light));
    std::vector<shared::VertexShade> shades(receivers.size());
    parallel_for(receivers.size(), kReceiversPerTask, [&](std::size_t first, std::size_t last) {
        shade(receivers.subspan(first, last - first), strengths,
              std::span(shades).subspan(first, last - first));
    });
    return shades;
}

VertexLighting::VertexLighting(const Scene& scene, std::span<const Light> lights,
                               const VertexLightingOptions& options, Progress& progress)
    : impl_(std::make_unique<Impl>(scene, lights, options, progress)) {}
VertexLighting::~VertexLighting() = default;
VertexLighting::VertexLighting(VertexLighting&&) noexcept = default;
VertexLighting& VertexLighting::operator=(VertexLighting&&) noexcept = default;

std::uint64_t VertexLighting::vertices() const {
    return impl_->grid().vertex_count();
}

double VertexLighting::edge_m() const {
    return impl_->grid().edge_m();
}

std::uint64_t VertexLighting::memory_bytes() const {
    return impl_->memory_bytes();
}

}  // namespace gnomon
