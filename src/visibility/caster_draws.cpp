#include "visibility/caster_draws.h"

#include "visibility/moving_casters.h"

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <limits>
#include <tuple>

namespace gnomon {

namespace {

/// The side of the smallest texel that the box can touch, in metres.
float least_texel_m(const LightFit& fit, const Box3& box) {
    if (fit.affine) {
        const TexelSteps steps = fit.texel_steps();
        return std::min(glm::length(steps.u_ws), glm::length(steps.v_ws));
    }
    float least_m = std::numeric_limits<float>::infinity();
    for (unsigned i = 0; i < 8; ++i) {
        const Vec3 corner((i & 1) != 0 ? box.max.x : box.min.x,
                          (i & 2) != 0 ? box.max.y : box.min.y,
                          (i & 4) != 0 ? box.max.z : box.min.z);
        least_m = std::min(least_m, fit.texel_size_m(corner));
    }
    return least_m;
}

/// The fewest triangles that show the part as the map's texels can.
const raster::CasterLevel& level_for(const MapLayer& layer,
                                     const std::vector<raster::CasterLevel>& levels,
                                     const raster::CasterPart& part, const Box3& bounds_ws) {
    std::size_t chosen = 0;
    if (layer.caster_error_texels > 0.0f && levels.size() > 1) {
        const float error_m = layer.caster_error_texels * least_texel_m(layer.fit, bounds_ws);
        while (chosen + 1 < levels.size() && levels[chosen + 1].error_m * part.scale <= error_m)
            ++chosen;
    }
    return levels[chosen];
}

/// From a light outside of what closes, only faces towards it are nearest. A light at infinity is
/// outside of everything, and its map's near plane clamps what it would cut open.
Culled culled_by(const MapLayer& layer, scene::Winding winding) {
    if (layer.faces == CasterFaces::all || winding == scene::Winding::open || !layer.fit.affine ||
        !layer.fit.clamps_near) {
        return Culled::none;
    }
    // Depth grows towards the light and y of the image points down, so that what keeps the world's
    // hand turns the order of the corners.
    const bool keeps_hand = glm::determinant(glm::dmat3(layer.fit.clip_from_world)) > 0.0;
    const bool outward = winding == scene::Winding::outward;
    const bool counter_clockwise = (keeps_hand == outward) == (layer.faces == CasterFaces::lit);
    return counter_clockwise ? Culled::counter_clockwise : Culled::clockwise;
}

}  // namespace

void CasterDraws::clear() {
    instances_.clear();
    triangles_ = 0;
    boxed_texels_ = 0;
}

std::vector<CasterDraw> CasterDraws::add(const raster::GpuScene& scene, const MapLayer& layer,
                                         std::uint32_t index,
                                         std::span<const std::uint8_t> wanted) {
    const glm::dmat4& from_world = layer.fit.clip_from_world;
    std::vector<CasterDraw> draws;
    for (const raster::Draw& draw : scene.draws()) {
        const Culled culled = culled_by(layer, draw.winding);
        for (std::uint32_t i = draw.first_part; i < draw.first_part + draw.part_count; ++i) {
            const raster::CasterPart& part = scene.parts()[i];
            const std::uint32_t placed = scene.instance_at(part.slot);
            if (!wanted.empty() && wanted[placed] == 0) continue;
            const Box3& bounds_ws = scene.part_bounds_ws()[i];
            if (!layer.casters.holds(bounds_ws)) continue;
            boxed_texels_ += covered_texels(layer.fit, Mat4(1.0f), bounds_ws).area();
            const Instance& instance = scene.scene().instances()[placed];
            const raster::CasterLevel& level =
                level_for(layer, scene.levels(draw, part), part, bounds_ws);
            add_part(draws,
                     {.draw = &draw,
                      .first_index = part.first_index + 3 * level.first_triangle,
                      .index_count = 3 * level.triangle_count,
                      .slot = part.slot,
                      .culled = culled},
                     {Mat4(from_world * glm::dmat4(instance.world_from_local)), index});
        }
    }
    return draws;
}

// Instances of the same triangles become one draw, and so do neighbouring triangles of one
// instance.
void CasterDraws::add_part(std::vector<CasterDraw>& draws, const CasterDraw& part,
                           const CasterInstance& instance) {
    triangles_ += part.index_count / 3;
    if (!draws.empty() && draws.back().draw == part.draw) {
        CasterDraw& last = draws.back();
        if (part.slot == last.slot && last.instance_count == 1 &&
            part.first_index == last.first_index + last.index_count) {
            last.index_count += part.index_count;
            return;
        }
        if (part.first_index == last.first_index && part.index_count == last.index_count) {
            last.slot = part.slot;
            ++last.instance_count;
            instances_.push_back(instance);
            return;
        }
    }
    draws.push_back(part);
    draws.back().first_instance = static_cast<std::uint32_t>(instances_.size());
    draws.back().instance_count = 1;
    instances_.push_back(instance);
}

void sort_by_state(std::vector<CasterDraw>& draws) {
    std::ranges::stable_sort(draws, {}, [](const CasterDraw& draw) {
        return std::tuple(draw.draw->masked, draw.culled);
    });
}

}  // namespace gnomon
