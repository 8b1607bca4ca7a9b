#pragma once

#include <gnomon/light.h>
#include <gnomon/math.h>
#include <gnomon/progress.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

enum class TextureWrap { repeat, mirror, clamp };

/// 8-bit RGBA, row-major, top row first: colour is sRGB-encoded, alpha linear. Sampled bilinearly.
struct Texture {
    std::string name;
    Extent size;
    std::vector<std::uint8_t> rgba;  ///< 4 * width * height
    TextureWrap wrap_u = TextureWrap::repeat;
    TextureWrap wrap_v = TextureWrap::repeat;
};

/// What a surface looks like, and where it lets light through.
struct Material {
    std::string name;
    Vec4 base_color{0.8f, 0.8f, 0.8f, 1.0f};  ///< linear RGB and alpha; multiplies the texture
    int base_color_texture = -1;              ///< index into SceneData::textures, -1 = none
    /// uv = uv_scale_rotation * texcoord + uv_offset (KHR_texture_transform).
    glm::mat2 uv_scale_rotation{1.0f};
    Vec2 uv_offset{0.0f};
    /// Points of alpha below it are holes, for the eye and for light. 0 = the material has no
    /// holes.
    float alpha_cutoff = 0.0f;
    bool double_sided = true;  ///< false: the back is not seen; it casts shadows all the same
    float specular = 0.04f;    ///< Blinn-Phong reflectance at normal incidence
    float shininess = 32.0f;   ///< Blinn-Phong exponent

    bool masked() const { return alpha_cutoff > 0.0f; }
};

/// Triangles of one material in their own space. Optional streams are empty or one per position.
struct Mesh {
    std::string name;
    std::vector<Vec3> positions;  ///< metres
    std::vector<Vec3> normals;    ///< unit vectors for shading
    std::vector<Vec2> texcoords;  ///< those that the material's texture uses; (0, 0) = top left
    std::vector<Vec2> lightmap_texcoords;  ///< TEXCOORD_1 of a file: each surface point's own place
    std::vector<Vec4> colors;              ///< linear RGBA; multiplies the material's base colour
    std::vector<UVec3> triangles;          ///< counter-clockwise seen from the front
    std::uint32_t material = 0;
};

/// One placement of a mesh.
struct Instance {
    std::uint32_t mesh = 0;
    std::uint32_t object = 0;     ///< what belongs together (a glTF node, an OBJ group), from 0
    Mat4 world_from_local{1.0f};  ///< affine; may mirror
    std::string name;
};

/// A pinhole or parallel camera looking along -Z of its view space, Y up.
struct Camera {
    std::string name = "camera";
    Mat4 view_from_world{1.0f};        ///< rigid
    float fov_y_rad = radians(45.0f);  ///< of the whole height; perspective only
    float near_m = 0.1f;               ///< > 0; there is no far plane in perspective
    float ortho_height_m = 0.0f;       ///< > 0: parallel projection of this height
    float ortho_depth_m = 0.0f;        ///< parallel projection only: distance of the far plane

    Vec3 eye_ws() const;
    /// Depth runs from 1 at the near plane to 0 at infinity (reversed Z); Y points down, as in
    /// Vulkan.
    Mat4 clip_from_view(Extent size) const;
    Mat4 clip_from_world(Extent size) const;
    /// Throws Error{input} naming the member, its value and its range.
    void validate() const;
};

/// Camera at `eye` that looks at `target`; +Y is up unless the view is vertical.
Camera look_at(Vec3 eye_ws, Vec3 target_ws, float fov_y_rad = radians(45.0f));

/// Camera that frames `bounds`: three-quarter view from above, 45° of view.
Camera framing_camera(const Box3& bounds, Extent size);

/// Everything a Scene is made of. Right-handed, Y up, metres.
struct SceneData {
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Instance> instances;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    /// File coordinates = scene coordinates + this; not zero when a loader moved the scene to the
    /// origin because float cannot hold its coordinates.
    DVec3 origin_offset_m{0.0};
    std::string source;                 ///< file or built-in name, for reports
    std::vector<std::string> warnings;  ///< faults that the loader tolerated, a line each
};

/// Where an instance goes.
struct InstancePose {
    std::uint32_t instance = 0;   ///< index into Scene::instances()
    Mat4 world_from_local{1.0f};  ///< affine; may mirror
};

/// What tells scenes apart: a key for caches that must not outlive what they are made from.
using SceneKey = std::weak_ptr<const void>;
bool same(const SceneKey& a, const SceneKey& b);

/// An immutable scene, cheap to copy: copies share their contents, and what a Context keeps for one
/// (vertex buffers, acceleration structures) serves them all.
class Scene {
public:
    Scene();  ///< empty

