#pragma once

#include "interval/tree.h"
#include "interval/walk.h"

#include <span>

namespace gnomon::interval {

/// Puts receivers of one normal into a tile, with the origins of their rays in the tree's frame.
/// False, with the tile unfinished, when they are not in one plane.
bool set_tile(Tile& tile, std::span<DVec3> origins, const Tree& tree,
              std::span<const trace::Receiver> receivers);

}  // namespace gnomon::interval
