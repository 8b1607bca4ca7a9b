// Are a mesh's texture coordinates a light map? Overlap is looked for on the grid of texels itself:
// a centre may lie in one triangle only, and the texels that two islands touch must be farther
// apart than the padding.

#include "lightmap/texcoords.h"

#include "base/parallel.h"
#include "lightmap/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace gnomon::lightmap {

namespace {

/// Coordinates this far beyond [0, 1] are on its border to float's precision.
constexpr float kOutside = 1e-5f;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

double doubled_area(const Corners& c) {
    const dvec2 a = c[1] - c[0];
    const dvec2 b = c[2] - c[0];
    return a.x * b.y - a.y * b.x;
}

/// The coordinates of a face's corners.
std::array<Vec2, 3> face_texcoords(const Mesh& mesh, const std::vector<Vec2>& set,
                                   const Face& face) {
    std::array<Vec2, 3> uv;
    for (std::size_t i = 0; i < 3; ++i)
        uv[i] = set[mesh.triangles[face.triangle][face.from[i]]];
    return uv;
}

/// No higher than what rounding coordinates up to 1 to float can have made; in units of the set.
bool without_area(const std::array<Vec2, 3>& uv) {
    const Corners c{dvec2(uv[0]), dvec2(uv[1]), dvec2(uv[2])};
    const double longest =
        std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])});
    return !(std::abs(doubled_area(c)) >
             longest * static_cast<double>(std::numeric_limits<float>::epsilon()));
}

/// The side of the page that the set was made for, if it was made for these texels: islands lie on
/// whole texels then, and keep their distances. Texels may become 1 % larger or smaller for it.
double whole_side(double side_texels) {
    constexpr double kTolerated = 0.01;
    const double whole = std::round(side_texels);
    return std::abs(whole - side_texels) <= kTolerated * side_texels ? whole : side_texels;
}

std::vector<std::uint32_t> find_islands(const std::vector<Face>& faces,
                                        const std::vector<std::array<Vec2, 3>>& texcoords) {
    std::map<std::tuple<std::uint32_t, float, float>, std::uint32_t> numbers;
    std::vector<std::array<std::uint32_t, 3>> corners(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto next = static_cast<std::uint32_t>(numbers.size());
            const Vec2 uv = texcoords[f][i];
            corners[f][i] =
                numbers.try_emplace({faces[f].places[i], uv.x, uv.y}, next).first->second;
        }
    }
    return components(corners);
}

/// Numbers of the islands that touch the texels, the least and the greatest of each.
class IslandGrid {
public:
    explicit IslandGrid(const SetLayout& layout)
        : width_(static_cast<int>(layout.size.width)),
          height_(static_cast<int>(layout.size.height)),
          low_(std::size_t{layout.size.width} * layout.size.height, kNone),
          high_(low_.size(), 0) {
        for (std::size_t f = 0; f < layout.corners.size(); ++f) {
            for_texels(layout.corners[f], [&](std::size_t i) {
                low_[i] = std::min(low_[i], layout.islands[f]);
                high_[i] = std::max(high_[i], layout.islands[f]);
            });
        }
    }

    /// Over a square of texels about each, one axis after the other.
    void spread(int radius) {
        spread(radius, width_, height_, 1, width_);
        spread(radius, height_, width_, width_, 1);
    }

    bool touches_other(const Corners& corners, std::uint32_t island) const {
        bool other = false;
        for_texels(corners, [&](std::size_t i) { other |= low_[i] < island || high_[i] > island; });
        return other;
    }

private:
    template <typename Visit>
    void for_texels(const Corners& corners, const Visit& visit) const {
        for_touched(corners, [&](int y, int begin, int end) {
            if (y < 0 || y >= height_) return;
            for (int x = std::max(begin, 0); x < std::min(end, width_); ++x)
                visit(static_cast<std::size_t>(y) * width_ + x);
        });
    }

