#pragma once

#include <gnomon/light.h>
#include <gnomon/light_path.h>
#include <gnomon/math.h>
#include <gnomon/progress.h>
#include <gnomon/scene.h>
#include <gnomon/sun.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

/// Occlusion interval maps: when, on a light's known path, each texel of a static scene sees it.
/// W. Donnelly, J. Demers, "Generating Soft Shadows Using Occlusion Interval Maps", GPU Gems, 2004,
/// chapter 13. docs/bakes.md tells of the files.
namespace gnomon {

/// The way of a light that is far away, in even steps of time. Step k is the span [k, k + 1) and
/// the direction that of its middle.
struct BakePath {
    std::vector<DVec3> to_light_ws;     ///< unit vectors, 1 to 1023
    DVec3 pole_ws{0.0, 1.0, 0.0};       ///< what the light turns about, as near as can be
    double begin_s = 0.0, end_s = 0.0;  ///< the clock before the first step and after the last,
                                        ///< since local midnight
    std::optional<std::chrono::minutes> utc_offset;  ///< of that clock; none for a light that is
                                                     ///< no sun
    double angular_diameter_rad = 0.0;               ///< of the light's disc
    std::string place, date;  ///< as the user gave them; empty for a light that is no sun
    std::string summary;      ///< in words, one line

    int steps() const { return static_cast<int>(to_light_ws.size()); }
};

/// The sun's path of a day; no steps in a polar night.
BakePath bake_path(const SunPath& path, std::string place, std::string date);

/// Another light's path, from its first key to its last, whose times are the clock. Throws
/// Error{input} for positions, for a single key, for steps that LightPath::steps() refuses and for
/// a diameter that is not 0 to pi.
BakePath bake_path(const LightPath& path, int steps, double angular_diameter_rad);

enum class BakeBits {
    eight = 8,  ///< exact to the step, of which there are at most 255
    /// Exact to a 64th of a step, a second of 1023 steps of a day; what is shorter than a step can
    /// be missed.
    sixteen = 16,
};

/// The parts of a step that a code tells apart.
constexpr int codes_per_step(BakeBits bits) {
    return bits == BakeBits::eight ? 1 : 64;
}

/// The steps of a path whose codes those bits hold.
constexpr int most_steps(BakeBits bits) {
    return bits == BakeBits::eight ? 255 : 1023;
}

/// How the steps are found at which a texel sees the light.
enum class BakeMethod {
    interval_traversal,  ///< one walk of the scene for many texels and all steps
    /// A ray for each texel and step, the chapter's way: slower, and what the other is held
    /// against. They differ in less than 1 of 100,000 texels' steps, at edges.
    rays,
};

struct BakeOptions {
    double texel_size_m = 0.1;
    BakeBits bits = BakeBits::eight;
    BakeMethod method = BakeMethod::interval_traversal;
    int most_pairs = 4;  ///< of textures; each pair holds four intervals; 1 to 16
    bool ignore_alpha = false;
    std::uint64_t memory_limit_bytes = 0;       ///< 0 = the machine's memory
    std::string texel_option = "texel_size_m";  ///< what errors call the size: as its user does
    /// Where a bake keeps what it has when it is interrupted, and when it is done: to be removed
    /// once write_bake() has worked, because without it that begins here again. Empty: nowhere.
    std::filesystem::path resume_file;
};

/// The intervals of one page's texels, in codes: times in units of 1 / codes_per_step of a step.
struct IntervalPage {
    static constexpr std::uint16_t kNoRise = std::numeric_limits<std::uint16_t>::max();
    static constexpr std::size_t kIntervalsPerPair = 4;
    static constexpr int kMostPairs = 16;

