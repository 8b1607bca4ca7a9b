#pragma once

#include <gnomon/image.h>
#include <gnomon/math.h>
#include <gnomon/progress.h>
#include <gnomon/scene.h>
#include <gnomon/sun.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Hours of direct sun on the surfaces of a scene, or at points. docs/sun_hours.md tells what is
/// assumed, and how accurate it is.
namespace gnomon {

/// The scene is Y up; the sun is a point, at its centre.
struct SunHoursOptions {
    Place place;
    std::chrono::year_month_day from, to;  ///< the period, both included; a single day if equal
    int every_days = 1;                    ///< sampled: `from` and every so many days, 1 to 366
    std::chrono::minutes utc_offset{0};    ///< decides which noon belongs to a date
    std::string time_zone = {};            ///< not empty: zone_utc_offset() of each day, instead
    double step_minutes = 5.0;             ///< 2 to 60: a day is cut into equal parts, none longer
    double north_deg = 0.0;                ///< SceneFrame::north_deg
    std::optional<Atmosphere> refraction;  ///< SunOptions::refraction
    double horizon_deg = 0.0;              ///< no sun counts below this elevation, -1 to 18
    bool ignore_alpha = false;             ///< alpha masks count as solid
    bool back_sides = true;                ///< texels on the backs that light can reach, too
    int threads = 0;                       ///< 0 = all cores
    std::uint64_t memory_limit_bytes = 0;  ///< of hours on surfaces; 0 = the machine's memory
    std::uint64_t more_bytes = 0;          ///< what the caller will hold besides, as pictures
    std::string texel_option = "texel_size_m";  ///< what errors call the size: as its user does
};

/// Hours of sun at a point. Of a single day: `mean_h` and `worst_h` are equal, and so are
/// the longest spans.
struct SunHours {
    float mean_h = 0.0f;           ///< a day, over the sampled days
    float worst_h = 0.0f;          ///< on the day that has the fewest
    float longest_mean_h = 0.0f;   ///< longest span of a day without shade, over the sampled days
    float longest_worst_h = 0.0f;  ///< on the day whose longest span is the shortest
};

/// The sampled days, whatever stands in the sun's way.
struct SunDays {
    int period = 0;                            ///< days of the period
    int sampled = 0;                           ///< of these
    int polar_days = 0, polar_nights = 0;      ///< of the sampled
    double step_minutes = 0.0;                 ///< of the longest step
    double possible_h = 0.0;                   ///< above the horizon, a day, mean
    double shortest_h = 0.0, longest_h = 0.0;  ///< above the horizon: the shortest and longest day
    /// In words: times of a single day, and polar nights, if there are any. One line.
    std::string summary;
};

/// A point and the side from which it is lit.
struct SunSensor {
    DVec3 position_ws{0.0};
    DVec3 normal_ws{0.0, 1.0, 0.0};  ///< of any length but 0
};

/// A rectangle, of a facade, a roof or a ground. Sun counts on the side that u × v points to.
struct SunPlane {
    DVec3 corner_ws{0.0};
    DVec3 u_ws{0.0}, v_ws{0.0};  ///< from the corner along two edges, at right angles, metres
};

/// Points of a plane, row by row.
struct SunGrid {
    double spacing_m = 1.0;
    Extent size;
    DVec3 first_ws{0.0};
    /// Unit vectors: along a row, from row to row, and to the side on which sun counts.
    DVec3 right_ws{1.0, 0.0, 0.0}, down_ws{0.0, 0.0, 1.0}, normal_ws{0.0, 1.0, 0.0};

