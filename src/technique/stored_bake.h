#pragma once

#include <array>
#include <string_view>

namespace gnomon {

/// The technique that looks up bakes, and those of its parameters that say how, not how to bake.
inline constexpr std::string_view kBakeTechnique = "occlusion_interval_maps";
inline constexpr std::array<std::string_view, 2> kLookupParams{"lookup", "weight"};

}  // namespace gnomon
