#include "sun_files.h"

#include <gnomon/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

namespace gnomon::cli {

namespace {

namespace fs = std::filesystem;

/// "hours.exr", or "hours.12.exr".
bool is_page(std::string_view name) {
    constexpr std::string_view kStem = "hours", kExtension = ".exr";
    if (!name.starts_with(kStem) || !name.ends_with(kExtension)) return false;
    name.remove_prefix(kStem.size());
    if (name == kExtension) return true;
    name.remove_suffix(kExtension.size());
    return name.size() > 1 && name.front() == '.' &&
           std::ranges::all_of(name.substr(1), [](char c) { return c >= '0' && c <= '9'; });
}

/// Of points that come one after the other, the number of each's plane, from 1.
class PlaneNumbers {
public:
    explicit PlaneNumbers(const std::vector<SunGrid>& grids) : grids_(grids) {}
    std::size_t next() {
        for (; left_ == 0; ++number_) {
            const Extent size = grids_[number_].size;
            left_ = std::size_t{size.width} * size.height;
        }
        --left_;
        return number_;
    }

private:
    const std::vector<SunGrid>& grids_;
    std::size_t number_ = 0, left_ = 0;
};

}  // namespace

void write_sun_hours_csv(const fs::path& path, const SunHoursResult& result,
                         const FileFrame& frame) {
    constexpr std::size_t kPiece_bytes = 1 << 20;  // of a file that can be as large as the result
    const bool texels = result.kind == SunPoints::texels;
    const bool period = result.days.sampled > 1;
    const bool grid = result.kind == SunPoints::grid;
    errno = 0;
    std::ofstream stream(path, std::ios::binary);
    std::string text = fmt::format("x,y,z,nx,ny,nz,{},{}{}\n", texels ? "area_m2" : "weight",
                                   period ? "hours_per_day,hours_in_period,hours_worst_day,"
                                            "longest_per_day,longest_worst_day"
                                          : "hours,longest",
                                   grid ? ",plane" : "");
    const FileFrame turn{.z_up = frame.z_up};
    const auto out = std::back_inserter(text);
    PlaneNumbers planes(result.grids);
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const SunSensor& point = result.points[i];
        const DVec3 p = frame.file_point_m(Vec3(point.position_ws));
        const DVec3 n = turn.file_point_m(Vec3(normalize(Vec3(point.normal_ws))));
        const SunHours& hours = result.hours[i];
        fmt::format_to(out, "{:.4f},{:.4f},{:.4f},{:.5g},{:.5g},{:.5g},{:.6g},", p.x, p.y, p.z, n.x,
                       n.y, n.z, result.weights[i]);
        if (period) {
            fmt::format_to(out, "{:.3f},{:.2f},{:.3f},{:.3f},{:.3f}", hours.mean_h,
                           hours.mean_h * static_cast<float>(result.days.period), hours.worst_h,
                           hours.longest_mean_h, hours.longest_worst_h);
        } else {
            fmt::format_to(out, "{:.3f},{:.3f}", hours.mean_h, hours.longest_mean_h);
        }
        if (grid) fmt::format_to(out, ",{}", planes.next());
        text += '\n';
        if (text.size() < kPiece_bytes) continue;
        stream << text;
        text.clear();
    }
    stream << text;
    stream.close();
    if (!stream) {
        throw Error(ErrorKind::machine,
                    fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
    }
}

void add_sun_hours(StagedFiles& files, const std::string& prefix, const Scene& scene,
                   const SunHoursResult& result, const FileFrame& frame, const Camera& camera,
                   Extent size, Progress& progress) {
    const Image top = sun_hours_picture(scene, result, top_camera(scene, size), size, progress);
    const Image view = sun_hours_picture(scene, result, camera, size, progress);
    const std::vector<Image> pages = sun_hours_pages(result);
    if (progress.cancelled()) throw Error(ErrorKind::cancelled, "cancelled");

    write_sun_hours_csv(files.add(prefix + "hours.csv"), result, frame);
    for (std::size_t page = 0; page < pages.size(); ++page) {
        const std::string number = pages.size() > 1 ? fmt::format(".{}", page) : std::string();
        write_exr(files.add(fmt::format("{}hours{}.exr", prefix, number)), pages[page]);
    }
    write_png(files.add(prefix + "top.png"), top);
    write_png(files.add(prefix + "view.png"), view);
}

void remove_other_pages(const fs::path& folder, const std::string& prefix,
                        const std::vector<fs::path>& written) {
    std::error_code error;
    std::vector<fs::path> others;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(prefix) && is_page(std::string_view(name).substr(prefix.size())) &&
            std::ranges::find(written, folder / name) == written.end()) {
            others.push_back(entry.path());
        }
    }
    for (const fs::path& other : others)
        fs::remove(other, error);
}

}  // namespace gnomon::cli
