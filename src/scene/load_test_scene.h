#pragma once

// Small scene files that the loaders' tests write themselves.

#include <gnomon/error.h>
#include <gnomon/scene.h>

#include "image/decode.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace gnomon::scene {

/// A folder that lives as long as the test.
class TestFolder {
public:
    TestFolder() {
        static int number = 0;
        path_ =
            std::filesystem::temp_directory_path() /
            ("gnomon_scene_test_" + std::to_string(::getpid()) + "_" + std::to_string(number++));
        std::filesystem::create_directories(path_);
    }
    ~TestFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;

    std::string write(const std::string& name, const std::string& bytes) const {
        const std::filesystem::path path = path_ / name;
        std::filesystem::create_directories(path.parent_path());
        std::ofstream(path, std::ios::binary) << bytes;
        return path.string();
    }

    /// One row of pixels, RGBA.
    std::string write_png(const std::string& name, const std::vector<std::uint8_t>& rgba) const {
        const auto width = static_cast<unsigned>(rgba.size() / 4);
        const std::vector<std::uint8_t> png = image::encode_png({{width, 1}, rgba});
        return write(name, {png.begin(), png.end()});
    }

    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// A glTF document under construction, its bytes in one buffer.
class TestGltf {
public:
    nlohmann::json json = nlohmann::json::parse(
        R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}]})");

    template <typename T>
    int view(const std::vector<T>& values, int stride = 0) {
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        nlohmann::json view{{"buffer", 0},
                            {"byteOffset", bytes_.size()},
                            {"byteLength", values.size() * sizeof(T)}};
        if (stride > 0) view["byteStride"] = stride;
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        return add("bufferViews", view);
    }

    int accessor(const nlohmann::json& fields) { return add("accessors", fields); }

    int floats(const std::string& type, int components, const std::vector<float>& values) {
        return accessor({{"bufferView", view(values)},
                         {"componentType", 5126},
                         {"count", values.size() / static_cast<std::size_t>(components)},
                         {"type", type}});
    }
    int vec3(const std::vector<float>& values) { return floats("VEC3", 3, values); }

    int indices(const std::vector<std::uint16_t>& values) {
        return accessor({{"bufferView", view(values)},
                         {"componentType", 5123},
                         {"count", values.size()},
                         {"type", "SCALAR"}});
    }

    /// A mesh of one primitive with these members.
    int mesh(const nlohmann::json& primitive) {
        return add("meshes", {{"name", "mesh"}, {"primitives", {primitive}}});
    }

    /// The unit right triangle in the plane z = 0, as mesh 0.
    void add_triangle() {
        mesh({{"attributes", {{"POSITION", vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}});
    }

    int add(const char* array, const nlohmann::json& element) {
        json[array].push_back(element);
        return static_cast<int>(json[array].size()) - 1;
    }

    std::string write(const TestFolder& folder) {
        if (!bytes_.empty()) {
            folder.write("scene.bin", bytes_);
            json["buffers"] = {{{"byteLength", bytes_.size()}, {"uri", "scene.bin"}}};
        }
        return folder.write("scene.gltf", json.dump());
    }

    Scene load(const LoadOptions& options = {}) {
        const TestFolder folder;
        return load_scene(write(folder), options);
    }

    /// What the error says, "" when there is none.
    std::string error(const LoadOptions& options = {}) {
        try {
            load(options);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            return error.what();
        }
        return {};
    }

private:
    std::string bytes_;
};

inline bool has_warning(const Scene& scene, const std::string& part) {
    for (const std::string& warning : scene.warnings()) {
        if (warning.find(part) != std::string::npos) return true;
    }
    return false;
}

/// Corner `corner` of triangle `triangle` of an instance, in file coordinates.
inline DVec3 corner_in_file(const Scene& scene, std::size_t instance, std::size_t triangle,
                            int corner) {
    const Instance& placed = scene.instances().at(instance);
    const Mesh& mesh = scene.meshes().at(placed.mesh);
    const Vec3 p = mesh.positions.at(mesh.triangles.at(triangle)[corner]);
    return DVec3(Vec3(placed.world_from_local * Vec4(p, 1.0f))) + scene.origin_offset_m();
}

inline void expect_near(DVec3 a, DVec3 b, double tolerance) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << "(" << a.x << ", " << a.y << ", " << a.z << ") against (" << b.x << ", " << b.y << ", "
        << b.z << ")";
}

/// A few roundings of coordinates of about 1.
inline constexpr double kRounding = 1e-6;

}  // namespace gnomon::scene
