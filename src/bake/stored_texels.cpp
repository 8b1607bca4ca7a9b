#include "bake/stored_texels.h"

#include "base/check.h"
#include "lightmap/surface.h"
#include "lightmap/unwrap.h"

#include <cmath>

namespace gnomon::bake {

namespace {

/// Of the triangle's map a part of a texel² that is float's rounding of places: nothing is seen
/// there.
constexpr double kLeastArea_texels2 = 1e-6;

double doubled_area(const lightmap::Corners& c) {
    const glm::dvec2 a = c[1] - c[0];
    const glm::dvec2 b = c[2] - c[0];
    return std::abs(a.x * b.y - a.y * b.x);
}

std::uint32_t page_of(const IntervalBake& bake, std::uint32_t mesh) {
    if (mesh >= bake.mesh_pages.size() || bake.mesh_pages[mesh] >= bake.pages.size()) {
        fail_input("bake: mesh_pages: mesh {} has no page; there are {} pages and {} meshes", mesh,
                   bake.pages.size(), bake.scene.meshes().size());
    }
    const Mesh& shape = bake.scene.meshes()[mesh];
    if (shape.lightmap_texcoords.size() != shape.positions.size()) {
        fail_input(
            "bake: mesh {} \"{}\" has no TEXCOORD_1, its places on a page: take the scene that was "
            "baked",
            mesh, shape.name);
    }
    return bake.mesh_pages[mesh];
}

/// A chart of all that an instance shows on its page.
void add_instance(const IntervalBake& bake, std::uint32_t instance, lightmap::Atlas& atlas) {
    const std::uint32_t mesh_index = bake.scene.instances()[instance].mesh;
    const Mesh& mesh = bake.scene.meshes()[mesh_index];
    lightmap::Chart chart{.instance = instance, .page = page_of(bake, mesh_index)};
    const unsigned side = bake.pages[chart.page].side_texels;
    chart.size = {side, side};
    chart.first_facet = static_cast<std::uint32_t>(atlas.facets.size());
    chart.first_triangle = static_cast<std::uint32_t>(atlas.triangles.size());
    const auto number = static_cast<std::uint32_t>(atlas.charts.size());
    // A bake's scene has triangles of their own for backs.
    const lightmap::Surface fronts(bake.scene, instance, false);
    for (const lightmap::Face& face : fronts.faces()) {
        const UVec3 vertices = mesh.triangles[face.triangle];
        lightmap::Corners corners, of_mesh;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vec2 uv = mesh.lightmap_texcoords[vertices[face.from[i]]];
            corners[i] = glm::dvec2(uv) * static_cast<double>(side);
            of_mesh[face.from[i]] = corners[i];
        }
        if (doubled_area(corners) < kLeastArea_texels2) continue;
        lightmap::Facet facet = lightmap::facet_of(face, corners);
        facet.chart = number;
        facet.first_triangle = static_cast<std::uint32_t>(atlas.triangles.size());
        facet.triangle_count = 1;
        atlas.triangles.push_back({.triangle = face.triangle,
                                   .facet = static_cast<std::uint32_t>(atlas.facets.size()),
                                   .back = face.back,
                                   .corners_texels = of_mesh});
        atlas.facets.push_back(facet);
    }
    chart.facet_count = static_cast<std::uint32_t>(atlas.facets.size()) - chart.first_facet;
    chart.triangle_count =
        static_cast<std::uint32_t>(atlas.triangles.size()) - chart.first_triangle;
    atlas.charts.push_back(chart);
}

}  // namespace

BakedTexels stored_texels(const IntervalBake& bake) {
    BakedTexels baked;
    baked.path_codes = bake.path.steps() * bake.codes_per_step();
    baked.pages = bake.pages;
    baked.report = bake.report;
    for (const IntervalPage& page : bake.pages) {
        baked.atlas.page_sides_texels.push_back(page.side_texels);
        baked.places.emplace_back(std::size_t{page.side_texels} * page.side_texels);
    }
    for (std::uint32_t i = 0; i < bake.scene.instances().size(); ++i)
        add_instance(bake, i, baked.atlas);
    return baked;
}

}  // namespace gnomon::bake
