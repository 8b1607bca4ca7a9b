// What vertices keep, and what receivers take from them.

#include <gnomon/error.h>
#include <gnomon/technique.h>

#include "raster/small_scene_test.h"
#include "vertex_bake.h"
#include "visibility/context_test.h"
#include "visibility/light_shape.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace gnomon {
namespace {

using namespace vertex_occlusion;
using trace::Receiver;

using raster::quad;

Scene scene_of(std::vector<Mesh> meshes) {
    return Scene(raster::scene_data(std::move(meshes)));
}

/// Facing up, |x| and |z| up to 1.
Mesh ground() {
    return quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
}

/// On the ground's first triangle, which is where x + z >= 0.
Receiver on_ground(float x_m, float z_m) {
    return {{x_m, 0, z_m}, {0, 1, 0}, {0, 0}};
}

/// A bake and what it takes, for receivers that need no picture.
class Baked {
public:
    Baked(const Scene& scene, const Light& light, double edge_m)
        : scene_(scene),
          light_(light),
          tracer_(scene, false, silent_),
          grid_(scene, edge_m, 1'000'000),
          bake_(scene, grid_, tracer_, light, 16, silent_) {}

    float at(const Receiver& receiver, bool walls = true) const {
        float value = -1.0f;
        VertexLookup(scene_, grid_, bake_, tracer_, light_, walls)
            .look_up({&receiver, 1}, {&value, 1});
        return value;
    }
    const SceneGrid& grid() const { return grid_; }
    const VertexBake& bake() const { return bake_; }

private:
    Progress silent_;
    Scene scene_;
    Light light_;
    trace::Tracer tracer_;
    SceneGrid grid_;
    VertexBake bake_;
};

/// Straight down; a roof hides what is at x < 0.
Scene under_a_roof() {
    return scene_of({ground(), quad({-3, 1, 3}, {3, 0, 0}, {0, 0, -6})});
}

// The ground's corners at x = 1 are lit, those at x = -1 are not, and that is all it knows.
TEST(VertexOcclusion, OnTheMeshAsItIsAShadowIsARamp) {
    const Baked baked(under_a_roof(), DirectionalLight{}, 0.0);
    for (const float x_m : {-0.9f, -0.5f, 0.0f, 0.3f, 0.8f}) {
        EXPECT_FLOAT_EQ(baked.at(on_ground(x_m, 0.9f)), 0.5f * (1.0f + x_m));
    }
}

TEST(VertexOcclusion, TheRampIsAsWideAsTheCells) {
    const double edge_m = 0.1;
    const Baked baked(under_a_roof(), DirectionalLight{}, edge_m);
    for (const float x_m : {-0.9f, -0.5f, -0.11f, 0.11f, 0.3f, 0.8f})
        EXPECT_EQ(baked.at(on_ground(x_m, 0.9f)), x_m > 0.0f ? 1.0f : 0.0f) << x_m;
    const float cell_m = baked.grid().of({0, 0}).cell_m;
    EXPECT_LE(cell_m, 0.1f);
    EXPECT_GT(cell_m, 0.09f);
}

TEST(VertexOcclusion, EachSideOfATriangleHasItsOwn) {
    const Baked baked(scene_of({ground()}), PointLight{.position_ws = {0, 2, 0}}, 0.0);
    Receiver receiver = on_ground(-0.2f, 0.3f);
    EXPECT_EQ(baked.at(receiver), 1.0f);
    EXPECT_EQ(baked.bake().value(true, 0), 1.0f);
    EXPECT_EQ(baked.bake().value(false, 0), VertexBake::kUnlit);
    receiver.normal_ws = -receiver.normal_ws;
    EXPECT_EQ(baked.at(receiver), 0.0f) << "the light is behind it";
}

/// A closed box over |x| and |z| up to 0.26, between the lines of a grid of 0.2 m.
Mesh box_on_ground() {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back((i & 1) != 0 ? 0.26f : -0.26f, (i & 2) != 0 ? 0.5f : -0.01f,
                                    (i & 4) != 0 ? 0.26f : -0.26f);
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

// The vertices inside of the box are dark. Without looking at walls that shows outside.
TEST(VertexOcclusion, NothingComesFromBehindAWall) {
    const DirectionalLight light{.to_light_ws = normalize(Vec3(0, 1, 2))};
    const Baked baked(scene_of({ground(), box_on_ground()}), light, 0.3);  // its diagonals
    const Receiver before_the_box = on_ground(-0.11f, 0.27f);
    EXPECT_EQ(baked.at(before_the_box), 1.0f);
    EXPECT_LT(baked.at(before_the_box, false), 0.5f);
    const Receiver far_from_it = on_ground(-0.11f, 0.8f);
    EXPECT_EQ(baked.at(far_from_it, false), 1.0f);
}

TEST(VertexOcclusion, PlacesAreTheSameWhateverTheColour) {
    PointLight lamp{.position_ws = {1, 2, 3}, .intensity = Vec3(5.0f)};
    const PointLight before = lamp;
    lamp.intensity = {0.1f, 0.2f, 0.3f};
    lamp.name = "dimmed";
    EXPECT_TRUE(same_place(before, lamp));
    lamp.position_ws.y += 1e-3f;
    EXPECT_FALSE(same_place(before, lamp));
    EXPECT_FALSE(same_place(DirectionalLight{}, DirectionalLight{.angular_diameter_rad = 0.01f}));
    EXPECT_FALSE(same_place(PointLight{}, SpotLight{}));
    EXPECT_FALSE(same_place(DiscLight{}, DiscLight{.normal_ws = {0, 1, 0}}));
}

/// Notes the tasks that it is told of, and asks to stop at one of them.
class Listener final : public Progress {
public:
    explicit Listener(std::string stop_at = {}) : stop_at_(std::move(stop_at)) {}
    void report(std::string_view task, double fraction) override {
        const std::lock_guard lock(mutex_);
        tasks_.emplace(task);
        EXPECT_GE(fraction, 0.0);
        EXPECT_LE(fraction, 1.0 + 1e-9);
        if (task == stop_at_) stop_ = true;
    }
    bool cancelled() const override { return stop_; }
    /// When the call has ended.
    bool heard(const std::string& task) const { return tasks_.contains(task); }

private:
    std::mutex mutex_;
    std::set<std::string> tasks_;
    std::string stop_at_;
    std::atomic<bool> stop_ = false;
};

class VertexOcclusionTest : public ContextTest {
protected:
    VertexOcclusionTest() { frame_.camera = look_at({0.4f, 1.6f, 2.1f}, {0, 0, 0}); }

    std::unique_ptr<Technique> technique_ = make_technique(context(), "vertex_occlusion");
    Frame frame_{.scene = scene_of({ground(), box_on_ground()}),
                 .light = PointLight{.position_ws = {1, 2, 0.5f}, .name = "lamp"},
                 .size = {64, 48}};
    Visibility visibility_;
};

TEST_F(VertexOcclusionTest, BakesOnceForALightThatStandsStill) {
    const auto bakes = [&] {
        Listener listener;
        technique_->render(frame_, visibility_, listener);
        return listener.heard("baking vertices");
    };
    EXPECT_TRUE(bakes());
    std::get<PointLight>(frame_.light).intensity = {9, 1, 0};
    frame_.camera = look_at({2, 2, 0}, {0, 0, 0});
    EXPECT_FALSE(bakes()) << "another colour and another view";
    std::get<PointLight>(frame_.light).position_ws.x = 0.0f;
    EXPECT_TRUE(bakes()) << "another place";
    frame_.ignore_alpha = true;
    EXPECT_TRUE(bakes()) << "other casters";
}

TEST_F(VertexOcclusionTest, ACancelledBakeLeavesNothingBehind) {
    technique_->prepare(frame_.scene);
    Listener listener("baking vertices");
    try {
        technique_->render(frame_, visibility_, listener);
        FAIL() << "was not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
    const Visibility again = technique_->render(frame_);
    const Visibility anew = make_technique(context(), "vertex_occlusion")->render(frame_);
    const auto a = again.image().pixels(), b = anew.image().pixels();
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
}

TEST_F(VertexOcclusionTest, TellsWhenVerticesAreTooFew) {
    technique_->render(frame_);
    EXPECT_EQ(technique_->last_render().note, "");
    technique_ = make_technique(context(), "vertex_occlusion", {{"vertices", 1}});
    technique_->render(frame_);
    EXPECT_NE(technique_->last_render().note.find("too few"), std::string::npos);
}

}  // namespace
}  // namespace gnomon
