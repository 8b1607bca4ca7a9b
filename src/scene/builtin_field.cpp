/// Two open fields in the manner of the scenes on which F. Zhang, H. Sun and O. Nyman, "Parallel-
/// split shadow maps on programmable GPUs", GPU Gems 3, 2007, and those after them measured: many
/// objects of many shapes from right before the eye to the horizon, under a sun at 45°.

#include "scene/builtin.h"
#include "scene/builtin_plants.h"
#include "scene/shapes.h"

#include <glm/common.hpp>

#include <array>
#include <cmath>
#include <functional>

namespace gnomon::scene {

namespace {

constexpr float kEyeHeightM = 1.8f;
constexpr float kFovRad = radians(50.0f);
constexpr float kNearM = 0.5f;
/// How far round and wide things reach into uneven ground.
constexpr float kFoundationM = 0.8f;

struct Materials {
    std::uint32_t grass, stone, brick, ball, paint, wood, tree;
};

Materials make_materials(SceneBuilder& builder) {
    return {.grass = builder.sheet("grass", {0.23f, 0.27f, 0.14f}),
            .stone = builder.solid("stone", {0.52f, 0.49f, 0.43f}),
            .brick = builder.solid("brick", {0.44f, 0.22f, 0.15f}),
            .ball = builder.solid("ball", {0.50f, 0.10f, 0.08f}, 0.05f, 64.0f),
            .paint = builder.solid("paint", {0.10f, 0.18f, 0.36f}, 0.06f, 64.0f),
            .wood = builder.solid("wood", {0.31f, 0.21f, 0.13f}),
            .tree = builder.solid("tree", Vec3(1.0f))};  // its colours are in its vertices
}

struct Detail {
    int ball_sides, ball_rings, column_sides, knot_points, knot_sides;
};

/// A tree of wood and leaves that are all closed: one mesh, coloured by vertex.
Mesh tree(int leaves) {
    const TreeSkeleton skeleton = tree_skeleton(3, 7.0f, 9, 5);
    const Vec4 bark(0.24f, 0.17f, 0.11f, 1.0f);
    const Vec4 leaf(0.17f, 0.27f, 0.07f, 1.0f);
    Mesh mesh = skeleton.wood;
    mesh.colors.assign(mesh.positions.size(), bark);
    Mesh crown = solid_leaves(skeleton.tips, 5, leaves, 1.15f);
    crown.colors.assign(crown.positions.size(), leaf);
    append(mesh, crown);
    return mesh;
}

Mesh column(Random& random, const Detail& detail) {
    const float height_m = random.uniform(4.5f, 8.0f);
    const float r = random.uniform(0.35f, 0.6f);
    return lathe({{0.0f, -kFoundationM},
                  {1.35f * r, -kFoundationM},
                  {1.35f * r, 0.25f},
                  {1.1f * r, 0.4f},
                  {r, 0.55f},
                  {0.96f * r, 0.4f * height_m},
                  {0.82f * r, height_m - 0.6f},
                  {1.0f * r, height_m - 0.5f},
                  {1.25f * r, height_m - 0.15f},
                  {1.25f * r, height_m},
                  {0.0f, height_m}},
                 detail.column_sides);
}

/// A gabled house with a chimney.
Mesh house(Random& random) {
    const float half_x = random.uniform(2.5f, 4.5f);
    const float half_z = random.uniform(3.0f, 6.0f);
    const float eaves_m = random.uniform(2.8f, 6.0f);
    const float ridge_m = eaves_m + random.uniform(1.2f, 2.4f);
    Mesh mesh = extrude({{-half_x, -kFoundationM},
                         {half_x, -kFoundationM},
                         {half_x, eaves_m},
                         {0.0f, ridge_m},
                         {-half_x, eaves_m}},
                        -half_z, half_z);
    append(mesh, box({0.4f * half_x, 0.9f * eaves_m, 0.3f * half_z},
                     {0.4f * half_x + 0.6f, ridge_m + 0.6f, 0.3f * half_z + 0.6f}));
    return mesh;
}

/// Pickets along x on two rails.
Mesh fence(Random& random) {
    constexpr float kPitchM = 0.24f;
    const int pickets = 30 + static_cast<int>(random.next() % 8);
    const float half_m = 0.5f * kPitchM * static_cast<float>(pickets - 1);
    Mesh mesh;
    for (const float y : {0.35f, 0.95f})
        append(mesh, box({-half_m - 0.1f, y - 0.04f, -0.06f}, {half_m + 0.1f, y + 0.04f, -0.01f}));
    for (int i = 0; i < pickets; ++i) {
        const float x = kPitchM * static_cast<float>(i) - half_m;
        const float top_m = random.uniform(1.20f, 1.35f);
        append(mesh, box({x - 0.045f, -kFoundationM, -0.025f}, {x + 0.045f, top_m, 0.02f}));
    }
    return mesh;
}

/// A torus knot, winding p times about the axis and q times about the ring.
Mesh knot(Random& random, const Detail& detail) {
    constexpr int kAroundAxis = 2;
    const int around_ring = random.uniform() < 0.5f ? 3 : 5;
    const float major_m = random.uniform(1.1f, 1.7f);
    const float minor_m = 0.42f * major_m;
    const std::vector<Vec2> circle = unit_circle(detail.knot_points);
    const auto at = [&](int i) { return circle[static_cast<std::size_t>(i % detail.knot_points)]; };
    std::vector<Vec3> path;
    for (int i = 0; i < detail.knot_points; ++i) {
        const Vec2 axis = at(i * kAroundAxis);
        const Vec2 ring = at(i * around_ring);
        const float r = major_m + minor_m * ring.x;
        path.emplace_back(r * axis.x, r * axis.y + major_m + minor_m, minor_m * ring.y);
    }
    return tube(path, 0.14f * major_m, detail.knot_sides, true);
}

/// Puts things on the ground.
class Field {
public:
    using Height = std::function<float(float, float)>;

