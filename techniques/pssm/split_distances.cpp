#include "split_distances.h"

#include <cmath>

namespace gnomon::pssm {

std::vector<double> split_distances(double near_m, double far_m, int splits, double lambda) {
    std::vector<double> distances_m{near_m};
    for (int i = 1; i < splits; ++i) {
        const double share = static_cast<double>(i) / splits;
        const double logarithmic = near_m * std::pow(far_m / near_m, share);
        const double uniform = near_m + (far_m - near_m) * share;
        distances_m.push_back(lambda * logarithmic + (1.0 - lambda) * uniform);
    }
    distances_m.push_back(far_m);
    return distances_m;
}

}  // namespace gnomon::pssm
