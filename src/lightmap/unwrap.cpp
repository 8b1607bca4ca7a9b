#include "lightmap/unwrap.h"

#include "base/check.h"
#include "lightmap/charts.h"
#include "lightmap/texcoords.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace gnomon::lightmap {

namespace {

/// A facet's map may miss its triangles' corners by this part of a texel: a hundredth is less than
/// the texel's own uncertainty, and more than float's rounding of the corners.
constexpr double kOffFacet_texels = 0.01;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class Unwrapper {
public:
    Unwrapper(const Scene& scene, std::uint32_t instance, int set, const Options& options)
        : mesh_(scene.meshes()[scene.instances()[instance].mesh]),
          instance_(instance),
          set_(set),
          options_(options),
          surface_(scene, instance, options.back_sides, options.to_light_ws),
          corners_(surface_.faces().size()),
          facet_of_face_(surface_.faces().size(), kNone),
          chart_of_face_(surface_.faces().size(), kNone) {}

    Unwrapped run() && {
        if (set_ < 0) {
            make_charts();
        } else {
            keep_charts();
        }
        return std::move(out_);
    }

private:
    void make_charts() {
        const ChartLimits limits = chart_limits(options_);
        std::vector<std::uint32_t> wanted(surface_.faces().size());
        std::iota(wanted.begin(), wanted.end(), 0u);
        while (!wanted.empty()) {
            std::vector<std::uint32_t> removed;
            for (GrownChart& chart : grow_charts(surface_, std::move(wanted), limits)) {
                require_on_page(chart);
                const std::vector<std::uint32_t> more =
                    remove_overlaps(chart, flatten(surface_, chart, options_.texel_size_m));
                removed.insert(removed.end(), more.begin(), more.end());
                const FlatChart flat = flatten(surface_, chart, options_.texel_size_m);
                for (std::size_t i = 0; i < chart.faces.size(); ++i)
                    corners_[chart.faces[i]] = flat.corners[i];
                out_.blocks.push_back(
                    {flat.size, static_cast<std::uint32_t>(out_.charts.size()), 1});
                add_chart(chart.faces);
            }
            wanted = std::move(removed);
        }
    }

    /// The fronts as the mesh has them, and the backs, which have the same coordinates, besides.
    void keep_charts() {
        for (const bool back : {false, true}) {
            std::vector<std::uint32_t> indices;
            std::vector<Face> faces;
            for (std::uint32_t f = 0; f < surface_.faces().size(); ++f) {
                if (surface_.faces()[f].back != back) continue;
                indices.push_back(f);
                faces.push_back(surface_.faces()[f]);
            }
            if (faces.empty()) continue;
            const SetLayout layout = lay_out(mesh_, set_, faces, options_.texel_size_m);
            std::map<std::uint32_t, std::vector<std::uint32_t>> islands;
            for (std::size_t i = 0; i < indices.size(); ++i) {
                corners_[indices[i]] = layout.corners[i];
                islands[layout.islands[i]].push_back(indices[i]);
            }
            out_.blocks.push_back({layout.size, static_cast<std::uint32_t>(out_.charts.size()),
                                   static_cast<std::uint32_t>(islands.size())});
            for (auto& [name, island] : islands)
                add_chart(std::move(island));
        }
    }

    void require_on_page(const GrownChart& chart) const {
        const double side_m = chart.size_m.x;
        if (side_m <= max_chart_m(options_)) return;
        fail_input(
            "mesh \"{}\": a triangle of {:.4g} x {:.4g} m is larger than a page of {} texels "
            "of {} m; {} must be at least {:.4g}",
            mesh_.name, side_m, chart.size_m.y, options_.max_page_texels, options_.texel_size_m,
            options_.texel_option, 1.001 * side_m / max_chart_m(options_) * options_.texel_size_m);
    }

    /// Largest first, so that a facet's map is that of its largest triangle.
    void add_chart(std::vector<std::uint32_t> faces) {
        std::ranges::stable_sort(faces, std::greater(),
                                 [&](std::uint32_t f) { return surface_.faces()[f].area_m2; });
        Chart chart{.instance = instance_, .texcoord_set = set_};
        chart.first_facet = static_cast<std::uint32_t>(out_.facets.size());
        chart.first_triangle = static_cast<std::uint32_t>(out_.triangles.size());
        measure(faces, chart);
        const auto index = static_cast<std::uint32_t>(out_.charts.size());
        for (const std::uint32_t face : faces)
            chart_of_face_[face] = index;
        for (const std::uint32_t face : faces) {
            if (facet_of_face_[face] == kNone) grow_facet(face, index);
        }
        chart.facet_count = static_cast<std::uint32_t>(out_.facets.size()) - chart.first_facet;
        chart.triangle_count = static_cast<std::uint32_t>(faces.size());
        out_.charts.push_back(chart);
    }

    void measure(const std::vector<std::uint32_t>& faces, Chart& chart) const {
        int low_x = std::numeric_limits<int>::max();
        int low_y = low_x;
        int high_x = 0;
        int high_y = 0;
        for (const std::uint32_t face : faces) {
            for_touched(corners_[face], [&](int y, int begin, int end) {
                low_x = std::min(low_x, begin);
                high_x = std::max(high_x, end);
                low_y = std::min(low_y, y);
                high_y = std::max(high_y, y + 1);
            });
        }
        chart.x = static_cast<unsigned>(std::max(low_x, 0));
        chart.y = static_cast<unsigned>(std::max(low_y, 0));
        chart.size = {static_cast<unsigned>(high_x) - chart.x,
                      static_cast<unsigned>(high_y) - chart.y};
    }

    void grow_facet(std::uint32_t seed, std::uint32_t chart) {
        Facet facet = facet_of(surface_.faces()[seed], corners_[seed]);
        facet.chart = chart;
        facet.first_triangle = static_cast<std::uint32_t>(out_.triangles.size());
        const auto index = static_cast<std::uint32_t>(out_.facets.size());
        std::vector<std::uint32_t> queue{seed};
        facet_of_face_[seed] = index;
        for (std::size_t i = 0; i < queue.size(); ++i) {
            place(queue[i], index);
            for (int edge = 0; edge < 3; ++edge) {
                for (const std::uint32_t next : surface_.across(queue[i], edge)) {
                    if (chart_of_face_[next] != chart || facet_of_face_[next] != kNone ||
                        !fits(facet, next)) {
                        continue;
                    }
                    facet_of_face_[next] = index;
                    queue.push_back(next);
                }
            }
        }
        facet.triangle_count = static_cast<std::uint32_t>(queue.size());
        out_.facets.push_back(facet);
    }

    bool fits(const Facet& facet, std::uint32_t index) const {
        const Face& face = surface_.faces()[index];
        const double tolerance_m = kOffFacet_texels * options_.texel_size_m;
        for (std::size_t i = 0; i < 3; ++i) {
            const DVec3 expected_ws = facet.point_ws(corners_[index][i]);
            if (!(glm::distance(expected_ws, face.corners_ws[i]) <= tolerance_m)) return false;
        }
        return true;
    }

    void place(std::uint32_t index, std::uint32_t facet) {
        const Face& face = surface_.faces()[index];
        PlacedTriangle placed{.triangle = face.triangle, .facet = facet, .back = face.back};
        for (std::size_t i = 0; i < 3; ++i)
            placed.corners_texels[face.from[i]] = corners_[index][i];
        out_.triangles.push_back(placed);
    }

    const Mesh& mesh_;
    std::uint32_t instance_;
    int set_;
    const Options& options_;
    Surface surface_;
    std::vector<Corners> corners_;  // of each face, in its block
    std::vector<std::uint32_t> facet_of_face_;
    std::vector<std::uint32_t> chart_of_face_;
    Unwrapped out_;
};

}  // namespace

