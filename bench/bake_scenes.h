#pragma once

/// The scenes of bench/bake: a courtyard with arcades, balustrades and a tree of 100,000 leaves; a
/// city of towers; a forest of leaf triangles. Built from a seed, in a plan with z up and y north.

#include <gnomon/scene.h>

#include "trace/receiver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace gnomon::bake_scenes {

/// Texels of one rectangle, side x side of them along a Z-order curve, so that neighbours in the
/// list are neighbours in the plane.
inline constexpr unsigned kPatchSide = 32;

class Plan {
public:
    explicit Plan(unsigned seed, float spacing) : random_(seed), spacing_(spacing) {}

    float between(float low, float high) {
        return low + (high - low) * static_cast<float>(random_() >> 8) / float{1 << 24};
    }
    unsigned below(unsigned count) { return static_cast<unsigned>(random_()) % count; }
    /// In the unit sphere, not too near its middle.
    Vec3 in_sphere(float least = 0.01f) {
        Vec3 p;
        do {
            p = {between(-1, 1), between(-1, 1), 0.0f};
            p.z = between(-1, 1);
        } while (glm::dot(p, p) > 1.0f || glm::dot(p, p) < least);
        return p;
    }

    void triangle(Vec3 a, Vec3 b, Vec3 c) {
        const auto first = static_cast<unsigned>(mesh_.positions.size());
        for (const Vec3 p : {a, b, c})
            mesh_.positions.push_back(y_up(p));
        mesh_.triangles.push_back({first, first + 1, first + 2});
    }
    void quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
    /// Without its bottom.
    void box(Vec3 low, Vec3 high) {
        std::array<Vec3, 8> p;
        for (unsigned i = 0; i < 8; ++i) {
            p[i] = {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                    (i & 4) != 0 ? high.z : low.z};
        }
        quad(p[0], p[1], p[5], p[4]);
        quad(p[1], p[3], p[7], p[5]);
        quad(p[3], p[2], p[6], p[7]);
        quad(p[2], p[0], p[4], p[6]);
        quad(p[4], p[5], p[7], p[6]);
    }
    /// Turns a profile of (radius, height) around the vertical through `foot`.
    void lathe(Vec3 foot, const std::vector<Vec2>& profile, int segments) {
        const auto point = [&](Vec2 ring, int segment) {
            const float angle =
                2.0f * kPi * static_cast<float>(segment) / static_cast<float>(segments);
            return foot + Vec3(ring.x * std::cos(angle), ring.x * std::sin(angle), ring.y);
        };
        for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
            for (int s = 0; s < segments; ++s) {
                quad(point(profile[i], s), point(profile[i], s + 1), point(profile[i + 1], s + 1),
                     point(profile[i + 1], s));
            }
        }
    }
    void tree(Vec3 foot, float height, float radius, int leaves, float leaf_size) {
        const float bare = 0.35f * height;
        lathe(foot, {{0.3f, 0}, {0.22f, 0.5f * bare}, {0.18f, bare}, {0.1f, 0.8f * height}}, 10);
        const float half = 0.5f * (height - bare);
        const Vec3 reach(radius, radius, half), middle = foot + Vec3(0, 0, bare + half);
        std::vector<Vec3> twigs(60);
        std::ranges::generate(twigs, [&] { return middle + in_sphere(0.15f) * reach; });
        for (int i = 0; i < leaves; ++i) {
            const Vec3 twig = twigs[below(60)];
            leaf(twig + 0.4f * in_sphere() * reach, leaf_size * between(0.7f, 1.3f));
        }
    }
    /// A wall of cells with a window each, set back by `depth`; `out` is its normal.
    void facade(Vec3 corner, Vec3 along, Vec3 out, Vec2 size, int columns, int rows, float depth) {
        const Vec2 cell = size / Vec2(static_cast<float>(columns), static_cast<float>(rows));
        for (int i = 0; i < columns * rows; ++i) {
            const Vec2 start =
                cell * Vec2(static_cast<float>(i % columns), static_cast<float>(i / columns));
            const auto at = [&](float x, float y, float in) {
                const Vec2 place = start + cell * Vec2(x, y);
                return corner + along * place.x + Vec3(0, 0, place.y) - out * in;
            };
            const float l = 0.25f, r = 0.75f, b = 0.25f, t = 0.85f;  // of the window
            quad(at(0, 0, 0), at(1, 0, 0), at(1, b, 0), at(0, b, 0));
            quad(at(0, t, 0), at(1, t, 0), at(1, 1, 0), at(0, 1, 0));
            quad(at(0, b, 0), at(l, b, 0), at(l, t, 0), at(0, t, 0));
            quad(at(r, b, 0), at(1, b, 0), at(1, t, 0), at(r, t, 0));
            quad(at(l, b, 0), at(r, b, 0), at(r, b, depth), at(l, b, depth));
            quad(at(l, t, 0), at(r, t, 0), at(r, t, depth), at(l, t, depth));
            quad(at(l, b, 0), at(l, t, 0), at(l, t, depth), at(l, b, depth));
            quad(at(r, b, 0), at(r, t, 0), at(r, t, depth), at(r, b, depth));
            quad(at(l, b, depth), at(r, b, depth), at(r, t, depth), at(l, t, depth));
        }
    }
    /// `u` and `v` are the ways to the next texel.
    void patch(Vec3 corner, Vec3 u, Vec3 v, Vec3 normal) {
        constexpr float kOff_m = 0.005f;  // the walls' own triangles are no receivers' own here
        for (unsigned i = 0; i < kPatchSide * kPatchSide; ++i) {
            unsigned x = 0, y = 0;
            for (unsigned bit = 0; bit < 5; ++bit) {
                x |= (i >> (2 * bit) & 1) << bit;
                y |= (i >> (2 * bit + 1) & 1) << bit;
            }
            const Vec3 place = corner + spacing_ * ((static_cast<float>(x) + 0.5f) * u +
                                                    (static_cast<float>(y) + 0.5f) * v);
            receivers_.push_back(
                {y_up(place + kOff_m * normal), y_up(normal), {trace::kNoSurface, 0}});
        }
    }

    std::size_t triangles() const { return mesh_.triangles.size(); }
    Scene scene() const {
        SceneData data;
        data.materials.emplace_back();
        data.meshes.push_back(mesh_);
        data.instances.emplace_back();
        return Scene(std::move(data));
    }
    const std::vector<trace::Receiver>& receivers() const { return receivers_; }

