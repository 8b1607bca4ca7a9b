#pragma once

#include <gnomon/math.h>

#include <span>
#include <vector>

namespace gnomon::interval {

/// Axes of length 1, at right angles, the third of them the one that the sun turns about.
struct Frame {
    DVec3 x_ws, y_ws, z_ws;

    DVec3 from_world(DVec3 v) const {
        return {glm::dot(v, x_ws), glm::dot(v, y_ws), glm::dot(v, z_ws)};
    }
};

/// A frame around `pole_ws`, the celestial pole of the place, of any length but 0. Its x axis is as
/// near to +Y as it can be, which is where the sun stands at noon. Throws Error{input}.
Frame frame_around(DVec3 pole_ws);

/// The directions towards the sun at the steps of a day. In a frame around the pole they are nearly
/// a circle, which the sun goes round evenly: that tells quickly which steps can see a box. Any
/// other directions are allowed, in any order; the farther they are from such a circle, the more
/// steps are tried in vain.
class DayPath {
public:
    static constexpr int kMaxSteps = 1024;

    /// `to_sun_ws`: 1 to kMaxSteps directions, made unit vectors here. Throws Error{input} naming
    /// the number, or the step whose direction is zero or not finite.
    DayPath(std::span<const DVec3> to_sun_ws, const Frame& frame);

    int steps() const { return static_cast<int>(to_sun_ws_.size()); }
    /// Words of 64 steps that a mask takes.
    int words() const { return (steps() + 63) / 64; }
    const Frame& frame() const { return frame_; }
    std::span<const DVec3> to_sun_ws() const { return to_sun_ws_; }

    /// The directions in the frame, rounded to float, coordinate by coordinate; there is room for
    /// any register at the last.
    const float* coordinates(int axis) const { return coordinates_[axis].data(); }

    /// Step = steps_per_rad * azimuth + step_at_zero, but for `slack_steps` at most; the azimuth
    /// is atan2(y, x) plus the right number of turns.
    struct Fit {
        double steps_per_rad = 0.0;  ///< negative when the sun turns clockwise
        double step_at_zero = 0.0;
        double slack_steps = 0.0;
        /// Least and greatest z / length(x, y) of the directions; infinite at a pole.
        double low_slope = 0.0, high_slope = 0.0;
    };
    const Fit& fit() const { return fit_; }

private:
    Frame frame_;
    std::vector<DVec3> to_sun_ws_;
    std::vector<float> coordinates_[3];
    Fit fit_;
};

}  // namespace gnomon::interval
