#pragma once

/// Days and receivers that the tests of this folder share.

#include "interval/path.h"
#include "trace/receiver.h"

#include <cmath>
#include <random>
#include <vector>

namespace gnomon::interval {

/// The celestial pole of a northern latitude: north is -Z, up +Y.
inline DVec3 pole_at(double latitude_rad) {
    return {0.0, std::sin(latitude_rad), -std::cos(latitude_rad)};
}

/// Steps at equal times of the hour angles [from, to] at one declination.
inline std::vector<DVec3> circle(const Frame& frame, double declination_rad, double from_rad,
                                 double to_rad, int steps) {
    std::vector<DVec3> day;
    for (int k = 0; k < steps; ++k) {
        const double angle = from_rad + (to_rad - from_rad) * (k + 0.5) / steps;
        day.push_back(std::cos(declination_rad) *
                          (std::cos(angle) * frame.x_ws + std::sin(angle) * frame.y_ws) +
                      std::sin(declination_rad) * frame.z_ws);
    }
    return day;
}

/// side x side receivers on a rectangle, row by row.
inline std::vector<trace::Receiver> receivers_on(Vec3 corner, Vec3 u, Vec3 v, int side) {
    std::vector<trace::Receiver> receivers;
    const Vec3 normal = glm::normalize(glm::cross(u, v));
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            const float s = (static_cast<float>(i) + 0.5f) / static_cast<float>(side);
            const float t = (static_cast<float>(j) + 0.5f) / static_cast<float>(side);
            receivers.push_back({corner + s * u + t * v, normal, {trace::kNoSurface, 0}});
        }
    }
    return receivers;
}

/// Random numbers that are the same everywhere, unlike std::uniform_real_distribution's.
class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float between(float low, float high) {
        const auto bits = static_cast<float>(engine_() >> 8);
        return low + (high - low) * bits / static_cast<float>(1 << 24);
    }
    Vec3 in_box(float half) {
        const float x = between(-half, half), y = between(-half, half);
        return {x, y, between(-half, half)};
    }

private:
    std::mt19937 engine_;
};

}  // namespace gnomon::interval
