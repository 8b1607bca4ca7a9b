#include "scene/obj.h"

#include "base/check.h"
#include "base/parallel.h"
#include "scene/load_mesh.h"
#include "scene/obj_material.h"
#include "scene/obj_polygon.h"
#include "scene/obj_text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

namespace gnomon::scene {

namespace {

// Tests of a corner against an ear that all polygons of a file may take together: about a second.
constexpr std::uint64_t kEarTests = 300'000'000;

struct CornerHash {
    std::size_t operator()(const ObjCorner& corner) const {
        // Multipliers: primes, so that neighbours in all three lists spread out.
        return std::size_t{corner.position} * 73856093u ^ std::size_t{corner.texcoord} * 19349663u ^
               std::size_t{corner.normal} * 83492791u;
    }
};

// The corners of faces become vertices of one mesh, each combination once.
class MeshBuilder {
public:
    MeshBuilder(const ObjText& text, DVec3 origin_m, bool textured)
        : text_(text), origin_m_(origin_m), textured_(textured) {}

    Mesh mesh;
    bool lacks_texcoords = false;

    void add_triangle(const ObjCorner& a, const ObjCorner& b, const ObjCorner& c) {
        const std::uint32_t first = vertex(a);  // one by one: arguments have no order
        const std::uint32_t second = vertex(b);
        mesh.triangles.emplace_back(first, second, vertex(c));
    }

    // Where only some corners have normals, the others get the triangles'.
    Mesh finished() {
        if (without_normal_.size() == mesh.positions.size()) mesh.normals.clear();
        if (!mesh.normals.empty() && !without_normal_.empty()) {
            const std::vector<Vec3> geometric = geometric_normals(mesh);
            for (const std::uint32_t i : without_normal_)
                mesh.normals[i] = geometric[i];
        }
        return std::move(mesh);
    }

private:
    std::uint32_t vertex(const ObjCorner& corner) {
        const auto [entry, is_new] =
            vertices_.try_emplace(corner, static_cast<std::uint32_t>(mesh.positions.size()));
        if (!is_new) return entry->second;
        const DVec3 p = text_.positions[corner.position] - origin_m_;
        // Float infinity and NaN are caught later, with all triangles that they are in.
        mesh.positions.emplace_back(p);
        const bool has_normal = corner.normal < text_.normals.size();
        if (!has_normal) without_normal_.push_back(entry->second);
        mesh.normals.push_back(has_normal ? text_.normals[corner.normal] : Vec3(0.0f));
        if (textured_) {
            const bool has_texcoord = corner.texcoord < text_.texcoords.size();
            lacks_texcoords = lacks_texcoords || !has_texcoord;
            const Vec2 uv = has_texcoord ? text_.texcoords[corner.texcoord] : Vec2(0.0f);
            mesh.texcoords.emplace_back(uv.x, 1.0f - uv.y);
        }
        return entry->second;
    }

    const ObjText& text_;
    DVec3 origin_m_;
    bool textured_;
    std::vector<std::uint32_t> without_normal_;
    std::unordered_map<ObjCorner, std::uint32_t, CornerHash> vertices_;
};

// Z up to Y up: a quarter turn about X.
void turn_up(ObjText& text) {
    for (DVec3& p : text.positions)
        p = {p.x, p.z, -p.y};
    for (Vec3& n : text.normals)
        n = {n.x, n.z, -n.y};
}

bool usable(DVec3 p) {
    return std::abs(p.x) <= kMaxCoordinate_m && std::abs(p.y) <= kMaxCoordinate_m &&
           std::abs(p.z) <= kMaxCoordinate_m;
}

class ObjLoader {
public:
    ObjLoader(ObjText text, LoadContext& context) : text_(std::move(text)), context_(context) {}

    Draft load() {
        read_materials();
        drop_faulty_faces();
        origin_m_ = recentring_offset_m(bounds());
        // One mesh for each object and material, in the order in which the file first has them.
        std::stable_sort(
            text_.faces.begin(), text_.faces.end(), [](const ObjFace& a, const ObjFace& b) {
                return std::pair(a.object, a.material) < std::pair(b.object, b.material);
            });
        for (auto first = text_.faces.begin(); first != text_.faces.end();) {
            throw_if_cancelled(context_.progress, "loading the scene");
            const auto last = std::find_if(first, text_.faces.end(), [&](const ObjFace& face) {
                return face.object != first->object || face.material != first->material;
            });
            add_mesh({first, last});
            first = last;
        }
        return std::move(draft_);
    }

private:
    void read_materials() {
        draft_.materials = read_libraries(text_.libraries, context_, draft_.textures);
        std::map<std::string, std::uint32_t> numbers;
        for (const Material& material : draft_.materials)
            numbers.try_emplace(material.name, static_cast<std::uint32_t>(numbers.size()));
        const auto fallback = static_cast<std::uint32_t>(draft_.materials.size());
        draft_.materials.push_back(default_obj_material());
        for (const std::string& name : text_.materials) {
            const auto entry = numbers.find(name);
            material_numbers_.push_back(entry == numbers.end() ? fallback : entry->second);
            if (entry == numbers.end() && !name.empty()) {
                context_.warnings.add("a material is in no library; a grey one stands in", name);
            }
        }
    }

