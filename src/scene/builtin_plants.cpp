#include "scene/builtin_plants.h"

#include "scene/builtin.h"
#include "scene/shapes.h"

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::scene {

namespace {

// Leaf texture, in units of its side, y upwards.
constexpr unsigned kLeafTextureSize = 128;
constexpr float kStemHalfWidth = 0.012f;
constexpr float kEdgeSoftness = 0.012f;  // over about three pixels

struct Leaf {
    Vec2 base;
    Vec2 tip;
    float green;  // lightness
};

/// Distance inside (> 0) or outside a lens between base and tip that is `bulge` as wide as long.
float lens_distance(const Leaf& leaf, Vec2 p) {
    constexpr float kBulge = 0.42f;
    const Vec2 middle = 0.5f * (leaf.base + leaf.tip);
    const Vec2 axis = glm::normalize(leaf.tip - leaf.base);
    const float half_length = 0.5f * glm::length(leaf.tip - leaf.base);
    const float half_width = kBulge * half_length;
    // Two circles of this radius through both ends, their centres on either side of the axis.
    const float radius =
        (half_length * half_length + half_width * half_width) / (2.0f * half_width);
    const Vec2 d = p - middle;
    const Vec2 local(glm::dot(d, axis), std::abs(axis.x * d.y - axis.y * d.x));
    return radius - glm::length(local + Vec2(0.0f, radius - half_width));
}

std::vector<Leaf> sprig() {
    std::vector<Leaf> leaves{{{0.5f, 0.62f}, {0.5f, 0.98f}, 0.95f}};
    for (int pair = 0; pair < 3; ++pair) {
        const float y = 0.14f + 0.20f * static_cast<float>(pair);
        const float reach = 0.40f - 0.05f * static_cast<float>(pair);
        const float shade = 0.75f + 0.08f * static_cast<float>(pair);
        leaves.push_back({{0.5f, y}, {0.5f - reach, y + 0.17f}, shade});
        leaves.push_back({{0.5f, y + 0.06f}, {0.5f + reach, y + 0.24f}, shade + 0.05f});
    }
    return leaves;
}

/// A branch that leaves `start` along `direction` and bends upwards.
std::vector<Vec3> branch_path(Vec3 start, Vec3 direction, float length_m, int points) {
    constexpr float kUpwardBend = 0.35f;
    std::vector<Vec3> path{start};
    const float step_m = length_m / static_cast<float>(points - 1);
    for (int i = 1; i < points; ++i) {
        direction = normalize(direction + Vec3(0.0f, kUpwardBend / static_cast<float>(points), 0));
        path.push_back(path.back() + step_m * direction);
    }
    return path;
}

std::vector<float> tapered(float first, float last, std::size_t count) {
    std::vector<float> values(count);
    for (std::size_t i = 0; i < count; ++i)
        values[i] = glm::mix(first, last, static_cast<float>(i) / static_cast<float>(count - 1));
    return values;
}

/// A point near one of the tips, and a frame there.
struct LeafPlace {
    Vec3 center;
    Vec3 along, across, normal;  // orthonormal
};

LeafPlace leaf_place(const std::vector<BranchTip>& tips, Random& random, int i, float size_m) {
    constexpr float kSpread = 1.1f;  // of the cluster about a tip, in leaf sizes
    constexpr float kUnruly = 0.9f;  // how much directions differ from the branch's
    const BranchTip& tip = tips[static_cast<std::size_t>(i) % tips.size()];
    LeafPlace place;
    const float distance_m = kSpread * size_m * random.uniform(0.2f, 1.0f);
    place.center = tip.position + distance_m * random.direction();
    place.along = normalize(tip.direction + kUnruly * random.direction());
    Vec3 side = random.direction();
    side -= place.along * glm::dot(side, place.along);
    place.across = normalize(side);
    place.normal = glm::cross(place.across, place.along);
    return place;
}

}  // namespace

Texture leaf_texture() {
    const std::vector<Leaf> leaves = sprig();
    const auto size = static_cast<float>(kLeafTextureSize);
    Texture texture{.name = "leaves",
                    .size = {kLeafTextureSize, kLeafTextureSize},
                    .wrap_u = TextureWrap::clamp,
                    .wrap_v = TextureWrap::clamp};
    for (unsigned row = 0; row < kLeafTextureSize; ++row) {
        for (unsigned column = 0; column < kLeafTextureSize; ++column) {
            const Vec2 p((static_cast<float>(column) + 0.5f) / size,
                         1.0f - (static_cast<float>(row) + 0.5f) / size);
            const float above_stem = std::max(p.y - 0.66f, 0.0f);
            float inside = kStemHalfWidth - glm::length(Vec2(p.x - 0.5f, above_stem));
            float green = 0.7f;  // colour goes on beyond the edge, where filtering reaches
            for (const Leaf& leaf : leaves) {
                const float distance = lens_distance(leaf, p);
                if (distance > inside) {
                    inside = distance;
                    green = leaf.green;
                }
            }
            const float alpha = glm::clamp(0.5f + inside / kEdgeSoftness, 0.0f, 1.0f);
            const Vec3 color = green * Vec3(112.0f, 148.0f, 62.0f);  // sRGB
            for (const float value : {color.x, color.y, color.z, 255.0f * alpha})
                texture.rgba.push_back(static_cast<std::uint8_t>(value));
        }
    }
    return texture;
}

TreeSkeleton tree_skeleton(std::uint64_t seed, float height_m, int branches, int sides) {
    constexpr float kRootDepthM = 0.15f;
    constexpr float kGoldenAngleRad = 2.39996f;  // spreads branches evenly about the trunk
    const int trunk_sides = 2 * sides;
    constexpr int kBranchPoints = 4;
    const float trunk_radius_m = 0.035f * height_m;
    Random random(seed);

    // The trunk leans and bends a little.
    std::vector<Vec3> trunk;
    for (int i = 0; i < 6; ++i) {
        const float t = static_cast<float>(i) / 5.0f;
        trunk.emplace_back(0.03f * height_m * t * t,
                           0.72f * height_m * t - kRootDepthM * (1.0f - t), -0.02f * height_m * t);
    }
    std::vector<float> radii = tapered(trunk_radius_m, 0.3f * trunk_radius_m, trunk.size());
    radii.front() *= 1.5f;  // roots

    TreeSkeleton tree;
    tree.wood = tube(trunk, radii, trunk_sides);
    for (int i = 0; i < branches; ++i) {
        const float t = (static_cast<float>(i) + 0.5f) / static_cast<float>(branches);
        const float up = 0.45f + 0.5f * t;  // along the trunk
        const float span = up * static_cast<float>(trunk.size() - 1);
        const auto k = static_cast<std::size_t>(span);
        const Vec3 start = glm::mix(trunk[k], trunk[k + 1], span - static_cast<float>(k));
        const float angle_rad =
            kGoldenAngleRad * static_cast<float>(i) + random.uniform(-0.2f, 0.2f);
        const Vec3 direction =
            normalize({std::cos(angle_rad), 0.25f + 0.9f * t + random.uniform(-0.1f, 0.1f),
                       std::sin(angle_rad)});
        const float length_m = height_m * (0.42f - 0.16f * t) * random.uniform(0.85f, 1.1f);
        const std::vector<Vec3> path = branch_path(start, direction, length_m, kBranchPoints);
        const float radius_m = trunk_radius_m * (0.42f - 0.2f * t);
        append(tree.wood, tube(path, tapered(radius_m, 0.25f * radius_m, path.size()), sides));
        for (std::size_t p = 2; p < path.size(); ++p)
            tree.tips.push_back({path[p], normalize(path[p] - path[p - 1])});
    }
    return tree;
}

Mesh leaf_cards(const std::vector<BranchTip>& tips, std::uint64_t seed, int count, float size_m) {
    Random random(seed);
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const LeafPlace place = leaf_place(tips, random, i, size_m);
        const Vec3 right = 0.5f * size_m * place.across;
        const Vec3 up = 0.5f * size_m * place.along;
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const Vec2 corner : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)}) {
            mesh.positions.push_back(place.center + corner.x * right + corner.y * up);
            mesh.normals.push_back(place.normal);
            mesh.texcoords.emplace_back(0.5f + 0.5f * corner.x, 0.5f - 0.5f * corner.y);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return mesh;
}

