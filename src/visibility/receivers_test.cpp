// The rasteriser's receivers against the tracer's: two ways to the same pixels, which must differ
// in nothing but rounding.

#include "raster/receivers.h"

#include "raster/drawn_test.h"
#include "raster/small_scene_test.h"
#include "trace/alpha.h"
#include "visibility/context_impl.h"
#include "visibility/context_test.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <random>

namespace gnomon {
namespace {

using trace::SurfaceId;

constexpr Extent kSize{256, 144};

/// Rasterisers snap corners to 1/256 of a pixel, which moves an edge by at most sqrt(2)/512; twice
/// that for what rounding adds.
constexpr double kSnapPx = 2.0 * 1.4142 / 512.0;

/// Devices interpolate 8-bit textures with as few as 8 bits of fraction in each direction, and
/// alpha itself is in 8 bits.
constexpr float kAlphaTolerance = 3.0f / 255.0f;

/// What both say of the same frame.
struct Pictures {
    Frame frame;
    raster::Drawn drawn;
    std::vector<SurfaceId> traced;

    SurfaceId drawn_id(std::size_t i) const { return {drawn.ids[i].x, drawn.ids[i].y}; }
};

/// The line of sight through a pixel's centre: eye + t * direction, t = 1 at 1 m of view depth.
struct Sight {
    DVec3 origin_ws, direction_ws;
};

Sight sight(const Frame& frame, std::size_t pixel) {
    const DVec3 center(static_cast<double>(pixel % frame.size.width) + 0.5,
                       static_cast<double>(pixel / frame.size.width) + 0.5, 0.0);
    const double height = frame.size.height;
    const double right = (2.0 * center.x - frame.size.width) / height;
    const double up = 1.0 - 2.0 * center.y / height;
    const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(frame.camera.view_from_world));
    const bool parallel = frame.camera.ortho_height_m > 0.0f;
    const double scale = parallel ? 0.5 * static_cast<double>(frame.camera.ortho_height_m)
                                  : std::tan(0.5 * static_cast<double>(frame.camera.fov_y_rad));
    const glm::dvec4 side(scale * right, scale * up, 0.0, 0.0);
    const glm::dvec4 ahead(0.0, 0.0, -1.0, 0.0);
    const glm::dvec4 eye(0.0, 0.0, 0.0, 1.0);
    if (parallel) return {DVec3(world_from_view * (eye + side)), DVec3(world_from_view * ahead)};
    return {DVec3(world_from_view * eye), DVec3(world_from_view * (ahead + side))};
}

/// Where the sight meets the triangle's plane: view depth and barycentric coordinates.
struct Meeting {
    double depth_m = 0.0, u = 0.0, v = 0.0;
};

Meeting meet(const Sight& sight, const trace::Triangle& triangle) {
    const auto& [a, b, c] = triangle.corners_ws;
    const glm::dmat3 system(b - a, c - a, -sight.direction_ws);
    const DVec3 solution = glm::inverse(system) * (sight.origin_ws - a);
    return {solution.z, solution.x, solution.y};
}

/// Distance in pixels from a pixel's centre to the nearest line through an edge of the triangle.
double edge_distance_px(const Frame& frame, std::size_t pixel, const trace::Triangle& triangle) {
    const glm::dmat4 clip = glm::dmat4(frame.camera.clip_from_view(frame.size)) *
                            glm::dmat4(frame.camera.view_from_world);
    std::array<DVec3, 3> corners_px;  // homogeneous
    for (int i = 0; i < 3; ++i) {
        const glm::dvec4 p = clip * glm::dvec4(triangle.corners_ws[i], 1.0);
        corners_px[i] = {0.5 * (p.x + p.w) * frame.size.width,
                         0.5 * (p.y + p.w) * frame.size.height, p.w};
    }
    const DVec3 center(static_cast<double>(pixel % frame.size.width) + 0.5,
                       static_cast<double>(pixel / frame.size.width) + 0.5, 1.0);
    double nearest = 1e300;
    for (int i = 0; i < 3; ++i) {
        const DVec3 line = glm::cross(corners_px[i], corners_px[(i + 1) % 3]);
        nearest = std::min(nearest, std::abs(glm::dot(line, center)) / std::hypot(line.x, line.y));
    }
    return nearest;
}

/// May rounding decide whether this pixel shows this surface?
bool is_borderline(const Frame& frame, std::size_t pixel, SurfaceId surface) {
    const trace::Triangle triangle = trace::world_triangle(frame.scene, surface);
    if (edge_distance_px(frame, pixel, triangle) < kSnapPx) return true;
    const Mesh& mesh = frame.scene.meshes()[frame.scene.instances()[surface.instance].mesh];
    const Material& material = frame.scene.materials()[mesh.material];
    if (!material.masked() || frame.ignore_alpha) return false;
    const Meeting at = meet(sight(frame, pixel), triangle);
    const float alpha = trace::surface_alpha(frame.scene, mesh, surface.primitive,
                                             static_cast<float>(at.u), static_cast<float>(at.v));
    return std::abs(alpha - material.alpha_cutoff) < kAlphaTolerance;
}

/// Is the difference of the two at this pixel one of rounding? Whichever surface is nearer is seen
/// by one and missed by the other, so that it must be a borderline case; unless both are as near.
bool is_explained(const Pictures& pictures, std::size_t pixel) {
    const Frame& frame = pictures.frame;
    const auto depth_m = [&](SurfaceId id) {
        if (id.instance == trace::kNoReceiver) return 1e300;
        return meet(sight(frame, pixel), trace::world_triangle(frame.scene, id)).depth_m;
    };
    const SurfaceId drawn = pictures.drawn_id(pixel);
    const SurfaceId traced = pictures.traced[pixel];
    const double drawn_m = depth_m(drawn);
    const double traced_m = depth_m(traced);
    constexpr double kSameDepth = 1e-5;  // some roundings of float
    if (std::abs(drawn_m - traced_m) < kSameDepth * std::abs(drawn_m)) return true;
    return is_borderline(frame, pixel, drawn_m < traced_m ? drawn : traced);
}

class ReceiverTest : public ContextTest {
protected:
    static Pictures both(const Frame& frame) {
        Progress silent;
        const std::shared_ptr<FrameReceivers> receivers = context().impl().receivers(frame);
        const auto tracer = context().impl().tracer(frame.scene, frame.ignore_alpha, silent);
        return {frame, raster::read_back(context().impl().device(), receivers->device),
                tracer->visible_surfaces(frame.camera, frame.size, silent)};
    }

