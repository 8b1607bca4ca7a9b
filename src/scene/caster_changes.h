#pragma once

#include <gnomon/scene.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace gnomon::scene {

/// The instances that cast otherwise in one scene than in another, rising: they are elsewhere, or
/// their triangles or holes are others. So two poses of one file are told apart, skins and morphs
/// included. None where the scenes have not the same number of instances, or none that is alike.
std::optional<std::vector<std::uint32_t>> changed_casters(const Scene& before, const Scene& after);

}  // namespace gnomon::scene
