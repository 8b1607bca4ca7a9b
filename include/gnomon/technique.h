#pragma once

#include <gnomon/visibility.h>

#include <initializer_list>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gnomon {

struct IntervalBake;

/// A parameter's value: a switch, a whole number, a number, or one of a list of words.
using ParamValue = std::variant<bool, int, double, std::string>;

enum class ParamType { boolean, integer, number, choice };

/// What a technique says about one of its parameters. Flags, documentation and range checks read
/// it.
struct ParamInfo {
    std::string name;  ///< snake_case
    ParamType type = ParamType::number;
    ParamValue default_value;
    double min = 0.0, max = 0.0;       ///< inclusive; integer and number only
    std::vector<std::string> choices;  ///< choice only
    std::string unit;                  ///< "texels", "px", "1"; empty for switches and choices
    std::string meaning;               ///< one line
};

/// Parameter values by name; what is not named keeps its default.
class Params {
public:
    Params() = default;
    Params(std::initializer_list<std::pair<const std::string, ParamValue>> values)
        : values_(values) {}
    void set(const std::string& name, ParamValue value) { values_[name] = std::move(value); }
    const std::map<std::string, ParamValue>& values() const { return values_; }

private:
    std::map<std::string, ParamValue> values_;
};

/// `text` as a value of `info`'s type, checked against its range.
/// Throws Error{input} that names `technique`, the parameter, the value and what is allowed.
ParamValue parse_param(std::string_view technique, const ParamInfo& info, std::string_view text);

/// "4", "0.8", "true" or the word itself.
std::string to_string(const ParamValue& value);

/// The parameter of that name; dashes count as underscores.
/// Throws Error{input} that suggests the nearest name when there is none.
const ParamInfo& find_param(std::string_view technique, std::span<const ParamInfo> params,
                            std::string_view name);

struct PassTime {
    std::string name;
    double ms = 0.0;
};

/// What the last render() took.
struct RenderStats {
    double cpu_ms = 0.0;             ///< recording and host work, waiting for the device left out
    double gpu_ms = 0.0;             ///< sum of the passes
    std::vector<PassTime> passes;    ///< device time each, in order
    std::uint64_t memory_bytes = 0;  ///< held by the technique, the scene's own buffers left out
    std::string note;                ///< what the technique chose by itself and why; often nothing
    std::string warning;  ///< what it could not do as it was asked to, a sentence; mostly nothing
};

/// One way to answer: how much of this light does each receiver see?
class Technique {
public:
    virtual ~Technique() = default;

    /// Once per scene: adjacency, acceleration structures, bakes. May take minutes; reports
    /// progress and can be cancelled. render() prepares by itself when the frame has another scene.
    virtual void prepare(const Scene& scene, Progress& progress) = 0;
    void prepare(const Scene& scene);

    /// Once per frame and light: the visibility of `frame.light` at every receiver. Techniques on
    /// the host report progress and can be cancelled.
    /// Throws Error{input} for lights that the technique cannot shadow, Error{cancelled}.
    virtual void render(const Frame& frame, Visibility& out, Progress& progress) = 0;
    void render(const Frame& frame, Visibility& out);
    Visibility render(const Frame& frame);

    virtual RenderStats last_render() const = 0;
};

/// Kinds of light, as bits.
enum class LightKinds : unsigned {
    none = 0,
    directional = 1,
    point = 2,
    spot = 4,
    sphere = 8,
    disc = 16,
    rect = 32,
    all = 63,
};
constexpr LightKinds operator|(LightKinds a, LightKinds b) {
    return static_cast<LightKinds>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
bool supports(LightKinds kinds, const Light& light);
/// In the words of light_kind().
std::vector<std::string_view> light_kinds(LightKinds kinds);

enum class Penumbra { none, fixed_width, physical };

/// What a technique says about itself before any device exists.
struct TechniqueInfo {
    std::string_view name;  ///< "shadow_map": folder, command line, Python and report use this name
    std::string_view title;                ///< "Shadow map"
    std::string_view source;               ///< keys into docs/references.bib, separated by commas
    LightKinds lights = LightKinds::none;  ///< the lights it can shadow; others throw
    Penumbra penumbra = Penumbra::none;    ///< with default parameters
    bool honors_alpha = true;              ///< false: alpha masks count as solid
    bool self_shadows = true;              ///< false: no instance casts shadows on itself
    /// The parameters that say how a bake is looked up; empty: it looks up none.
    std::span<const std::string_view> lookup_params = {};
    const std::vector<ParamInfo>& (*params)() = nullptr;
    std::unique_ptr<Technique> (*make)(Context&, const Params&) = nullptr;
};

/// All techniques, in alphabetical order.
std::span<const TechniqueInfo> techniques();

/// Throws Error{input} that suggests the nearest name when there is none.
const TechniqueInfo& find_technique(std::string_view name);

/// Without a name the one that chooses by device, light and view. Throws Error{input} for an
/// unknown technique or parameter and for a value out of range.
std::unique_ptr<Technique> make_technique(Context& context, std::string_view name = "auto",
                                          const Params& params = {});

/// The one with lookup_params.
const TechniqueInfo& bake_technique();

/// The technique bake_technique() for a bake that is there: it looks that up and bakes nothing, for
/// frames of the bake's scene and with lights on its path. Of its parameters its lookup_params may
/// be set; others are the bake's. As in the page of write_web() the light covers
/// disc_width_steps(). Texels are asked about their centres, and there are no fine cells, which
/// files do not hold.
///
///     const IntervalBake bake = read_bake("day");  // <gnomon/bake.h>
///     const auto maps = make_technique(context, bake);
///     const Frame frame{.scene = bake.scene,
///                       .camera = bake.scene.cameras().at(0),
///                       .light = light_at(bake.path, 10.5 * 3600.0)};
///     const Visibility visibility = maps->render(frame);
///
/// Throws Error{input} for another parameter, and naming a mesh that has no places on a page.
std::unique_ptr<Technique> make_technique(Context& context, const IntervalBake& bake,
                                          const Params& params = {});

}  // namespace gnomon
