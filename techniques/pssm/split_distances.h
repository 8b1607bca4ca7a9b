#pragma once

#include "visibility/light_fit.h"

#include <span>
#include <vector>

namespace gnomon::pssm {

/// Where the splits of a view begin and end: `splits` + 1 distances, rising. Between them `lambda`
/// blends the logarithmic scheme, in which all splits have texels of one size in the picture, with
/// the uniform one. F. Zhang et al., "Parallel-Split Shadow Maps for Large-scale Virtual
/// Environments", VRCIA 2006. Only distances that are `occupied` (apart and rising, at least one)
/// are shared among the splits, as A. Lauritzen et al., "Sample Distribution Shadow Maps", I3D
/// 2011, do with the logarithm.
std::vector<double> split_distances(std::span<const DepthRange> occupied, int splits,
                                    double lambda);

/// How many pieces are needed when nothing farther than `farthest_m` is seen, were the `whole` of
/// what a camera may see from here cut into `splits`: those that begin before it, at least 1.
int splits_needed(DepthRange whole, double farthest_m, int splits, double lambda);

}  // namespace gnomon::pssm