    /// All differences are explained, and they are few: of the pixels that an edge crosses, up to a
    /// third of these pictures, snapping decides for about one in 200.
    static void expect_same_surfaces(const Pictures& pictures) {
        constexpr double kMost = 0.002;
        std::size_t differing = 0;
        for (std::size_t i = 0; i < pictures.traced.size(); ++i) {
            if (pictures.drawn_id(i) == pictures.traced[i]) continue;
            if (pictures.drawn.ids[i].x == trace::kNoReceiver &&
                pictures.traced[i].instance == trace::kNoReceiver) {
                continue;
            }
            ++differing;
            EXPECT_TRUE(is_explained(pictures, i))
                << "at " << i % pictures.frame.size.width << ", " << i / pictures.frame.size.width
                << ": drawn " << pictures.drawn.ids[i].x << "." << pictures.drawn.ids[i].y
                << ", traced " << pictures.traced[i].instance << "."
                << pictures.traced[i].primitive;
        }
        EXPECT_LE(static_cast<double>(differing),
                  kMost * static_cast<double>(pictures.traced.size()));
    }

    /// Where both see the same surface, they see it in the same place and from the same side.
    static void expect_same_places(const Pictures& pictures) {
        const Frame& frame = pictures.frame;
        Progress silent;
        const std::vector<trace::Receiver> points =
            context()
                .impl()
                .tracer(frame.scene, frame.ignore_alpha, silent)
                ->receivers(frame.camera, frame.size, pictures.traced);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const trace::Receiver& point = points[i];
            if (!point.exists() || pictures.drawn_id(i) != point.id) continue;
            const auto x = static_cast<unsigned>(i % frame.size.width);
            const auto y = static_cast<unsigned>(i / frame.size.width);
            const Vec3 drawn = pictures.drawn.position_ws(x, y);
            const float distance_m = glm::distance(frame.camera.eye_ws(), point.position_ws);
            EXPECT_LT(std::abs(glm::dot(drawn - point.position_ws, point.normal_ws)),
                      kPlaneTolerance * distance_m)
                << x << ", " << y;
            EXPECT_LT(glm::distance(pictures.drawn.normal_ws(x, y), point.normal_ws), 1e-4f)
                << x << ", " << y;
        }
    }

