#include <gnomon/sun_hours.h>

#include "command.h"
#include "fail.h"
#include "flags.h"
#include "help.h"
#include "output.h"
#include "sun_files.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

namespace gnomon::cli {

namespace {

using std::chrono::year_month_day;

constexpr const char* kExamples = R"(Examples:
  gnomon sun house.glb -o hours --place 48.137,11.575 --date 2026-03-21 --at-least 2
  gnomon sun city.obj --up z -o hours --place 52.0,4.4 --from 2026-03-21 --to 2026-09-21 --step 7
  gnomon sun city.obj --up z -o hours --place 52.0,4.4 --year 2026 --grid 2,1.5
  gnomon sun house.glb -o hours --place 48.137,11.575 --date 2026-12-21 --sensors windows.csv

Hours on all surfaces, unless --sensors or --grid names other points (then --texel adds the
surfaces). The folder gets hours.csv, pictures from above and from the scene's camera, and the light
map's pages as hours.exr, -1 where there is no surface.)";

constexpr Range kStepDays{1, 366, "days"};
constexpr Range kYear{1900, 2099, ""};
constexpr Range kMinutes{2, 60, "minutes"};
constexpr Range kNorth{-360, 360, "degrees"};
constexpr Range kHorizon{-1, 18, "degrees"};
constexpr Range kTexel{1e-6, 1e6, "metres"};
constexpr Range kSpacing{1e-6, 1e6, "metres"};
constexpr Range kHeight{-1e9, 1e9, "metres"};
constexpr Range kHours{0, 24, "hours"};

// Errors of half of them at each end of a span of sun; and seconds of work.
constexpr double kMinutesOfDay = 5.0;
constexpr double kMinutesOfPeriod = 15.0;
constexpr double kMinutesOfYear = 60.0;

constexpr std::string_view kPlanesExtension = ".csv";
constexpr double kMostPlanePoints = 1e7;  // as of one grid

struct GridFlag {
    double spacing_m = 1.0;
    std::optional<double> height_m;  ///< in the file's coordinates
    std::string planes;              ///< a file of them, in place of a height
};

struct SunFlags {
    ViewFlags view;
    std::string output, sensors;
    std::optional<Place> place;
    std::optional<year_month_day> date, from, to;
    int year = 0;  ///< 0 = not given
    int step_days = 0;
    double minutes = 0.0, texel_m = 0.0;  ///< likewise
    std::string utc_offset;               ///< or the name of a zone
    std::optional<GridFlag> grid;
    std::vector<double> at_least_h;
    double north_deg = 0.0, horizon_deg = 0.0;
    bool refraction = false, fronts = false;
};

/// "2", "2h" or "2.5 h".
double parse_hours(std::string_view flag, std::string_view text) {
    std::string_view number = text;
    if (number.ends_with('h')) number.remove_suffix(1);
    while (number.ends_with(' '))
        number.remove_suffix(1);
    return parse_number(flag, number, kHours);
}

GridFlag parse_grid(std::string_view text) {
    const std::vector<std::string_view> parts = split(text, ',');
    GridFlag grid{parse_number("--grid", parts[0], kSpacing), {}, {}};
    if (parts.size() == 1) return grid;
    const std::string_view rest = text.substr(parts[0].size() + 1);
    if (rest.ends_with(kPlanesExtension)) {
        grid.planes = rest;
    } else if (parts.size() == 2) {
        grid.height_m = parse_number("--grid", rest, kHeight);
    } else {
        fail_usage("--grid: \"{}\" is not SPACING, SPACING,HEIGHT or SPACING,FILE.csv", text);
    }
    return grid;
}

void set_period(const SunFlags& flags, SunHoursOptions& options) {
    using namespace std::chrono;
    const bool range = flags.from || flags.to;
    const int ways = (flags.date ? 1 : 0) + (range ? 1 : 0) + (flags.year != 0 ? 1 : 0);
    if (ways != 1 || flags.from.has_value() != flags.to.has_value()) {
        fail_usage("sun: give one of --date D, --from D --to D, or --year Y");
    }
    if (flags.date) {
        options.from = options.to = *flags.date;
        options.step_minutes = kMinutesOfDay;
    } else if (range) {
        options.from = *flags.from;
        options.to = *flags.to;
        options.step_minutes = kMinutesOfPeriod;
        if (sys_days(options.to) < sys_days(options.from)) {
            fail_usage("--to: is before --from; a period ends on its last day");
        }
    } else {
        options.from = year(flags.year) / January / 1;
        options.to = year(flags.year) / December / 31;
        options.step_minutes = kMinutesOfYear;
    }
    if (flags.date && flags.step_days != 0) fail_usage("--step: is for --from and --to, or --year");
    if (flags.step_days != 0) options.every_days = flags.step_days;
    if (flags.minutes != 0.0) options.step_minutes = flags.minutes;
}

SunHoursOptions options_of(const SunFlags& flags) {
    if (!flags.place) fail_usage("sun: --place is missing, as in --place 48.137,11.575");
    SunHoursOptions options;
    options.place = *flags.place;
    set_period(flags, options);
    options.utc_offset = flags.utc_offset.empty()
                             ? nearest_utc_offset(*flags.place)
                             : clock_utc_offset("--utc-offset", flags.utc_offset, options.from);
    if (!is_utc_offset(flags.utc_offset)) options.time_zone = flags.utc_offset;
    options.north_deg = flags.north_deg;
    options.horizon_deg = flags.horizon_deg;
    options.ignore_alpha = flags.view.ignore_alpha;
    options.back_sides = !flags.fronts;
    if (flags.refraction) options.refraction = Atmosphere{};
    return options;
}

/// The points of a file, in the scene's frame.
std::vector<SunSensor> load_sensors(const SunFlags& flags, const FileFrame& frame) {
    const DVec3 up = frame.z_up ? DVec3(0.0, 0.0, 1.0) : DVec3(0.0, 1.0, 0.0);
    std::vector<SunSensor> sensors = read_sun_sensors(flags.sensors, up);
    for (SunSensor& sensor : sensors) {
        sensor = {DVec3(frame.point(sensor.position_ws)), frame.direction(sensor.normal_ws)};
    }
    return sensors;
}

/// The grids on the planes of a file.
std::vector<SunGrid> plane_grids(const GridFlag& flag, const FileFrame& frame) {
    std::vector<SunGrid> grids;
    double points = 0.0;
    for (const SunPlane& plane : read_sun_planes(flag.planes)) {
        grids.push_back(make_sun_grid({DVec3(frame.point(plane.corner_ws)),
                                       frame.direction(plane.u_ws), frame.direction(plane.v_ws)},
                                      flag.spacing_m));
        points += static_cast<double>(grids.back().size.width) * grids.back().size.height;
    }
    if (points > kMostPlanePoints) {
        fail_usage("--grid: {} m apart on the planes of {} there are {:.0f} points; {:.0f} at most",
                   flag.spacing_m, flag.planes, points, kMostPlanePoints);
    }
    return grids;
}

SunGrid grid_of(const Scene& scene, const GridFlag& flag, const FileFrame& frame) {
    if (!flag.height_m) return make_sun_grid(scene, flag.spacing_m);
    const double h = *flag.height_m;
    const Vec3 point = frame.point(frame.z_up ? DVec3(0.0, 0.0, h) : DVec3(0.0, h, 0.0));
    return make_sun_grid(scene, flag.spacing_m, point.y);
}

struct Job {
    std::string prefix, note;
    SunHoursResult result;
};

std::vector<Job> count_hours(const Scene& scene, const SunFlags& flags,
                             const SunHoursOptions& options, const FileFrame& frame,
                             ConsoleProgress& progress) {
    std::vector<Job> jobs;
    if (!flags.sensors.empty()) {
        const std::vector<SunSensor> sensors = load_sensors(flags, frame);
        jobs.push_back({"sensors_", "", sun_hours(scene, sensors, options, progress)});
    }
    if (flags.grid && !flags.grid->planes.empty()) {
        jobs.push_back(
            {"grid_", "", sun_hours(scene, plane_grids(*flags.grid, frame), options, progress)});
    } else if (flags.grid) {
        const SunGrid grid = grid_of(scene, *flags.grid, frame);
        const DVec3 point = frame.file_point_m(Vec3(grid.first_ws));
        jobs.push_back(
            {"grid_",
             fmt::format("the grid's height is {:.4g} m{}\n", frame.z_up ? point.z : point.y,
                         flags.grid->height_m ? "" : ", 1 m over the lowest point"),
             sun_hours(scene, grid, options, progress)});
    }
    if (flags.texel_m != 0.0 || jobs.empty()) {
        const bool given = flags.texel_m != 0.0;
        const double texel_m = given ? flags.texel_m : choose_texel_size_m(scene);
        jobs.push_back(
            {"texels_",
             given ? "" : fmt::format("--texel {:.4g} was chosen from the scene's area\n", texel_m),
             sun_hours(scene, texel_m, options, progress)});
    }
    if (jobs.size() == 1) jobs.front().prefix.clear();
    return jobs;
}

void run_sun(const SunFlags& flags, const Session& session, ConsoleProgress& progress) {
    require_scene("sun", flags.view);
    if (flags.output.empty()) fail_usage("sun: -o is missing, as in -o hours");
    require_shared_folder("-o", flags.output);
    SunHoursOptions options = options_of(flags);
    options.threads = session.globals.threads;
    options.texel_option = "--texel";
    options.more_bytes = sun_hours_picture_bytes(flags.view.size);

    const Scene scene = load(flags.view.scene, session, progress);
    const FileFrame frame = file_frame(scene, flags.view.scene, session);
    const Camera camera = choose_camera(scene, flags.view, session);
    const std::vector<Job> jobs = count_hours(scene, flags, options, frame, progress);
    std::string text;
    if (flags.utc_offset.empty()) {
        text += fmt::format("clocks at UTC{}, the sun's own nearest hour (--utc-offset)\n",
                            utc_offset_text(options.utc_offset));
    }
    StagedFiles files(flags.output);
    for (const Job& job : jobs) {
        text += job.note + table(job.result, flags.at_least_h) + "\n";
        add_sun_hours(files, job.prefix, scene, job.result, frame, camera, flags.view.size,
                      progress);
    }
    const std::vector<std::filesystem::path> written = files.put_in_place();
    for (const Job& job : jobs)
        remove_other_pages(flags.output, job.prefix, written);
    for (const std::filesystem::path& path : written)
        text += path.string() + "\n";
    progress.clear();
    print(text);
}

void add_days(CLI::App& app, SunFlags& flags) {
    const std::string group = "Sun";
    const auto add_date = [&](const std::string& name, std::optional<year_month_day>& target,
                              const std::string& meaning) {
        add_parsed(app, name, "YYYY-MM-DD", meaning, [name, &target](const std::string& text) {
            target = parse_date(name, text);
        })->group(group);
    };
    add_parsed(app, "--place", "LAT,LON[,H]", "degrees north, degrees east, metres above the sea",
               [&flags](const std::string& text) { flags.place = parse_place("--place", text); })
        ->group(group);
    add_date("--date", flags.date, "a single day");
    add_date("--from", flags.from, "the first day of a period");
    add_date("--to", flags.to, "its last day");
    add_integer(app, "--step", flags.step_days, kStepDays,
                "of a period: count one day of so many (default 1)")
        ->group(group);
    add_integer(app, "--year", flags.year, kYear, "all days of a year, in steps of an hour")
        ->group(group);
    add_number(app, "--minutes", flags.minutes, kMinutes,
               "time step: a change between sun and shade errs by half of it (default 5 of a day, "
               "15 of a period, 60 of a year)")
        ->group(group);
    add_parsed(app, "--utc-offset", "+HH:MM|ZONE",
               "of the clocks that tell dates and times, or their zone, such as Europe/Berlin "
               "(default: the hour nearest to the sun's)",
               [&flags](const std::string& text) {
                   if (is_utc_offset(text)) parse_utc_offset("--utc-offset", text);
                   flags.utc_offset = text;
               })
        ->group(group);
    add_number(app, "--north", flags.north_deg, kNorth,
               "true north in the scene, clockwise from -Z (+Y of files with --up z), in degrees")
        ->group(group);
    add_number(app, "--horizon", flags.horizon_deg, kHorizon,
               "sun below this elevation does not count, in degrees (default 0)")
        ->group(group);
    app.add_flag("--refraction", flags.refraction,
                 "light comes from where mean air shows the sun, not from where it is")
        ->group(group);
}

void add_points(CLI::App& app, SunFlags& flags) {
    const std::string group = "Points";
    add_number(app, "--texel", flags.texel_m, kTexel,
               "side of a texel on the surfaces, in metres (default: chosen from their area)")
        ->group(group);
    app.add_flag("--fronts", flags.fronts,
                 "texels on the fronts of triangles only, not on backs that light can reach")
        ->group(group);
    app.add_option("--sensors", flags.sensors,
                   "points from a file, a line each: x,y,z,nx,ny,nz, or x,y,z to face up")
        ->type_name("FILE.csv")
        ->group(group);
    add_parsed(app, "--grid", "S[,H|,FILE.csv]",
               "points S metres apart on a horizontal plane, at height H of the file's coordinates "
               "(default 1 m over the scene's lowest point), or on planes, a line each: "
               "x,y,z,ux,uy,uz,vx,vy,vz, a corner and two edges; sun counts on the side of u x v",
               [&flags](const std::string& text) { flags.grid = parse_grid(text); })
        ->group(group);
}

}  // namespace

Command add_sun(CLI::App& program) {
    CLI::App* const app =
        add_command(program, "sun", "Count hours of direct sun on surfaces or at points",
                    "gnomon sun SCENE -o DIR --place LAT,LON --date YYYY-MM-DD [flags]", kExamples);
    const auto flags = std::make_shared<SunFlags>();
    app->add_option("-o,--output", flags->output, "the folder to write into")->type_name("DIR");
    app->add_option_function<std::vector<std::string>>(
           "--at-least",
           [flags](const std::vector<std::string>& texts) {
               flags->at_least_h.clear();
               for (const std::string& text : texts)
                   flags->at_least_h.push_back(parse_hours("--at-least", text));
           },
           "tell the part of the area with so many hours a day; may be given several times")
        ->type_name("HOURS")
        ->allow_extra_args(false);
    add_days(*app, *flags);
    add_points(*app, *flags);
    add_camera(*app, flags->view);
    add_ignore_alpha(*app, flags->view);
    return {app, [flags](const Session& session, ConsoleProgress& progress) {
                run_sun(*flags, session, progress);
            }};
}

}  // namespace gnomon::cli
