#pragma once

#include <gnomon/math.h>

#include "trace/receiver.h"
#include "trace/tracer.h"

#include <cstdint>
#include <span>

namespace gnomon::bake {

/// The steps at which receivers see a light, by a ray for each: W. Donnelly, J. Demers, "Generating
/// Soft Shadows Using Occlusion Interval Maps", GPU Gems, 2004, chapter 13. The masks are those of
/// interval::bake(), but for rays near edges, which float decides. Neighbours in the list should be
/// neighbours in the scene: their rays of a step are traced together. On the calling thread alone.
void ray_masks(const trace::Tracer& tracer, std::span<const DVec3> to_light_ws,
               std::span<const trace::Receiver> receivers, std::span<std::uint64_t> masks);

}  // namespace gnomon::bake
