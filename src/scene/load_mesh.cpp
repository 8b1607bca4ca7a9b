#include "scene/load_mesh.h"

#include "scene/load_draft.h"

#include <algorithm>
#include <cmath>

namespace gnomon::scene {

namespace {

// Below it the direction of a float vector is rounding; also catches the denormal and the zero.
constexpr float kMinNormalLength = 1e-12f;

bool usable(Vec3 p) {
    constexpr float kMax = static_cast<float>(kMaxCoordinate_m);
    return std::abs(p.x) <= kMax && std::abs(p.y) <= kMax && std::abs(p.z) <= kMax;
}

template <typename Predicate>
void remove_triangles(Mesh& mesh, Warnings& warnings, std::string_view fault,
                      const Predicate& is_faulty) {
    const std::size_t removed = std::erase_if(mesh.triangles, is_faulty);
    if (removed > 0) warnings.add(fault, mesh.name, removed);
}

void repair_positions(Mesh& mesh, Warnings& warnings) {
    const auto count = static_cast<std::uint32_t>(mesh.positions.size());
    remove_triangles(mesh, warnings, "triangles that name vertices that are not there are left out",
                     [&](UVec3 t) { return t.x >= count || t.y >= count || t.z >= count; });
    if (std::all_of(mesh.positions.begin(), mesh.positions.end(), usable)) return;
    remove_triangles(mesh, warnings, "triangles without a finite place are left out", [&](UVec3 t) {
        return !usable(mesh.positions[t.x]) || !usable(mesh.positions[t.y]) ||
               !usable(mesh.positions[t.z]);
    });
    for (Vec3& p : mesh.positions) {
        if (!usable(p)) p = Vec3(0.0f);
    }
}

void repair_normals(Mesh& mesh, Warnings& warnings) {
    std::vector<std::size_t> faulty;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const float length = usable(mesh.normals[i]) ? glm::length(mesh.normals[i]) : 0.0f;
        if (length >= kMinNormalLength && std::isfinite(length)) {
            mesh.normals[i] /= length;
        } else {
            faulty.push_back(i);
        }
    }
    if (faulty.empty()) return;
    const std::vector<Vec3> geometric = geometric_normals(mesh);
    for (const std::size_t i : faulty)
        mesh.normals[i] = geometric[i];
    warnings.add("normals without a direction are replaced by the triangles'", mesh.name,
                 faulty.size());
}

bool finite(float v) {
    return std::isfinite(v);
}

void repair_texcoords(Mesh& mesh, Warnings& warnings) {
    std::size_t faulty = 0;
    for (std::vector<Vec2>* set : {&mesh.texcoords, &mesh.lightmap_texcoords}) {
        for (Vec2& uv : *set) {
            if (finite(uv.x) && finite(uv.y)) continue;
            uv = Vec2(0.0f);
            ++faulty;
        }
    }
    if (faulty > 0) {
        warnings.add("texture coordinates that are not finite become 0", mesh.name, faulty);
    }
}

void repair_colors(Mesh& mesh) {
    for (Vec4& color : mesh.colors) {
        for (int channel = 0; channel < 4; ++channel) {
            // Written so that NaN becomes 1.
            const float value = color[channel];
            color[channel] = value >= 0.0f ? std::min(value, 1.0f) : value < 0.0f ? 0.0f : 1.0f;
        }
    }
}

}  // namespace

std::vector<Vec3> geometric_normals(const Mesh& mesh) {
    std::vector<DVec3> sums(mesh.positions.size(), DVec3(0.0));
    for (const UVec3& t : mesh.triangles) {
        const DVec3 p0(mesh.positions[t.x]);
        const DVec3 doubled_area_normal =
            glm::cross(DVec3(mesh.positions[t.y]) - p0, DVec3(mesh.positions[t.z]) - p0);
        for (int corner = 0; corner < 3; ++corner)
            sums[t[corner]] += doubled_area_normal;
    }
    std::vector<Vec3> normals(sums.size());
    std::transform(sums.begin(), sums.end(), normals.begin(), [](DVec3 sum) {
        const double length = glm::length(sum);
        return length > 0.0 && std::isfinite(length) ? Vec3(sum / length) : Vec3(0.0f, 1.0f, 0.0f);
    });
    return normals;
}

void repair_mesh(Mesh& mesh, Warnings& warnings) {
    repair_positions(mesh, warnings);
    repair_normals(mesh, warnings);
    repair_texcoords(mesh, warnings);
    repair_colors(mesh);
}

}  // namespace gnomon::scene