    unsigned side_texels = 0;
    int pairs = 1;
    /// pairs x side x side x 4, rows from the top: channel c of pair p begins and ends interval
    /// 4 p + c. Where there is none the rise is kNoRise and the fall 0. Texels beside charts repeat
    /// what is nearest.
    std::vector<std::uint16_t> rises, falls;
};
static_assert(most_steps(BakeBits::sixteen) * codes_per_step(BakeBits::sixteen) <
              IntervalPage::kNoRise);

struct BakeReport {
    std::uint64_t texels = 0, lit_texels = 0, intervals = 0;
    std::uint64_t buried_texels = 0;  ///< wholly inside of solids: they repeat a neighbour's
    int most_intervals = 0;           ///< of a texel
    std::uint64_t closed_gaps = 0;    ///< for want of pairs
    double closed_share = 0.0;        ///< of all texels' time: lit where it is dark
    std::vector<std::string> warnings;
};

/// A sentence on the gaps that were closed, and on the error that this makes; empty when none was.
std::string closed_gaps_text(const BakeReport& report);

struct IntervalBake {
    Scene scene;                            ///< TEXCOORD_1 is the place on the page
    std::vector<std::uint32_t> mesh_pages;  ///< the page of each mesh
    BakePath path;
    BakeBits bits = BakeBits::eight;
    std::vector<IntervalPage> pages;
    BakeReport report;

    int codes_per_step() const { return gnomon::codes_per_step(bits); }
};

/// Bakes on all threads; the result is the same for any number of them. Throws Error{input} for
/// options out of range, for a `resume_file` that is not of this bake, for a scene without area or
/// of more texels than fit in memory, saying what would; Error{machine} when the disk of
/// `resume_file` has no room for it; Error{cancelled}, after it is written.
IntervalBake bake_intervals(const Scene& scene, const BakePath& path, const BakeOptions& options,
                            Progress& progress);

/// Whether the file is one in which bake_intervals() keeps its work, of any bake.
bool is_unfinished_bake(const std::filesystem::path& file);

/// Writes DIR/bake.json, scene.glb and the textures; the folder appears whole or not at all, and
/// replaces an older bake there. Throws Error{input} when it holds anything else, Error{machine}.
void write_bake(const std::filesystem::path& folder, const IntervalBake& bake);

/// To be asked before a bake: whether write_bake() can put its folder there. Throws Error{input}.
void check_bake_folder(const std::filesystem::path& folder);

/// Throws Error{input} naming the file and the fault.
IntervalBake read_bake(const std::filesystem::path& folder);

/// How many steps of its path the light's disc covers, the window of interval_visibility(); at
/// least one code, because times are no finer. A path of one step is wholly covered.
double disc_width_steps(const BakePath& path, int codes_per_step);

/// The light at a time of the path's clock, of irradiance 1. Throws Error{input} when it is not
/// from begin_s to end_s, and for a path of no steps.
DirectionalLight light_at(const BakePath& path, double clock_s);

/// What a window that reaches beyond its path's ends finds there: what is lit or dark at an end on.
struct PathEnds {
    double path_steps = 0.0;  ///< the length of the path, if anything below is true
    bool closed = false;      ///< the first step comes after the last, as in 24 hours of sun
    /// Otherwise: what the light shines on at that end it goes on to shine on. Else it is below the
    /// horizon there, and all is dark.
    bool begins_up = false, ends_up = false;
};

/// Of a path whose up is +Y: it closes when the last step leads to the first, and an end is up when
/// the sun's whole disc would be.
PathEnds path_ends(const BakePath& path);

/// The part of the path that a light covers.
struct LightWindow {
    double at_step = 0.0;      ///< of its centre
    double width_steps = 0.0;  ///< of its disc
    int codes_per_step = 1;    ///< of the bake
    bool even = false;  ///< as if it were a line along the path, as in listing 13-1, not a disc
    PathEnds ends{};
};

/// How much of the light the texel sees, in [0, 1].
double interval_visibility(const IntervalPage& page, unsigned x, unsigned y,
                           const LightWindow& window);

}  // namespace gnomon
