#include <gnomon/sun_hours.h>

#include "base/check.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

namespace gnomon {

namespace {

/// "all" is 0; the others as facing() counts them.
constexpr std::array<std::string_view, 7> kFacings = {"all",  "up",    "down", "north",
                                                      "east", "south", "west"};

/// Index into kFacings of the way that a normal faces.
class Facing {
public:
    explicit Facing(double north_deg) {
        const SceneFrame frame{UpAxis::y, north_deg};
        north_ws_ = sky_direction_ws(0.0, 0.0, frame);
        east_ws_ = sky_direction_ws(90.0, 0.0, frame);
    }

    std::size_t operator()(DVec3 normal_ws) const {
        const double up = normal_ws.y;
        const double north = glm::dot(normal_ws, north_ws_), east = glm::dot(normal_ws, east_ws_);
        // Within 45 degrees of the vertical, its part is no less than the horizontal one.
        if (std::abs(up) >= std::hypot(north, east)) return up > 0.0 ? 1 : 2;
        if (std::abs(north) >= std::abs(east)) return north > 0.0 ? 3 : 5;
        return east > 0.0 ? 4 : 6;
    }

private:
    DVec3 north_ws_, east_ws_;
};

void add(SunHoursSummary& summary, const SunHours& hours, double weight,
         std::span<const double> thresholds_h) {
    // What float's sums lose of a whole number of steps, relative to a day.
    constexpr double kRounding_h = 24.0 * 1e-6;
    if (summary.points == 0) {
        summary.least_h = std::numeric_limits<double>::infinity();
        summary.met.resize(thresholds_h.size());
        summary.met_always.resize(thresholds_h.size());
    }
    ++summary.points;
    summary.weight += weight;
    summary.mean_h += weight * hours.mean_h;
    summary.longest_mean_h += weight * hours.longest_mean_h;
    summary.least_h = std::min(summary.least_h, double{hours.mean_h});
    summary.greatest_h = std::max(summary.greatest_h, double{hours.mean_h});
    for (std::size_t t = 0; t < thresholds_h.size(); ++t) {
        if (hours.mean_h >= thresholds_h[t] - kRounding_h) summary.met[t] += weight;
        if (hours.worst_h >= thresholds_h[t] - kRounding_h) summary.met_always[t] += weight;
    }
}

std::string period_text(const SunHoursResult& result) {
    const SunHoursOptions& options = result.options;
    const auto date = [](std::chrono::year_month_day day) {
        return fmt::format("{:%F}", std::chrono::sys_days(day));
    };
    if (options.from == options.to) return date(options.from);
    const SunDays& days = result.days;
    return fmt::format("{} to {}, {}", date(options.from), date(options.to),
                       days.sampled == days.period
                           ? fmt::format("all {} days", days.period)
                           : fmt::format("{} of {} days", days.sampled, days.period));
}

std::string points_text(const SunHoursResult& result) {
    const std::size_t count = result.points.size();
    if (result.kind == SunPoints::texels)
        return fmt::format("{} texels of {:.4g} m", count, result.texel_size_m);
    if (result.kind == SunPoints::sensors) return fmt::format("{} points", count);
    const auto left_out = std::ranges::count(result.weights, 0.0);
    const SunGrid& first = result.grids.front();
    const std::string points =
        result.grids.size() == 1
            ? fmt::format("{} x {} points", first.size.width, first.size.height)
            : fmt::format("{} points on {} planes", count, result.grids.size());
    return fmt::format(
        "{}, {:.4g} m apart{}", points, first.spacing_m,
        left_out > 0 ? fmt::format("; {} inside of things are left out", left_out) : std::string());
}

std::string heading(const SunHoursResult& result, std::span<const double> thresholds_h) {
    const bool period = result.days.sampled > 1;
    std::string text = fmt::format("{:<6} {:>12} {:>8} {:>8} {:>8} {:>9}", "facing",
                                   result.kind == SunPoints::texels ? "area m2" : "points",
                                   "mean h", "least h", "most h", "longest h");
    for (const double threshold_h : thresholds_h) {
        text += fmt::format(" {:>9}", fmt::format(">={:.4g} h", threshold_h));
        if (period) text += fmt::format(" {:>9}", "every day");
    }
    return text + "\n";
}

std::string row(const SunHoursResult& result, const SunHoursSummary& summary) {
    const bool texels = result.kind == SunPoints::texels;
    std::string text = fmt::format("{:<6} {:>12.{}f} {:>8.2f} {:>8.2f} {:>8.2f} {:>9.2f}",
                                   summary.facing, summary.weight, texels ? 1 : 0, summary.mean_h,
                                   summary.least_h, summary.greatest_h, summary.longest_mean_h);
    for (std::size_t t = 0; t < summary.met.size(); ++t) {
        text += fmt::format(" {:>7.1f} %", 100.0 * summary.met[t]);
        if (result.days.sampled > 1)
            text += fmt::format(" {:>7.1f} %", 100.0 * summary.met_always[t]);
    }
    return text + "\n";
}

}  // namespace

std::vector<SunHoursSummary> summarize(const SunHoursResult& result,
                                       std::span<const double> thresholds_h) {
    const Facing facing(result.options.north_deg);
    std::array<SunHoursSummary, kFacings.size()> all;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        if (!(result.weights[i] > 0.0)) continue;
        for (const std::size_t into : {std::size_t{0}, facing(result.points[i].normal_ws)})
            add(all[into], result.hours[i], result.weights[i], thresholds_h);
    }
    std::vector<SunHoursSummary> summaries;
    for (std::size_t f = 0; f < all.size(); ++f) {
        if (all[f].points == 0) continue;
        SunHoursSummary& summary = summaries.emplace_back(std::move(all[f]));
        summary.facing = kFacings[f];
        for (double* sum : {&summary.mean_h, &summary.longest_mean_h})
            *sum /= summary.weight;
        for (std::size_t t = 0; t < thresholds_h.size(); ++t) {
            summary.met[t] /= summary.weight;
            summary.met_always[t] /= summary.weight;
        }
    }
    return summaries;
}

std::string table(const SunHoursResult& result, std::span<const double> thresholds_h) {
    const Place& place = result.options.place;
    const SunDays& days = result.days;
    std::string text =
        fmt::format("sun hours: {} at {:.6g}, {:.6g} on {}\n{}\n", result.scene, place.latitude_deg,
                    place.longitude_deg, period_text(result), days.summary);
    if (days.step_minutes > 0.0) {
        text += fmt::format(
            "steps of {:.3g} minutes: each change between sun and shade is found to {:.3g} "
            "minutes\n",
            days.step_minutes, 0.5 * days.step_minutes);
    }
    text += points_text(result) + "\n\n" + heading(result, thresholds_h);
    const std::vector<SunHoursSummary> summaries = summarize(result, thresholds_h);
    for (const SunHoursSummary& summary : summaries)
        text += row(result, summary);
    if (days.sampled > 1 && !summaries.empty()) {
        const double mean_h = summaries.front().mean_h;
        text +=
            fmt::format("\nhours are a day, on the average; in the {} days {:.1f} h of {:.1f} h\n",
                        days.period, mean_h * days.period, days.possible_h * days.period);
    }
    return text;
}

}  // namespace gnomon
