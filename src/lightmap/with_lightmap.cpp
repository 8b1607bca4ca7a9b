#include "lightmap/atlas.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>

namespace gnomon::lightmap {

namespace {

/// The part of an instance that is on one page: a mesh with vertices of its own.
class PageMesh {
public:
    PageMesh(const Mesh& source, std::uint32_t material) : source_(source) {
        mesh_.material = material;
    }

    void add(const PlacedTriangle& placed, std::uint32_t chart, unsigned page_side) {
        const UVec3 corners = source_.triangles[placed.triangle];
        UVec3 triangle(0);
        for (int i = 0; i < 3; ++i) {
            // Seen from the back the corners run the other way round.
            const int corner = placed.back && i > 0 ? 3 - i : i;
            const dvec2 uv = placed.corners_texels[static_cast<std::size_t>(corner)] /
                             static_cast<double>(page_side);
            triangle[i] = vertex(corners[corner], chart, placed.back, Vec2(uv));
        }
        mesh_.triangles.push_back(triangle);
    }

    Mesh take(std::string name) {
        mesh_.name = std::move(name);
        return std::move(mesh_);
    }

private:
    std::uint32_t vertex(std::uint32_t source, std::uint32_t chart, bool back, Vec2 uv) {
        const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
        // A chart may hold a vertex at two places, if its coordinates are the mesh's own.
        const auto [entry, is_new] = vertices_.try_emplace({source, chart, back, uv.x, uv.y}, next);
        if (!is_new) return entry->second;
        const auto copy = [&](auto& to, const auto& from) {
            if (!from.empty()) to.push_back(from[source]);
        };
        copy(mesh_.positions, source_.positions);
        copy(mesh_.normals, source_.normals);
        copy(mesh_.texcoords, source_.texcoords);
        copy(mesh_.colors, source_.colors);
        if (back && !mesh_.normals.empty()) mesh_.normals.back() = -mesh_.normals.back();
        mesh_.lightmap_texcoords.push_back(uv);
        return next;
    }

    const Mesh& source_;
    Mesh mesh_;
    std::map<std::tuple<std::uint32_t, std::uint32_t, bool, float, float>, std::uint32_t> vertices_;
};

class Rewriter {
public:
    Rewriter(const Scene& scene, const Atlas& atlas)
        : scene_(scene), atlas_(atlas), charts_(scene.instances().size()) {
        for (std::uint32_t c = 0; c < atlas.charts.size(); ++c)
            charts_[atlas.charts[c].instance].push_back(c);
    }

    SceneData run() && {
        data_ = scene_.data();
        data_.meshes.clear();
        data_.instances.clear();
        for (std::uint32_t i = 0; i < charts_.size(); ++i)
            add_instance(i);
        return std::move(data_);
    }

private:
    std::span<const PlacedTriangle> triangles(const Chart& chart) const {
        return {atlas_.triangles.data() + chart.first_triangle, chart.triangle_count};
    }

    void add_instance(std::uint32_t index) {
        const Instance& instance = scene_.instances()[index];
        const Mesh& mesh = scene_.meshes()[instance.mesh];
        const std::uint32_t material = has_backs(index) ? one_sided(mesh.material) : mesh.material;
        std::map<std::uint32_t, PageMesh> pages;
        for (const std::uint32_t c : charts_[index]) {
            const Chart& chart = atlas_.charts[c];
            PageMesh& part = pages.try_emplace(chart.page, mesh, material).first->second;
            for (const PlacedTriangle& placed : triangles(chart))
                part.add(placed, c, atlas_.page_sides_texels[chart.page]);
        }
        for (auto& [page, part] : pages) {
            Instance copy = instance;
            copy.mesh = static_cast<std::uint32_t>(data_.meshes.size());
            data_.instances.push_back(std::move(copy));
            data_.meshes.push_back(part.take(atlas_.page_sides_texels.size() == 1
                                                 ? mesh.name
                                                 : fmt::format("{}, page {}", mesh.name, page)));
        }
    }

    bool has_backs(std::uint32_t instance) const {
        for (const std::uint32_t c : charts_[instance]) {
            for (const PlacedTriangle& placed : triangles(atlas_.charts[c])) {
                if (placed.back) return true;
            }
        }
        return false;
    }

    /// A copy of the material that shows fronts only; made once.
    std::uint32_t one_sided(std::uint32_t material) {
        const auto next = static_cast<std::uint32_t>(data_.materials.size());
        const auto [entry, is_new] = one_sided_.try_emplace(material, next);
        if (is_new) {
            Material copy = data_.materials[material];
            copy.double_sided = false;
            data_.materials.push_back(std::move(copy));
        }
        return entry->second;
    }

    const Scene& scene_;
    const Atlas& atlas_;
    std::vector<std::vector<std::uint32_t>> charts_;  // of each instance
    std::map<std::uint32_t, std::uint32_t> one_sided_;
    SceneData data_;
};

}  // namespace

Scene with_lightmap(const Scene& scene, const Atlas& atlas) {
    return Scene(Rewriter(scene, atlas).run());
}

// As Rewriter adds meshes: by instance, by page.
std::vector<std::uint32_t> lightmapped_pages(const Scene& scene, const Atlas& atlas) {
    std::vector<std::set<std::uint32_t>> pages(scene.instances().size());
    for (const Chart& chart : atlas.charts)
        pages[chart.instance].insert(chart.page);
    std::vector<std::uint32_t> result;
    for (const std::set<std::uint32_t>& of_instance : pages)
        result.insert(result.end(), of_instance.begin(), of_instance.end());
    return result;
}

}  // namespace gnomon::lightmap
