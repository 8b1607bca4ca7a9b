#pragma once

#include "bake/baked_texels.h"

namespace gnomon::bake {

/// The texels of a bake as its files hold them, where its scene's TEXCOORD_1 says: each instance is
/// one chart, all of its page, and each triangle a facet. Texels are taken to ask about their
/// centres, and no cells are fine, as files do not tell. Throws Error{input} naming a mesh without
/// places on a page.
BakedTexels stored_texels(const IntervalBake& bake);

}  // namespace gnomon::bake