    void spread(int radius, int length, int lines, int step, int line_step) {
        std::vector<std::uint32_t> low(static_cast<std::size_t>(length));
        std::vector<std::uint32_t> high(low.size());
        for (int line = 0; line < lines; ++line) {
            const std::size_t start = static_cast<std::size_t>(line) * line_step;
            const auto at = [&](int i) { return start + static_cast<std::size_t>(i) * step; };
            for (int i = 0; i < length; ++i) {
                low[i] = kNone;
                high[i] = 0;
                for (int j = std::max(i - radius, 0); j <= std::min(i + radius, length - 1); ++j) {
                    low[i] = std::min(low[i], low_[at(j)]);
                    high[i] = std::max(high[i], high_[at(j)]);
                }
            }
            for (int i = 0; i < length; ++i) {
                low_[at(i)] = low[i];
                high_[at(i)] = high[i];
            }
        }
    }

    int width_, height_;
    std::vector<std::uint32_t> low_, high_;
};

/// Faces that share the centre of a texel with another.
unsigned count_overlapping(const SetLayout& layout) {
    const int width = static_cast<int>(layout.size.width);
    const int height = static_cast<int>(layout.size.height);
    std::vector<std::uint32_t> owner(std::size_t{layout.size.width} * layout.size.height, kNone);
    std::vector<char> overlaps(layout.corners.size(), 0);
    for (std::uint32_t f = 0; f < layout.corners.size(); ++f) {
        for_centres(layout.corners[f], [&](int y, int begin, int end) {
            if (y < 0 || y >= height) return;
            for (int x = std::max(begin, 0); x < std::min(end, width); ++x) {
                std::uint32_t& texel = owner[static_cast<std::size_t>(y) * width + x];
                if (texel != kNone) overlaps[f] = overlaps[texel] = 1;
                texel = f;
            }
        });
    }
    return static_cast<unsigned>(std::ranges::count(overlaps, 1));
}

unsigned count_flipped(const SetLayout& layout) {
    std::map<std::uint32_t, double> signed_area;
    for (std::size_t f = 0; f < layout.corners.size(); ++f)
        signed_area[layout.islands[f]] += doubled_area(layout.corners[f]);
    unsigned flipped = 0;
    for (std::size_t f = 0; f < layout.corners.size(); ++f)
        flipped += doubled_area(layout.corners[f]) * signed_area[layout.islands[f]] < 0.0;
    return flipped;
}

std::string counted(unsigned count, std::string_view one, std::string_view many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// "12 triangles overlap, 2 are flipped in TEXCOORD_1".
std::string description(const TexcoordFaults& faults, int set, const Options& options) {
    const std::string_view name = set == 1 ? "TEXCOORD_1" : "its texture's coordinates";
    if (faults.side_texels > 0) {
        return fmt::format("{} would be {} texels wide, more than a page of {}", name,
                           faults.side_texels, options.max_page_texels);
    }
    std::string text;
    const auto add = [&](unsigned count, std::string_view one, std::string_view many) {
        if (count == 0) return;
        if (text.empty()) {
            text = fmt::format("{} {} {}", count, count == 1 ? "triangle" : "triangles",
                               count == 1 ? one : many);
        } else {
            text += ", " + counted(count, one, many);
        }
    };
    add(faults.outside, "lies outside [0, 1]", "lie outside [0, 1]");
    add(faults.no_area, "has no area", "have no area");
    add(faults.flipped, "is flipped", "are flipped");
    add(faults.overlapping, "overlaps", "overlap");
    const std::string near =
        fmt::format("within {} texels of another island", options.padding_texels);
    add(faults.crowded, "is " + near, "are " + near);
    return fmt::format("{} in {}", text, name);
}

/// The first instance's faults, or none. Instances of one size in texels are checked once.
TexcoordFaults check_instances(const Scene& scene, const std::vector<std::uint32_t>& instances,
                               int set, const Options& options) {
    std::set<std::pair<unsigned, unsigned>> checked;
    for (const std::uint32_t instance : instances) {
        const Mesh& mesh = scene.meshes()[scene.instances()[instance].mesh];
        const Surface surface(scene, instance, false);
        if (surface.faces().empty()) continue;
        const Extent size = lay_out(mesh, set, surface.faces(), options.texel_size_m).size;
        if (!checked.insert({size.width, size.height}).second) continue;
        const TexcoordFaults faults = check_texcoords(mesh, set, surface.faces(), options);
        if (!faults.none()) return faults;
    }
    return {};
}

}  // namespace

const std::vector<Vec2>& texcoord_set(const Mesh& mesh, int set) {
    return set == 1 ? mesh.lightmap_texcoords : mesh.texcoords;
}

