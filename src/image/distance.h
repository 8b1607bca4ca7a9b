#pragma once

#include <gnomon/math.h>

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::image {

/// The exact squared Euclidean distance, in pixels², from each pixel's centre to that of the
/// nearest pixel with a nonzero `mask`; 0 at those pixels, infinity everywhere when there are none.
/// `mask` and the result are row-major, width * height values. Linear in the number of pixels.
/// P. Felzenszwalb, D. Huttenlocher: "Distance Transforms of Sampled Functions", Theory of
/// Computing 8, 2012.
std::vector<double> squared_distance_px2(std::span<const std::uint8_t> mask, Extent size);

}  // namespace gnomon::image