    /// Off the plane of the triangle, relative to the distance from the eye: some roundings of the
    /// depth buffer's floats and of the matrices on both ways.
    static constexpr float kPlaneTolerance = 1e-5f;
};

TEST_F(ReceiverTest, OfBuiltInScenesAreThoseThatRaysFind) {
    for (const char* name : {"cube", "courtyard", "jack-o-lantern", "gas-station", "torches"}) {
        SCOPED_TRACE(name);
        Frame frame{.scene = make_builtin_scene(name), .size = kSize};
        frame.camera = frame.scene.cameras().at(0);
        for (const bool ignore_alpha : {false, true}) {
            frame.ignore_alpha = ignore_alpha;
            const Pictures pictures = both(frame);
            expect_same_surfaces(pictures);
            expect_same_places(pictures);
        }
    }
}

TEST_F(ReceiverTest, OfParallelCamerasAreThoseThatRaysFind) {
    Frame frame{.scene = make_builtin_scene("courtyard"), .size = kSize};
    frame.camera = frame.scene.cameras().at(0);
    frame.camera.ortho_height_m = 6.0f;
    frame.camera.ortho_depth_m = 40.0f;
    const Pictures pictures = both(frame);
    expect_same_surfaces(pictures);
    expect_same_places(pictures);
}

/// Triangles in all directions, half of them single-sided, placed as they are and mirrored.
Scene random_scene() {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    const auto point = [&] { return Vec3(unit(random), unit(random), unit(random)); };
    SceneData data = raster::scene_data({Mesh{}, Mesh{}});
    data.materials.resize(2);
    data.materials[1].double_sided = false;
    data.meshes[1].material = 1;
    for (Mesh& mesh : data.meshes) {
        for (std::uint32_t i = 0; i < 60; ++i) {
            const Vec3 center = 2.0f * point();
            for (int corner = 0; corner < 3; ++corner)
                mesh.positions.push_back(center + point());
            mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        }
    }
    const Mat4 turned = glm::rotate(Mat4(1.0f), 2.0f, normalize(Vec3(1, 2, 3)));
    for (const std::uint32_t mesh : {0u, 1u}) {
        Instance mirrored{.mesh = mesh, .object = mesh + 2};
        mirrored.world_from_local = glm::scale(turned, {-1.5f, 0.8f, 1.1f});
        data.instances.push_back(mirrored);
        mirrored.world_from_local = glm::scale(turned, {-0.5f, -0.8f, 0.9f});  // not mirrored
        data.instances.push_back(mirrored);
    }
    return Scene(std::move(data));
}

TEST_F(ReceiverTest, OnMirroredAndSingleSidedTrianglesAreThoseThatRaysFind) {
    const Scene scene = random_scene();
    for (const Vec3 eye : {Vec3(5, 3, 4), Vec3(-6, 1, 0.3f), Vec3(0.2f, 0.1f, -0.3f)}) {
        const Frame frame{.scene = scene, .camera = look_at(eye, {0, 0.1f, 0}), .size = kSize};
        const Pictures pictures = both(frame);
        expect_same_surfaces(pictures);
        expect_same_places(pictures);
    }
}

TEST_F(ReceiverTest, FarFromTheOriginAreWhereRaysFindThem) {
    SceneData data = raster::scene_data({raster::wall({}, 4)});
    const Vec3 place(1000.0f, 200.0f, -3000.0f);
    data.instances[0].world_from_local =
        glm::rotate(glm::translate(Mat4(1.0f), place), 0.4f, {0, 1, 0});
    const Frame frame{.scene = Scene(std::move(data)),
                      .camera = look_at(place + Vec3(1, 2, 5), place),
                      .size = kSize};
    Progress silent;
    const std::shared_ptr<FrameReceivers> receivers =
        context().impl().receiver_points(frame, silent);
    const raster::Drawn drawn = raster::read_back(context().impl().device(), receivers->device);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < receivers->points.size(); ++i) {
        const trace::Receiver& point = receivers->points[i];
        if (!point.exists()) continue;
        ++compared;
        const Vec3 found = drawn.position_ws(static_cast<unsigned>(i % kSize.width),
                                             static_cast<unsigned>(i / kSize.width));
        // Coordinates of 3 km are rounded to 0.12 mm at each of a few steps.
        EXPECT_LT(std::abs(glm::dot(found - point.position_ws, point.normal_ws)), 2e-3f);
    }
    EXPECT_GT(compared, 1000u);
}

}  // namespace
}  // namespace gnomon