SetLayout lay_out(const Mesh& mesh, int set, const std::vector<Face>& faces, double texel_size_m) {
    SetLayout layout;
    std::vector<std::array<Vec2, 3>> texcoords;
    double world_m2 = 0.0;
    double flat = 0.0;
    dvec2 low(std::numeric_limits<double>::infinity());
    dvec2 high = -low;
    for (const Face& face : faces) {
        texcoords.push_back(face_texcoords(mesh, texcoord_set(mesh, set), face));
        const auto& uv = texcoords.back();
        world_m2 += face.area_m2;
        flat += 0.5 * std::abs(doubled_area({dvec2(uv[0]), dvec2(uv[1]), dvec2(uv[2])}));
        for (const Vec2 corner : uv) {
            low = glm::min(low, dvec2(corner));
            high = glm::max(high, dvec2(corner));
        }
    }
    if (!(flat > 0.0)) return layout;
    const double texels_per_unit = whole_side(std::sqrt(world_m2 / flat) / texel_size_m);
    const dvec2 first = glm::floor(texels_per_unit * low + kBorder_texels);
    const dvec2 size = texels_per_unit * high - first;
    // Beyond any page: not to be counted in unsigned numbers.
    constexpr double kHuge_texels = 1e9;
    layout.size = {texels_for(std::min(size.x, kHuge_texels)),
                   texels_for(std::min(size.y, kHuge_texels))};
    for (const auto& uv : texcoords) {
        Corners& corners = layout.corners.emplace_back();
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = texels_per_unit * dvec2(uv[i]) - first;
    }
    layout.islands = find_islands(faces, texcoords);
    return layout;
}

TexcoordFaults check_texcoords(const Mesh& mesh, int set, const std::vector<Face>& faces,
                               const Options& options) {
    TexcoordFaults faults;
    for (const Face& face : faces) {
        const auto uv = face_texcoords(mesh, texcoord_set(mesh, set), face);
        faults.outside += std::ranges::any_of(uv, [](Vec2 p) {
            return std::min(p.x, p.y) < -kOutside || std::max(p.x, p.y) > 1.0f + kOutside;
        });
        faults.no_area += without_area(uv);
    }
    if (faults.outside > 0) return faults;
    const SetLayout layout = lay_out(mesh, set, faces, options.texel_size_m);
    if (layout.corners.empty()) return faults;
    const unsigned side = std::max(layout.size.width, layout.size.height);
    if (side + options.padding_texels > options.max_page_texels) {
        faults.side_texels = side;
        return faults;
    }
    faults.flipped = count_flipped(layout);
    faults.overlapping = count_overlapping(layout);
    IslandGrid grid(layout);
    grid.spread(static_cast<int>(options.padding_texels));
    for (std::size_t f = 0; f < faces.size(); ++f)
        faults.crowded += grid.touches_other(layout.corners[f], layout.islands[f]);
    return faults;
}

std::vector<int> choose_texcoords(const Scene& scene, const Options& options, Progress& progress,
                                  std::vector<std::string>& warnings) {
    constexpr std::string_view kTask = "checking texture coordinates";
    std::vector<std::vector<std::uint32_t>> instances(scene.meshes().size());
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i)
        instances[scene.instances()[i].mesh].push_back(i);
    std::vector<int> chosen(scene.meshes().size(), -1);
    // One after the other, as a check holds grids of a page's size.
    for (std::size_t m = 0; m < chosen.size() && options.keep_texcoords; ++m) {
        throw_if_cancelled(progress, kTask);
        const Mesh& mesh = scene.meshes()[m];
        std::string fault;
        for (const int set : {1, 0}) {
            if (texcoord_set(mesh, set).empty() || instances[m].empty() || chosen[m] >= 0) continue;
            const TexcoordFaults faults = check_instances(scene, instances[m], set, options);
            if (faults.none()) chosen[m] = set;
            if (!faults.none() && fault.empty()) fault = description(faults, set, options);
        }
        if (!fault.empty()) {
            warnings.push_back(fmt::format("mesh \"{}\": {}: {}", mesh.name, fault,
                                           chosen[m] < 0 ? "it gets coordinates of its own"
                                                         : "its texture's coordinates serve"));
        }
        progress.report(kTask, static_cast<double>(m + 1) / static_cast<double>(chosen.size()));
    }
    return chosen;
}

}  // namespace gnomon::lightmap
