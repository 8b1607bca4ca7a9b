#pragma once

#include "raster/gpu_scene.h"
#include "visibility/caster_volume.h"
#include "visibility/light_fit.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// Which faces are drawn of casters that close and have no holes, as a light at infinity sees them.
enum class CasterFaces {
    all,
    lit,    ///< towards it: they hide the others, so that the map is the same
    unlit,  ///< away from it: Y. Wang, S. Molnar, "Second-Depth Shadow Mapping", UNC TR94-019, 1994
};

/// One layer of a map: what it shows, and which casters are worth drawing into it.
struct MapLayer {
    LightFit fit;
    CasterVolume casters;
    float caster_error_texels = 0.0f;  ///< how far simplified casters may be off; 0: none are
    CasterFaces faces = CasterFaces::all;
    bool needed = true;  ///< nothing is looked up in a layer that is not
};

/// How casters are drawn.
struct CasterOptions {
    bool ignore_alpha = false;
    bool reuse = false;             ///< what is there and would be drawn alike stays there
    bool multi_draw = true;         ///< what one state of the pipeline draws, by one command
    bool layered = false;           ///< all layers in one pass, where they and the device allow it
    bool positions_only = true;     ///< from positions alone, else from whole vertices
    bool optimised_indices = true;  ///< in clusters, else meshes whole, as the scene has them
    bool ids = false;  ///< beside depths, whose they are; drawn layer by layer, and never reused
};

/// Which triangles need not be drawn, by their corners' order in the map's image.
enum class Culled { none, clockwise, counter_clockwise };

/// One range of triangles, of instances one after the other.
struct CasterDraw {
    const raster::Draw* draw = nullptr;
    std::uint32_t first_index = 0, index_count = 0;
    std::uint32_t first_instance = 0, instance_count = 0;
    std::uint32_t slot = 0;  ///< of the last instance
    Culled culled = Culled::none;
};

/// What differs between the instances that one draw draws.
struct CasterInstance {
    Mat4 clip_from_local{1.0f};
    std::uint32_t layer = 0;
    std::uint32_t object = 0;  ///< index into Scene::instances()
};

/// What is drawn into a map, layer by layer: plain numbers, before any device hears of them.
class CasterDraws {
public:
    void clear();
    /// The casters of a layer, as few draws as they make: of all instances, or where `wanted` has
    /// one number for each of them, of those whose number is not 0. Ranges are of the casters'
    /// index buffer, of meshes that are drawn whole of the scene's own.
    std::vector<CasterDraw> add(const raster::GpuScene& scene, const MapLayer& layer,
                                std::uint32_t index, const CasterOptions& options,
                                std::span<const std::uint8_t> wanted = {});

    const std::vector<CasterInstance>& instances() const { return instances_; }
    std::uint64_t triangles() const { return triangles_; }  ///< over all layers
    /// In boxes around the casters, over all layers; texels in several count several times.
    std::uint64_t boxed_texels() const { return boxed_texels_; }

private:
    void add_part(std::vector<CasterDraw>& draws, const CasterDraw& part,
                  const CasterInstance& instance);

    std::vector<CasterInstance> instances_;
    std::uint64_t triangles_ = 0;
    std::uint64_t boxed_texels_ = 0;
};

/// Puts what one state of the pipeline draws side by side: what needs no texture, by what is
/// culled, then the rest.
void sort_by_state(std::vector<CasterDraw>& draws);

}  // namespace gnomon