Mesh solid_leaves(const std::vector<BranchTip>& tips, std::uint64_t seed, int count, float size_m) {
    constexpr float kHalfWidth = 0.28f;  // in leaf sizes
    constexpr float kThickness = 0.12f;
    // The corners of one of a tetrahedron's faces lack the corner across from it.
    constexpr std::array<UVec3, 4> kFaces{UVec3(0, 1, 2), UVec3(0, 2, 3), UVec3(0, 3, 1),
                                          UVec3(1, 3, 2)};
    Random random(seed);
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const LeafPlace place = leaf_place(tips, random, i, size_m);
        const Vec3 back = -0.3f * size_m * place.along;
        const Vec3 side = kHalfWidth * size_m * place.across;
        const std::array corners{0.5f * size_m * place.along, back - side, back + side,
                                 -kThickness * size_m * place.normal};
        for (const UVec3 face : kFaces) {
            const Vec3 a = corners[face.x];
            const Vec3 normal = normalize(glm::cross(corners[face.y] - a, corners[face.z] - a));
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            for (int corner = 0; corner < 3; ++corner) {
                mesh.positions.push_back(place.center + corners[face[corner]]);
                mesh.normals.push_back(normal);
            }
            mesh.triangles.push_back({first, first + 1, first + 2});
        }
    }
    return mesh;
}

}  // namespace gnomon::scene
