#pragma once

#include <gnomon/progress.h>
#include <gnomon/scene.h>

#include "trace/receiver.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::bake {

/// Which of the receivers named by `asked` lie inside of a solid, as the ground under a house and
/// the foot of a wall in the ground do, where light cannot be and none should be seen: what their
/// normal meets first, or a ray to where on its path the light shines on them most, is an inner
/// side. Inner sides have meshes that close, and one-sided materials, whose backs are for no eye;
/// but none with holes. So do walls that have something above them and nothing at all below, up
/// being +Y: they go on below a ground that is a sheet. In the order of `asked`. Throws
/// Error{cancelled}.
std::vector<bool> are_buried(const Scene& scene, std::span<const trace::Receiver> receivers,
                             std::span<const std::uint32_t> asked,
                             std::span<const DVec3> to_light_ws, Progress& progress);

}  // namespace gnomon::bake