    void drop_faulty_faces() {
        std::uint64_t short_faces = 0;
        std::uint64_t dangling_faces = 0;
        std::erase_if(text_.faces, [&](const ObjFace& face) {
            const auto first =
                text_.corners.begin() + static_cast<std::ptrdiff_t>(face.first_corner);
            const bool dangling = std::any_of(
                first, first + face.corner_count,
                [&](const ObjCorner& c) { return c.position >= text_.positions.size(); });
            const bool is_short = face.corner_count < 3;
            dangling_faces += dangling ? 1 : 0;
            short_faces += is_short && !dangling ? 1 : 0;
            return dangling || is_short;
        });
        if (dangling_faces > 0) {
            context_.warnings.add("faces that name vertices that are not there are left out", {},
                                  dangling_faces);
        }
        if (short_faces > 0) {
            context_.warnings.add("faces of fewer than three corners are left out", {},
                                  short_faces);
        }
    }

    DBox3 bounds() const {
        DBox3 box;
        for (const ObjFace& face : text_.faces) {
            for (std::uint32_t i = 0; i < face.corner_count; ++i) {
                const DVec3 p = text_.positions[text_.corners[face.first_corner + i].position];
                if (usable(p)) box.include(p);
            }
        }
        return box;
    }

    void add_mesh(std::span<const ObjFace> faces) {
        const std::uint32_t material = material_numbers_[faces.front().material];
        const std::string& name = text_.objects[faces.front().object];
        const bool textured = draft_.materials[material].base_color_texture >= 0;
        MeshBuilder builder(text_, origin_m_, textured);
        for (const ObjFace& face : faces)
            add_face(face, builder);
        if (builder.lacks_texcoords) {
            context_.warnings.add(
                "texture coordinates that a texture needs are not there and become 0", name);
        }
        Mesh mesh = builder.finished();
        mesh.name = name;
        mesh.material = material;
        repair_mesh(mesh, context_.warnings);
        if (mesh.triangles.empty()) return;
        const auto number = static_cast<std::uint32_t>(draft_.meshes.size());
        draft_.meshes.push_back({std::move(mesh), origin_m_});
        const auto [object, is_new] =
            objects_.try_emplace(faces.front().object, static_cast<std::uint32_t>(objects_.size()));
        draft_.instances.push_back({.mesh = number, .object = object->second, .name = name});
    }

    void add_face(const ObjFace& face, MeshBuilder& builder) {
        const ObjCorner* corners = text_.corners.data() + face.first_corner;
        if (face.corner_count == 3) return builder.add_triangle(corners[0], corners[1], corners[2]);
        polygon_.clear();
        for (std::uint32_t i = 0; i < face.corner_count; ++i)
            polygon_.push_back(text_.positions[corners[i].position]);
        triangles_.clear();
        triangulate(polygon_, ear_tests_left_, triangles_);
        for (const UVec3& t : triangles_)
            builder.add_triangle(corners[t.x], corners[t.y], corners[t.z]);
    }

    ObjText text_;
    LoadContext& context_;
    Draft draft_;
    DVec3 origin_m_{0.0};
    std::vector<std::uint32_t> material_numbers_;     // of the draft, by ObjFace::material
    std::map<std::uint32_t, std::uint32_t> objects_;  // of the draft, by ObjFace::object
    std::uint64_t ear_tests_left_ = kEarTests;
    std::vector<DVec3> polygon_;  // reused from face to face
    std::vector<UVec3> triangles_;
};

}  // namespace

Draft load_obj(std::vector<std::uint8_t> file, LoadContext& context) {
    ObjText text = parse_obj(std::move(file));
    if (context.options.up == UpAxis::z) turn_up(text);
    return ObjLoader(std::move(text), context).load();
}

}  // namespace gnomon::scene