    Field(SceneBuilder& builder, Height height_m, const Detail& detail, std::uint64_t seed)
        : builder_(builder),
          materials_(make_materials(builder)),
          height_m_(std::move(height_m)),
          detail_(detail),
          random_(seed) {}

    const Materials& materials() const { return materials_; }
    Random& random() { return random_; }

    void ball(float x, float z) {
        const float r = random_.uniform(0.9f, 1.9f);
        const float hover_m = random_.uniform(-0.3f, 0.5f) * r;  // some float, some lie
        add("ball", ++balls_, gnomon::scene::sphere(r, detail_.ball_sides, detail_.ball_rings),
            materials_.ball, place(x, z, 0.0f, r + hover_m));
    }
    void column(float x, float z) {
        add("column", ++columns_, scene::column(random_, detail_), materials_.stone, place(x, z));
    }
    void house(float x, float z) {
        const float turn_rad = random_.uniform(0.0f, 2.0f * kPi);
        add("house", ++houses_, scene::house(random_), materials_.brick, place(x, z, turn_rad));
    }
    void fence(float x, float z) {
        const float turn_rad = random_.uniform(0.0f, kPi);
        add("fence", ++fences_, scene::fence(random_), materials_.wood, place(x, z, turn_rad));
    }
    void knot(float x, float z) {
        const float turn_rad = random_.uniform(0.0f, 2.0f * kPi);
        const float hover_m = random_.uniform(0.1f, 0.6f);
        add("knot", ++knots_, scene::knot(random_, detail_), materials_.paint,
            place(x, z, turn_rad, hover_m));
    }
    void tree(std::uint32_t mesh, float x, float z) {
        const float turn_rad = random_.uniform(0.0f, 2.0f * kPi);
        const float scale = random_.uniform(0.75f, 1.35f);
        builder_.place(numbered("tree", ++trees_), mesh,
                       place(x, z, turn_rad, -0.1f) * scaling(Vec3(scale)));
    }

private:
    Mat4 place(float x, float z, float turn_rad = 0.0f, float above_m = 0.0f) const {
        return translation({x, height_m_(x, z) + above_m, z}) * rotation_y(turn_rad);
    }
    void add(std::string_view kind, int number, Mesh mesh, std::uint32_t material,
             const Mat4& world_from_local) {
        const std::string name = numbered(kind, number);
        builder_.place(name, builder_.mesh(name, std::move(mesh), material), world_from_local);
    }