private:
    static Vec3 y_up(Vec3 p) { return {p.x, p.z, -p.y}; }

    void leaf(Vec3 place, float size) {
        const Vec3 normal = glm::normalize(in_sphere());
        const Vec3 u = glm::normalize(glm::cross(normal, in_sphere()));
        const Vec3 v = glm::cross(normal, u);
        triangle(place - size * (0.4f * u + 0.5f * v), place + size * (0.4f * u - 0.5f * v),
                 place + size * 0.7f * v);
    }

    std::mt19937 random_;
    float spacing_;
    Mesh mesh_;
    std::vector<trace::Receiver> receivers_;
};

inline void wing(Plan& plan, Vec3 along, float half, float height) {
    const Vec3 in(-along.y, along.x, 0), up(0, 0, 1);
    const Vec3 start = -half * (in + along);
    const Vec3 end = start + 2 * half * along;
    plan.quad(start - 3.f * in, end - 3.f * in, end - 3.f * in + 4.5f * up,
              start - 3.f * in + 4.5f * up);
    plan.quad(start - 3.f * in + 4.5f * up, end - 3.f * in + 4.5f * up, end + 4.5f * up,
              start + 4.5f * up);
    plan.facade(start + 4.5f * up, along, in, {2 * half, height - 4.5f}, 14, 2, 0.35f);
    plan.quad(start - 10.f * in, end - 10.f * in, end - 10.f * in + height * up,
              start - 10.f * in + height * up);
    const auto roof = [&](int column, int row, float lift) {
        const float f = static_cast<float>(row) / 12;
        const float rise = 6.f * std::min(f, 1 - f) + lift;
        return start + along * (static_cast<float>(column) * half / 20) + in * (0.4f - 10 * f) +
               up * (height + rise);
    };
    for (int i = 0; i < 40 * 12; ++i) {
        const int a = i % 40, b = i / 40;
        plan.quad(roof(a, b, 0.06f), roof(a + 1, b, 0.06f), roof(a + 1, b + 1, 0),
                  roof(a, b + 1, 0));
    }
    std::vector<Vec2> column = {{.45f, 0}, {.45f, .15f}, {.38f, .2f}, {.42f, .28f}, {.32f, .35f}};
    for (int k = 1; k < 8; ++k)
        column.emplace_back(.32f - .00625f * static_cast<float>(k),
                            .35f + .4125f * static_cast<float>(k));
    column.insert(column.end(), {{.26f, 3.65f}, {.36f, 3.8f}, {.4f, 3.9f}, {.45f, 4.5f}});
    for (int c = 0; c < 10; ++c) {
        const Vec3 foot = start + along * (0.2f * half * static_cast<float>(c) + 0.5f);
        plan.lathe(foot, column, 28);
        const auto arch = [&](int k, float height_m, float y) {
            const float angle = kPi * static_cast<float>(k) / 16;
            const Vec3 middle = foot + 0.1f * half * along;
            return middle - along * (std::cos(angle) * (0.1f * half - 0.4f)) + y * in +
                   up * (height_m > 0 ? height_m : 3.2f + 1.2f * std::sin(angle));
        };
        for (int k = 0; c < 9 && k < 16; ++k) {
            plan.quad(arch(k, 0, .2f), arch(k + 1, 0, .2f), arch(k + 1, 0, -.2f), arch(k, 0, -.2f));
            plan.quad(arch(k, 0, .2f), arch(k + 1, 0, .2f), arch(k + 1, 4.5f, .2f),
                      arch(k, 4.5f, .2f));
        }
    }
    for (int k = 0; k < 90; ++k) {
        const float place = 2 * half * (static_cast<float>(k) + 0.5f) / 90;
        plan.lathe(start + place * along + 0.9f * in + 5.f * up,
                   {{.07f, 0}, {.07f, .08f}, {.04f, .14f}, {.06f, .3f}, {.03f, .55f}, {.07f, .8f}},
                   10);
    }
    const auto beam = [&](float from, float to, float low, float high) {
        const Vec3 a = start + from * in + low * up, b = end + to * in + high * up;
        plan.box(glm::min(a, b), glm::max(a, b));
    };
    beam(0.0f, 1.0f, 4.8f, 5.0f);     // balcony
    beam(0.82f, 0.98f, 5.8f, 5.92f);  // its rail
}

