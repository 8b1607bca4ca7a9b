#pragma once

#include <gnomon/scene.h>

#include "scene/load_context.h"

#include <glm/ext/matrix_double4x4.hpp>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace gnomon::scene {

/// Beyond it a coordinate is no place but damage; squares of it still fit into a float.
inline constexpr double kMaxCoordinate_m = 1e15;

/// An axis-aligned box in double; the default box is empty and grows with `include`.
struct DBox3 {
    DVec3 min{std::numeric_limits<double>::infinity()};
    DVec3 max{-std::numeric_limits<double>::infinity()};

    bool empty() const { return !(min.x <= max.x); }
    void include(DVec3 p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
};

/// A mesh whose vertex i lies at mesh.positions[i] + origin_m of its own space.
struct DraftMesh {
    Mesh mesh;
    DVec3 origin_m{0.0};
};

struct DraftInstance {
    std::uint32_t mesh = 0;
    std::uint32_t object = 0;
    glm::dmat4 world_from_local{1.0};
    std::string name;
};

/// `camera` is complete but for view_from_world.
struct DraftCamera {
    Camera camera;
    glm::dmat4 world_from_view{1.0};
};

/// `light` is complete but for its position.
struct DraftLight {
    Light light;
    DVec3 position_ws{0.0};
};

/// A scene as its file has it: coordinates in double, wherever they are.
struct Draft {
    std::vector<DraftMesh> meshes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<DraftInstance> instances;
    std::vector<DraftCamera> cameras;
    std::vector<DraftLight> lights;
};

/// The whole metres, axis by axis, by which coordinates in `box` are to be moved before they become
/// float; 0 where float holds them as they are. An axis is moved when a float at its farthest
/// coordinate is coarser than 1 mm or a 100,000th of the box's diagonal, and that coordinate is so
/// far away, for the box's size, that moving gains three bits or more.
DVec3 recentring_offset_m(const DBox3& box);

/// Moves the draft to the origin where float needs it, places its parts, and gives it a camera and
/// a light when it has none. Leaves out, with a warning, what has no finite place.
SceneData finish(Draft draft, Warnings& warnings);

}  // namespace gnomon::scene