Facet facet_of(const Face& face, const Corners& c) {
    const dvec2 a = c[1] - c[0];
    const dvec2 b = c[2] - c[0];
    const DVec3 a_ws = face.corners_ws[1] - face.corners_ws[0];
    const DVec3 b_ws = face.corners_ws[2] - face.corners_ws[0];
    const double determinant = a.x * b.y - a.y * b.x;
    Facet facet;
    facet.u_ws = (b.y * a_ws - a.y * b_ws) / determinant;
    facet.v_ws = (a.x * b_ws - b.x * a_ws) / determinant;
    facet.origin_ws = face.corners_ws[0] - c[0].x * facet.u_ws - c[0].y * facet.v_ws;
    facet.normal_ws = face.normal_ws;
    return facet;
}

double max_chart_m(const Options& options) {
    return (options.max_page_texels - options.padding_texels) * options.texel_size_m;
}

ChartLimits chart_limits(const Options& options) {
    return {.normal_rad = glm::radians(options.chart_normal_deg),
            .side_m = max_chart_m(options),
            .padding_m = options.padding_texels * options.texel_size_m};
}

Unwrapped unwrap(const Scene& scene, std::uint32_t instance, int texcoord_set,
                 const Options& options) {
    return Unwrapper(scene, instance, texcoord_set, options).run();
}

}  // namespace gnomon::lightmap