inline Plan courtyard(float spacing, float size) {
    Plan plan(1, spacing);
    const float half = 20, height = 12;
    const float far = half + 30;
    plan.quad({-far, -far, 0}, {far, -far, 0}, {far, far, 0}, {-far, far, 0});
    const Vec3 directions[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    for (const Vec3 along : directions)
        wing(plan, along, half, height);
    for (int k = 0; k < 20; ++k) {
        const auto step = static_cast<float>(k);
        plan.box({-12 + .35f * step, 8, 0}, {-11.65f + .35f * step, 13, .16f * (step + 1)});
        for (const float y : {8.1f, 12.9f}) {
            plan.lathe({-12 + .35f * step, y, .16f * (step + 1)},
                       {{.05f, 0}, {.03f, .2f}, {.05f, .5f}, {.03f, .8f}, {.05f, .95f}}, 10);
        }
    }
    plan.tree({3, 5, 0}, 13, 4.5f, static_cast<int>(100000 * size), .13f / std::sqrt(size));
    for (int i = 0; i < 100; ++i) {
        plan.patch(
            {-half + 4.f * static_cast<float>(i % 10), -half + 4.f * static_cast<float>(i / 10), 0},
            {.125f, 0, 0}, {0, .125f, 0}, {0, 0, 1});
    }
    for (const Vec3 along : directions) {
        const Vec3 in(-along.y, along.x, 0);
        for (int i = 0; i < 24; ++i) {
            const Vec3 corner = -half * (in + along) + 3.3f * static_cast<float>(i % 12) * along +
                                Vec3(0, 0, 5 + 3.4f * static_cast<float>(i / 12));
            plan.patch(corner, .103f * along, {0, 0, .103f}, in);
        }
    }
    return plan;
}

struct Wall {
    Vec3 corner, along, out;
    Vec2 size;
};

/// Tiers of a tower around (x, y).
inline void tower(Plan& plan, float x, float y, std::vector<Wall>& walls) {
    float w = plan.between(18, 32), d = plan.between(18, 32), foot = 0;
    const float height = 12 + 110 * std::pow(plan.between(0, 1), 3.f);
    const int tiers = 1 + (height > 30 ? 1 : 0) + (height > 70 ? 1 : 0);
    for (int t = 0; t < tiers; ++t) {
        const float tier =
            t == tiers - 1 ? height - foot : height * (.45f - .1f * static_cast<float>(t));
        const float x0 = x - w / 2, x1 = x + w / 2, y0 = y - d / 2, y1 = y + d / 2;
        const Wall sides[] = {{{x0, y0, foot}, {1, 0, 0}, {0, -1, 0}, {w, tier}},
                              {{x1, y0, foot}, {0, 1, 0}, {1, 0, 0}, {d, tier}},
                              {{x1, y1, foot}, {-1, 0, 0}, {0, 1, 0}, {w, tier}},
                              {{x0, y1, foot}, {0, -1, 0}, {-1, 0, 0}, {d, tier}}};
        for (const Wall& side : sides) {
            plan.facade(side.corner, side.along, side.out, side.size, tiers == 1 ? 3 : 2,
                        tiers == 3 ? 1 : 2, .4f);
            walls.push_back(side);
        }
        foot += tier;
        plan.quad({x0, y0, foot}, {x1, y0, foot}, {x1, y1, foot}, {x0, y1, foot});
        const float parapet = foot + .9f;
        plan.box({x0, y0, foot}, {x1, y0 + .3f, parapet});
        plan.box({x0, y1 - .3f, foot}, {x1, y1, parapet});
        plan.box({x0, y0, foot}, {x0 + .3f, y1, parapet});
        plan.box({x1 - .3f, y0, foot}, {x1, y1, parapet});
        for (int k = 0; t == tiers - 1 && k < 4; ++k) {
            const Vec3 low(plan.between(x0 + 2, x1 - 5), plan.between(y0 + 2, y1 - 5), foot);
            const float wide = plan.between(1, 4), deep = plan.between(1, 4);
            plan.box(low, low + Vec3(wide, deep, plan.between(.8f, 3.5f)));
        }
        w *= .75f;
        d *= .75f;
    }
}

inline Plan city(float spacing, float size) {
    Plan plan(2, spacing);
    const float pitch = 45;
    const int blocks = std::max(2, static_cast<int>(std::lround(50 * std::sqrt(size))) / 2 * 2);
    const float half = pitch * static_cast<float>(blocks) / 2;
    std::vector<Wall> walls;
    for (int i = 0; i < blocks * blocks; ++i) {
        const float x = -half + pitch * static_cast<float>(i % blocks);
        const float y = -half + pitch * static_cast<float>(i / blocks);
        plan.quad({x, y, 0}, {x + pitch, y, 0}, {x + pitch, y + pitch, 0}, {x, y + pitch, 0});
        tower(plan, x + pitch / 2, y + pitch / 2, walls);
    }
    for (int i = 0; i < 100; ++i) {  // streets run along multiples of the pitch
        const float x = pitch * std::floor(plan.between(-7, 7));
        const float y = pitch * std::floor(plan.between(-7, 7)), l = plan.between(0, pitch);
        if (i % 2 != 0) {
            plan.patch({x - 6, y + l, 0}, {.375f, 0, 0}, {0, .5f, 0}, {0, 0, 1});
        } else {
            plan.patch({x + l, y - 6, 0}, {.5f, 0, 0}, {0, .375f, 0}, {0, 0, 1});
        }
    }
    std::erase_if(walls, [&](const Wall& wall) {
        return std::abs(wall.corner.x) > 7 * pitch || std::abs(wall.corner.y) > 7 * pitch;
    });
    for (int i = 0; i < 98; ++i) {
        const Wall& wall = walls[plan.below(static_cast<unsigned>(walls.size()))];
        const Vec2 texel = glm::min(Vec2(.4f), wall.size / float{kPatchSide});
        const Vec2 room = wall.size - texel * float{kPatchSide};
        const float x = plan.between(0, room.x), z = plan.between(0, room.y);
        plan.patch(wall.corner + x * wall.along + Vec3(0, 0, z), texel.x * wall.along,
                   {0, 0, texel.y}, wall.out);
    }
    return plan;
}

inline Plan forest(float spacing, float size) {
    Plan plan(3, spacing);
    const float half = 30, far = 3 * half;
    plan.quad({-far, -far, 0}, {far, -far, 0}, {far, far, 0}, {-far, far, 0});
    std::vector<Vec3> cabins;
    for (int i = 0; i < 12; ++i) {
        const float x = plan.between(2 - half, half - 8);
        cabins.emplace_back(x, plan.between(2 - half, half - 8), 0);
        plan.box(cabins.back(), cabins.back() + Vec3(5, 4, 3));
    }
    for (int i = 0; i < 100; ++i) {
        const float x = 6.f * static_cast<float>(i % 10) - half + plan.between(.5f, 5.5f);
        const float y = 6.f * static_cast<float>(i / 10) - half + plan.between(.5f, 5.5f);
        const float height = plan.between(8, 13);
        plan.tree({x, y, 0}, height, plan.between(2.3f, 3.4f), static_cast<int>(10000 * size),
                  .16f / std::sqrt(size));
    }
    for (int i = 0; i < 100; ++i) {
        const float x = plan.between(-half, half - 3.2f);
        plan.patch({x, plan.between(-half, half - 3.2f), 0}, {.1f, 0, 0}, {0, .1f, 0}, {0, 0, 1});
    }
    for (const Vec3 c : cabins) {
        for (const float f : {.2f, 2.1f}) {
            plan.patch(c + Vec3(f, 0, .2f), {.055f, 0, 0}, {0, 0, .08f}, {0, -1, 0});
            plan.patch(c + Vec3(5, .8f * f, .2f), {0, .055f, 0}, {0, 0, .08f}, {1, 0, 0});
            plan.patch(c + Vec3(f, 4, .2f), {.055f, 0, 0}, {0, 0, .08f}, {0, 1, 0});
            plan.patch(c + Vec3(0, .8f * f, .2f), {0, .055f, 0}, {0, 0, .08f}, {-1, 0, 0});
        }
    }
    return plan;
}

}  // namespace gnomon::bake_scenes