    /// Throws Error{input} naming the part when an index is out of range, a stream has the wrong
    /// length, or a number is not finite.
    explicit Scene(SceneData data);

    /// This scene with some instances elsewhere; of two poses of one instance the last counts. No
    /// triangle is touched: meshes, materials and textures are shared, on the device as well, and
    /// a frame of such a scene uploads matrices alone. What is made of triangles in the world is
    /// made anew for each: the ray tracer's tree, and so the truth and techniques on the host, and
    /// bakes. Depth maps with `reuse_maps` keep the casters that have never moved; that needs maps
    /// which rest, as those of lamps or of `fit` stable.
    /// Throws Error{input} naming the pose when its index is out of range, or its matrix not finite
    /// or not affine.
    ///
    ///     auto pssm = make_technique(context, "pssm", {{"fit", "stable"}, {"reuse_maps", true}});
    ///     Visibility visibility = pssm->render(frame);
    ///     for (const std::vector<InstancePose>& poses : animation) {
    ///         frame.scene = scene.moved(poses);
    ///         pssm->render(frame, visibility);
    ///     }
    Scene moved(std::span<const InstancePose> poses) const;

    /// Instances that moved() has placed elsewhere on the way from the scene that was made of its
    /// data to this one, rising. All others are where they were.
    const std::vector<std::uint32_t>& moving() const { return placement_->moving; }

    const std::vector<Mesh>& meshes() const { return contents_->data.meshes; }
    const std::vector<Material>& materials() const { return contents_->data.materials; }
    const std::vector<Texture>& textures() const { return contents_->data.textures; }
    const std::vector<Instance>& instances() const { return placement_->instances; }
    const std::vector<Camera>& cameras() const { return contents_->data.cameras; }
    const std::vector<Light>& lights() const { return contents_->data.lights; }
    const std::vector<std::string>& warnings() const { return contents_->data.warnings; }
    const std::string& source() const { return contents_->data.source; }
    DVec3 origin_offset_m() const { return contents_->data.origin_offset_m; }
    /// A copy of all of it, with the instances where they are.
    SceneData data() const;

    /// Of all instances, of those that have moved the boxes around their meshes' boxes; empty
    /// without triangles.
    Box3 bounds() const { return placement_->bounds; }
    /// Around the triangles of a mesh, in its space; empty without any.
    const Box3& mesh_bounds(std::uint32_t mesh) const { return contents_->mesh_bounds[mesh]; }
    std::uint64_t triangle_count() const {  ///< instances counted
        return contents_->triangle_count;
    }

    /// All of it: copies have the same, moved() gives another.
    SceneKey identity() const { return placement_; }
    /// All but where the instances are: moved() keeps it.
    SceneKey contents_identity() const { return contents_; }

private:
    struct Contents {
        SceneData data;  ///< without its instances
        std::vector<Box3> mesh_bounds;
        std::uint64_t triangle_count = 0;
    };
    struct Placement {
        std::vector<Instance> instances;
        std::vector<Box3> instance_bounds;
        std::vector<std::uint32_t> moving;
        Box3 bounds;
    };

    std::shared_ptr<const Contents> contents_;
    std::shared_ptr<const Placement> placement_;
};

enum class UpAxis { y, z };

struct LoadOptions {
    UpAxis up = UpAxis::y;          ///< which axis of an OBJ file points up; glTF is always Y up
    double animation_time_s = 0.0;  ///< pose of skins, morphs and nodes; clamped to the animation
    int animation = 0;              ///< which animation of the file poses the scene, if it has any
};

/// Loads .gltf, .glb or .obj, or makes the built-in scene of that name.
/// Scenes without a camera get one that frames them, scenes without a light a sun.
/// Throws Error{input} naming the file and the fault; tolerated faults are in Scene::warnings().
Scene load_scene(const std::string& path_or_name, const LoadOptions& options = {});
Scene load_scene(const std::string& path_or_name, const LoadOptions& options, Progress& progress);

struct BuiltinSceneInfo {
    std::string_view name;
    std::string_view summary;  ///< one line
};

/// The built-in scenes, in the order of the documentation.
const std::vector<BuiltinSceneInfo>& builtin_scenes();

/// The built-in scene `name`, the same on every machine. Throws Error{input}, suggesting the
/// nearest name, when there is none.
Scene make_builtin_scene(std::string_view name);

/// Writes a self-contained binary glTF (meshes, instances, materials, textures as PNG, cameras,
/// lights). Lights with area become points of equal intensity, as glTF has none.
/// Whole or not at all. Throws Error{machine} when it cannot be written.
void write_glb(const std::filesystem::path& path, const Scene& scene);

}  // namespace gnomon
