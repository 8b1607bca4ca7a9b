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

/// Parts of one instance that are drawn or left out together: one of them, or all.
struct Unit {
    std::uint32_t first_part = 0, end_part = 0;
    Box3 bounds_ws;
};

Unit unit_at(const raster::GpuScene& scene, const raster::Draw& draw, std::uint32_t first_part,
             const CasterOptions& options) {
    Unit unit{first_part, first_part + 1, scene.part_bounds_ws()[first_part]};
    if (options.optimised_indices) return unit;
    const std::uint32_t slot = scene.parts()[first_part].slot;
    for (; unit.end_part < draw.first_part + draw.part_count; ++unit.end_part) {
        if (scene.parts()[unit.end_part].slot != slot) break;
        unit.bounds_ws.include(scene.part_bounds_ws()[unit.end_part].min);
        unit.bounds_ws.include(scene.part_bounds_ws()[unit.end_part].max);
    }
    return unit;
}

/// The triangles that show the unit in the layer.
CasterDraw draw_of(const raster::GpuScene& scene, const raster::Draw& draw, const MapLayer& layer,
                   const Unit& unit, const CasterOptions& options) {
    const raster::CasterPart& part = scene.parts()[unit.first_part];
    CasterDraw result{.draw = &draw,
                      .first_index = draw.first_index,
                      .index_count = draw.index_count,
                      .slot = part.slot};
    if (!options.optimised_indices) return result;
    const raster::CasterLevel& level =
        level_for(layer, scene.levels(draw, part), part, unit.bounds_ws);
    result.first_index = part.first_index + 3 * level.first_triangle;
    result.index_count = 3 * level.triangle_count;
    return result;
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
                                         std::uint32_t index, const CasterOptions& options,
                                         std::span<const std::uint8_t> wanted) {
    const glm::dmat4& from_world = layer.fit.clip_from_world;
    std::vector<CasterDraw> draws;
    for (const raster::Draw& draw : scene.draws()) {
        const Culled culled = culled_by(layer, draw.winding);
        const std::uint32_t end = draw.first_part + draw.part_count;
        for (std::uint32_t i = draw.first_part; i < end;) {
            const Unit unit = unit_at(scene, draw, i, options);
            i = unit.end_part;
            const std::uint32_t placed = scene.instance_at(scene.parts()[unit.first_part].slot);
            if (!wanted.empty() && wanted[placed] == 0) continue;
            if (!layer.casters.holds(unit.bounds_ws)) continue;
            boxed_texels_ += covered_texels(layer.fit, Mat4(1.0f), unit.bounds_ws).area();
            const Instance& instance = scene.scene().instances()[placed];
            CasterDraw drawn = draw_of(scene, draw, layer, unit, options);
            drawn.culled = culled;
            add_part(draws, drawn,
                     {Mat4(from_world * glm::dmat4(instance.world_from_local)), index, placed});
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
