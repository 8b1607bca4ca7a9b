#pragma once

#include <vector>

namespace gnomon::pssm {

/// Where the splits of a view from `near_m` to `far_m` begin and end: `splits` + 1 distances,
/// rising. Between them `lambda` blends the logarithmic scheme, in which all splits have texels of
/// one size in the picture, with the uniform one. F. Zhang et al., "Parallel-Split Shadow Maps for
/// Large-scale Virtual Environments", VRCIA 2006.
std::vector<double> split_distances(double near_m, double far_m, int splits, double lambda);

}  // namespace gnomon::pssm