    SceneBuilder& builder_;
    Materials materials_;
    Height height_m_;
    Detail detail_;
    Random random_;
    int balls_ = 0, columns_ = 0, houses_ = 0, fences_ = 0, knots_ = 0, trees_ = 0;
};

DirectionalLight field_sun() {
    return sun(radians(45.0f), radians(108.0f));
}

float hill_height_m(float x, float z) {
    // Rolling, no steeper than about 1 : 8, and different on every hill.
    return 9.0f * std::sin(0.0071f * x + 0.4f) * std::cos(0.0063f * z) +
           3.1f * std::sin(0.0193f * x - 0.0111f * z + 1.0f) +
           1.1f * std::cos(0.0437f * z + 0.0213f * x);
}

/// Moves places towards a village, where things then stand about twice as close.
Vec2 drawn_together(Vec2 p) {
    constexpr Vec2 kVillage(-60.0f, 150.0f);
    constexpr float kReachM = 340.0f;
    constexpr float kDensest = 0.42f;  // distances in the middle, as a factor
    const Vec2 d = p - kVillage;
    const float t = glm::smoothstep(0.0f, kReachM, glm::length(d));
    return kVillage + glm::mix(kDensest, 1.0f, t) * d;
}

}  // namespace

Scene field_small_scene() {
    constexpr float kHalfM = 100.0f;
    constexpr int kTreeLeaves = 220;
    constexpr Detail kDetail{24, 16, 16, 72, 8};
    SceneBuilder builder("field-small");
    Field field(
        builder, [](float, float) { return 0.0f; }, kDetail, 21);
    builder.add("ground", ground(Vec2(-kHalfM), Vec2(kHalfM)), field.materials().grass);

    using Add = void (Field::*)(float, float);
    struct Placement {
        Add add;
        float x, z;
    };
    // 18 and two trees make 20; the eye is at z = 88 and looks along -Z.
    const std::array placements{
        Placement{&Field::ball, -3.4f, 76.0f},   Placement{&Field::column, 4.6f, 75.5f},
        Placement{&Field::column, 6.2f, 68.0f},  Placement{&Field::column, 7.8f, 60.5f},
        Placement{&Field::column, 9.4f, 53.0f},  Placement{&Field::knot, -9.5f, 66.0f},
        Placement{&Field::fence, -1.2f, 69.0f},  Placement{&Field::fence, 0.5f, 58.0f},
        Placement{&Field::house, -17.0f, 47.0f}, Placement{&Field::house, 20.0f, 33.0f},
        Placement{&Field::ball, 1.6f, 45.0f},    Placement{&Field::ball, 13.0f, 61.0f},
        Placement{&Field::knot, 4.0f, 30.0f},    Placement{&Field::fence, 11.0f, 43.0f},
        Placement{&Field::house, -6.0f, -12.0f}, Placement{&Field::column, -24.0f, 5.0f},
        Placement{&Field::ball, -10.0f, 26.0f},  Placement{&Field::knot, 30.0f, -20.0f},
    };
    for (const Placement& p : placements)
        (field.*p.add)(p.x, p.z);
    const std::uint32_t tree_mesh = builder.mesh("tree", tree(kTreeLeaves), field.materials().tree);
    field.tree(tree_mesh, -9.0f, 56.0f);
    field.tree(tree_mesh, 16.5f, 49.0f);

    builder.light(field_sun());
    builder.camera({0.0f, kEyeHeightM, 88.0f}, {0.0f, 1.3f, 60.0f}, kFovRad, kNearM);
    return std::move(builder).scene();
}

Scene field_large_scene() {
    constexpr float kHalfM = 500.0f;
    constexpr int kTerrainCells = 256;
    constexpr int kTrees = 500;
    constexpr int kTreeLeaves = 130;
    constexpr int kOthers = 499;  // with the trees and the terrain: 1,000 objects
    constexpr Detail kDetail{36, 20, 24, 120, 10};
    constexpr Vec2 kEye(-46.5f, 248.5f);
    constexpr Vec2 kTarget(-60.5f, 214.0f);
    constexpr float kClearingM = 9.0f;  // nothing stands nearer to the eye
    SceneBuilder builder("field-large");
    Field field(builder, hill_height_m, kDetail, 42);
    builder.add(
        "terrain",
        height_field(Vec2(-kHalfM), Vec2(kHalfM), kTerrainCells, kTerrainCells, hill_height_m),
        field.materials().grass);

    // One thing in each cell of a grid of 32 x 32, not quite in its middle; the cells that are left
    // over are spread evenly.
    constexpr int kGrid = 32;
    constexpr float kCellM = 2.0f * (kHalfM - 10.0f) / kGrid;
    constexpr int kSkipEvery = kGrid * kGrid / (kGrid * kGrid - kTrees - kOthers);
    const std::uint32_t tree_mesh = builder.mesh("tree", tree(kTreeLeaves), field.materials().tree);
    constexpr std::array kOtherKinds{&Field::column, &Field::ball, &Field::fence, &Field::house,
                                     &Field::column, &Field::knot, &Field::fence, &Field::ball,
                                     &Field::column, &Field::house};
    int trees = 0;
    int others = 0;
    for (int cell = 0; cell < kGrid * kGrid && trees + others < kTrees + kOthers; ++cell) {
        if (cell % kSkipEvery == kSkipEvery - 1) continue;
        const Vec2 middle =
            Vec2(static_cast<float>(cell % kGrid), static_cast<float>(cell / kGrid));
        Vec2 p = (middle + 0.5f) * kCellM - Vec2(kHalfM - 10.0f);
        p.x += field.random().uniform(-0.3f, 0.3f) * kCellM;
        p.y += field.random().uniform(-0.3f, 0.3f) * kCellM;
        p = drawn_together(p);
        if (glm::length(p - kEye) < kClearingM) p = kEye + kClearingM * glm::normalize(p - kEye);
        const bool is_tree =
            others == kOthers || (trees < kTrees && field.random().uniform() < 0.5f);
        if (is_tree) {
            field.tree(tree_mesh, p.x, p.y);
            ++trees;
        } else {
            (field.*kOtherKinds[static_cast<std::size_t>(others) % kOtherKinds.size()])(p.x, p.y);
            ++others;
        }
    }

    builder.light(field_sun());
    const float eye_m = hill_height_m(kEye.x, kEye.y) + kEyeHeightM;
    builder.camera({kEye.x, eye_m, kEye.y}, {kTarget.x, eye_m - 1.5f, kTarget.y}, kFovRad, kNearM);
    return std::move(builder).scene();
}

}  // namespace gnomon::scene