    std::vector<SunSensor> sensors() const;
};

enum class SunPoints { sensors, grid, texels };

/// Where the texels of a light map are.
struct SunHoursMap;

struct SunHoursResult {
    std::string scene;
    SunHoursOptions options;
    SunDays days;
    SunPoints kind = SunPoints::sensors;
    double texel_size_m = 0.0;   ///< of texels
    std::vector<SunGrid> grids;  ///< of grids: their points, one grid after the other
    std::vector<SunSensor> points;
    std::vector<SunHours> hours;  ///< of each point
    std::vector<double> weights;  ///< texels: their area in m², together that of the surface;
                                  ///< else 1, or 0 for points of a grid inside of things
    std::shared_ptr<const SunHoursMap> map;  ///< texels only
};

/// Hours at points of one's own. Throws Error{input} for options out of range and for points that
/// are not finite or face nowhere, naming the point from 1; Error{cancelled}.
SunHoursResult sun_hours(const Scene& scene, std::span<const SunSensor> sensors,
                         const SunHoursOptions& options, Progress& progress);

/// Hours on grids. Points without sun from which the way up leads to the back of a surface are
/// taken to be inside of a house or under the ground, and get weight 0.
SunHoursResult sun_hours(const Scene& scene, std::span<const SunGrid> grids,
                         const SunHoursOptions& options, Progress& progress);
SunHoursResult sun_hours(const Scene& scene, const SunGrid& grid, const SunHoursOptions& options,
                         Progress& progress);

/// Hours on all surfaces, at the texels of a light map: on fronts, and on the backs that light can
/// reach. Throws besides Error{input} before the work when all that is held of it does not fit in
/// memory, naming a size that would.
SunHoursResult sun_hours(const Scene& scene, double texel_size_m, const SunHoursOptions& options,
                         Progress& progress);

/// Texels of this size make some hundred thousand of the scene's surface: 1, 2 or 5 times a power
/// of ten. Throws Error{input} for a scene without area.
double choose_texel_size_m(const Scene& scene);

/// A horizontal grid over the scene's bounds, -Z first, -X first, its points in the middle of equal
/// squares. Without a height 1 m above the scene's lowest point. Throws Error{input} for a scene
/// without triangles, a spacing that is not above 0, and more than 10^7 points.
SunGrid make_sun_grid(const Scene& scene, double spacing_m, std::optional<double> height_ws_m = {});

/// A grid on a plane, in the same way: its squares cover it, and are as much beyond its one edge as
/// beyond the other. Throws Error{input} for a spacing that is not above 0, for a plane whose edges
/// are not at right angles or have no length, and for more than 10^7 points.
SunGrid make_sun_grid(const SunPlane& plane, double spacing_m);

/// Points from CSV: "x,y,z,nx,ny,nz", or "x,y,z" for those that face up (`up`), a line each, in the
/// file's own frame; separated by commas, semicolons or tabs, with decimal points. A first line
/// that has these names is a heading, and tells the order of the values. Blank lines and those that
/// begin with # are skipped, and values may stand in quotes. `name` is what errors call the text.
/// Throws Error{input} naming the line.
std::vector<SunSensor> parse_sun_sensors(std::string_view text, std::string_view name,
                                         DVec3 up = {0.0, 1.0, 0.0});

/// parse_sun_sensors of a file of at most 1 GiB.
std::vector<SunSensor> read_sun_sensors(const std::filesystem::path& path,
                                        DVec3 up = {0.0, 1.0, 0.0});

/// Planes from CSV of the same kind: a line "x,y,z,ux,uy,uz,vx,vy,vz" for each, of which there can
/// be 1000.
std::vector<SunPlane> parse_sun_planes(std::string_view text, std::string_view name);

/// parse_sun_planes of a file of at most 1 GiB.
std::vector<SunPlane> read_sun_planes(const std::filesystem::path& path);

/// Hours over all points, or those that face one way, by their weights.
struct SunHoursSummary {
    std::string facing;  ///< "all", "up", "down", "north", "east", "south", "west"
    std::size_t points = 0;
    double weight = 0.0;                                   ///< sum; m² for texels
    double mean_h = 0.0, least_h = 0.0, greatest_h = 0.0;  ///< of SunHours::mean_h
    double longest_mean_h = 0.0;                           ///< of SunHours::longest_mean_h
    std::vector<double> met;         ///< for each threshold: the part with mean_h at least so much
    std::vector<double> met_always;  ///< and with worst_h
};

/// "all" first, then the ways that some point faces: up and down within 45°, else the quarter of
/// true north.
std::vector<SunHoursSummary> summarize(const SunHoursResult& result,
                                       std::span<const double> thresholds_h = {});

/// What `gnomon sun` prints: place, days, accuracy, and a line for each summary.
std::string table(const SunHoursResult& result, std::span<const double> thresholds_h = {});

/// The light map's pages of SunHours::mean_h, 1 channel, hours; -1 where there is no surface.
std::vector<Image> sun_hours_pages(const SunHoursResult& result);

/// A camera above the scene that looks straight down, -Z at the top.
Camera top_camera(const Scene& scene, Extent size);

/// Hours in false colours as `camera` sees them, with a legend, sRGB. A light map is looked up at
/// each pixel, its nearest texel; sensors are discs and points of a grid squares, over grey
/// surfaces. Colours go from 0 to the whole hour above SunDays::possible_h.
/// Throws Error{cancelled}.
Image sun_hours_picture(const Scene& scene, const SunHoursResult& result, const Camera& camera,
                        Extent size, Progress& progress);

/// What that takes while it is made.
std::uint64_t sun_hours_picture_bytes(Extent size);

}  // namespace gnomon
