#include <gnomon/bake.h>

#include "bake/json_mark.h"
#include "bake/json_member.h"
#include "base/check.h"
#include "base/file.h"
#include "base/folder.h"
#include "image/codec.h"

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>

namespace gnomon {

namespace {

namespace fs = std::filesystem;
using bake::JsonMember;
using nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::uint64_t kMostJson_bytes = 64 << 20;
constexpr std::uint64_t kMostTexture_bytes = std::uint64_t{1} << 30;
constexpr std::size_t kMostEntries = kMostJson_bytes;  ///< of a list: what the file has room for
constexpr int kNoRise8 = 255;                          ///< IntervalPage::kNoRise in 8 bits

std::string texture_name(std::size_t page, int pair, std::string_view what) {
    return "page" + std::to_string(page) + "-" + std::string(what) + std::to_string(pair) + ".png";
}

/// A pair's texels.
std::span<const std::uint16_t> pair_of(const IntervalPage& page,
                                       const std::vector<std::uint16_t>& values, int pair) {
    const std::size_t count = values.size() / static_cast<std::size_t>(page.pairs);
    return std::span(values).subspan(static_cast<std::size_t>(pair) * count, count);
}

void write_texture(const fs::path& path, unsigned side, std::span<const std::uint16_t> values,
                   BakeBits bits) {
    constexpr int kChannels = 4;
    std::vector<std::uint8_t> file;
    if (bits == BakeBits::sixteen) {
        file = image::encode_png16({side, side}, kChannels, values);
    } else {
        std::vector<std::uint8_t> bytes(values.size());
        std::ranges::transform(values, bytes.begin(), [](std::uint16_t value) {
            return static_cast<std::uint8_t>(std::min<unsigned>(value, kNoRise8));
        });
        file = image::encode_png8({side, side}, kChannels, bytes);
    }
    write_file(path, {reinterpret_cast<const char*>(file.data()), file.size()});
}

ordered_json json_of(const BakePath& path) {
    ordered_json directions = ordered_json::array();
    for (const DVec3& d : path.to_light_ws)
        directions.push_back({d.x, d.y, d.z});
    ordered_json json = {{"place", path.place},
                         {"date", path.date},
                         {"summary", path.summary},
                         {"begin_s", path.begin_s},
                         {"end_s", path.end_s},
                         {"angular_diameter_rad", path.angular_diameter_rad},
                         {"pole_ws", {path.pole_ws.x, path.pole_ws.y, path.pole_ws.z}},
                         {"to_light_ws", directions}};
    if (path.utc_offset) json["utc_offset"] = utc_offset_text(*path.utc_offset);
    return json;
}

ordered_json json_of(const BakeReport& report) {
    return {{"texels", report.texels},
            {"lit_texels", report.lit_texels},
            {"buried_texels", report.buried_texels},
            {"intervals", report.intervals},
            {"most_intervals", report.most_intervals},
            {"closed_gaps", report.closed_gaps},
            {"closed_share", report.closed_share},
            {"warnings", report.warnings}};
}

DVec3 vector_of(const JsonMember& member) {
    constexpr double kMost = std::numeric_limits<double>::max();
    const std::vector<JsonMember> axes = member.items(3, 3);
    return {axes[0].number(-kMost, kMost), axes[1].number(-kMost, kMost),
            axes[2].number(-kMost, kMost)};
}

DVec3 unit_vector_of(const JsonMember& member) {
    constexpr double kTolerance = 1e-5;  // what single precision and five digits leave
    const DVec3 vector = vector_of(member);
    if (!(std::abs(glm::length(vector) - 1.0) <= kTolerance)) member.fail("of length 1");
    return vector;
}

BakePath path_of(const JsonMember& json, BakeBits bits) {
    constexpr double kMost_s = std::numeric_limits<double>::max();
    BakePath path{
        .to_light_ws = {},
        .pole_ws = unit_vector_of(json.at("pole_ws")),
        .begin_s = json.at("begin_s").number(-kMost_s, kMost_s),
        .end_s = json.at("end_s").number(-kMost_s, kMost_s),
        .angular_diameter_rad = json.at("angular_diameter_rad").number(0.0, std::numbers::pi),
        .place = json.at("place").text(),
        .date = json.at("date").text(),
        .summary = json.at("summary").text()};
    // Bakes of earlier versions have none.
    if (json.has("utc_offset")) {
        const JsonMember offset = json.at("utc_offset");
        path.utc_offset = parse_utc_offset(offset.label(), offset.text());
    }
    if (!(path.end_s > path.begin_s))
        json.at("end_s").fail(fmt::format("more than path.begin_s, {:.7g}", path.begin_s));
    const auto most = static_cast<std::size_t>(most_steps(bits));
    for (const JsonMember& direction : json.at("to_light_ws").items(1, most))
        path.to_light_ws.push_back(unit_vector_of(direction));
    return path;
}

BakeReport report_of(const JsonMember& json) {
    const auto count = [&](std::string_view name) {
        return static_cast<std::uint64_t>(
            json.at(name).integer(0, std::numeric_limits<std::int64_t>::max()));
    };
    BakeReport report{.texels = count("texels"),
                      .lit_texels = count("lit_texels"),
                      .intervals = count("intervals"),
                      .buried_texels = count("buried_texels"),
                      .most_intervals = static_cast<int>(
                          json.at("most_intervals").integer(0, most_steps(BakeBits::sixteen))),
                      .closed_gaps = count("closed_gaps"),
                      .closed_share = json.at("closed_share").number(0.0, 1.0),
                      .warnings = {}};
    for (const JsonMember& warning : json.at("warnings").items(0, kMostEntries))
        report.warnings.push_back(warning.text());
    return report;
}

BakeBits bits_of(const JsonMember& json) {
    const JsonMember member = json.at("bits");
    const auto bits = static_cast<BakeBits>(member.integer(8, 16));
    if (bits != BakeBits::eight && bits != BakeBits::sixteen) member.fail("8 or 16");
    const JsonMember codes = json.at("codes_per_step");
    if (codes.integer(1, codes_per_step(BakeBits::sixteen)) != codes_per_step(bits)) {
        codes.fail(fmt::format("{}, of {} bits", codes_per_step(bits), static_cast<int>(bits)));
    }
    return bits;
}

/// Appends rises or falls, none of them after the path's end.
void append_texture(const fs::path& path, unsigned side, bool is_rise, const IntervalBake& bake,
                    std::vector<std::uint16_t>& values) {
    const image::Rgba16 texture =
        image::decode_png_numbers(read_file(path, kMostTexture_bytes), path.string());
    if (texture.size != Extent{side, side}) {
        fail_input("{}: is {}x{}; bake.json says {}x{}", path.string(), texture.size.width,
                   texture.size.height, side, side);
    }
    const int bits = static_cast<int>(bake.bits);
    if (texture.bits != bits) {
        fail_input("{}: has numbers of {} bits; bake.json says that bits is {}", path.string(),
                   texture.bits, bits);
    }
    const int steps = bake.path.steps();
    const int most = steps * bake.codes_per_step();
    const int none = bits == 8 ? kNoRise8 : IntervalPage::kNoRise;
    for (const std::uint16_t value : texture.rgba) {
        const bool is_none = is_rise && value == none;
        if (value > most && !is_none) {
            fail_input(
                "{}: holds the time {}; 0 to {} is allowed, as path.to_light_ws of "
                "bake.json has {} steps",
                path.string(), value, most, steps);
        }
        values.push_back(is_none ? IntervalPage::kNoRise : value);
    }
}

IntervalPage page_of(const fs::path& folder, std::size_t index, const JsonMember& json,
                     const IntervalBake& bake) {
    IntervalPage page{
        .side_texels =
            static_cast<unsigned>(json.at("side_texels").integer(1, image::kMaxDecodedSide_px)),
        .pairs = static_cast<int>(json.at("pairs").integer(1, IntervalPage::kMostPairs)),
        .rises = {},
        .falls = {}};
    for (int pair = 0; pair < page.pairs; ++pair) {
        append_texture(folder / texture_name(index, pair, "rise"), page.side_texels, true, bake,
                       page.rises);
        append_texture(folder / texture_name(index, pair, "fall"), page.side_texels, false, bake,
                       page.falls);
    }
    return page;
}

IntervalBake bake_of(const fs::path& folder, const JsonMember& json) {
    if (json.at("gnomon_bake").integer(1, std::numeric_limits<int>::max()) != kVersion) {
        json.at("gnomon_bake")
            .fail(fmt::format("{}, the version that this Gnomon reads", kVersion));
    }
    IntervalBake bake;
    bake.bits = bits_of(json);
    bake.path = path_of(json.at("path"), bake.bits);
    bake.report = report_of(json.at("report"));
    const std::vector<JsonMember> pages = json.at("pages").items(1, kMostEntries);
    std::vector<JsonMember> mesh_pages = json.at("mesh_pages").items(1, kMostEntries);
    for (const JsonMember& page : mesh_pages) {
        bake.mesh_pages.push_back(static_cast<std::uint32_t>(
            page.integer(0, static_cast<std::int64_t>(pages.size()) - 1)));
    }
    bake.scene = load_scene((folder / "scene.glb").string());
    const std::size_t meshes = bake.scene.meshes().size();
    json.at("mesh_pages").items(meshes, meshes);
    for (std::size_t p = 0; p < pages.size(); ++p)
        bake.pages.push_back(page_of(folder, p, pages[p], bake));
    return bake;
}

FolderKind bake_kind() {
    return {
        .noun = "bake",
        .mark = "bake.json",
        .has_entry =
            [](std::string_view name) {
                return name == "scene.glb" || (name.starts_with("page") && name.ends_with(".png"));
            },
        .is_mark = [](const fs::path& mark) { return bake::is_json_with(mark, "gnomon_bake"); }};
}

}  // namespace

void check_bake_folder(const fs::path& folder) {
    check_replaceable(folder, bake_kind());
}

void write_bake(const fs::path& folder, const IntervalBake& bake) {
    replace_folder(folder, bake_kind(), [&](const fs::path& inside) {
        ordered_json pages = ordered_json::array();
        for (std::size_t p = 0; p < bake.pages.size(); ++p) {
            const IntervalPage& page = bake.pages[p];
            pages.push_back({{"side_texels", page.side_texels}, {"pairs", page.pairs}});
            for (int pair = 0; pair < page.pairs; ++pair) {
                write_texture(inside / texture_name(p, pair, "rise"), page.side_texels,
                              pair_of(page, page.rises, pair), bake.bits);
                write_texture(inside / texture_name(p, pair, "fall"), page.side_texels,
                              pair_of(page, page.falls, pair), bake.bits);
            }
        }
        write_glb(inside / "scene.glb", bake.scene);
        const ordered_json json = {{"gnomon_bake", kVersion},
                                   {"bits", static_cast<int>(bake.bits)},
                                   {"codes_per_step", bake.codes_per_step()},
                                   {"path", json_of(bake.path)},
                                   {"pages", pages},
                                   {"mesh_pages", bake.mesh_pages},
                                   {"report", json_of(bake.report)}};
        write_file(inside / "bake.json", json.dump(1) + "\n");
    });
}

IntervalBake read_bake(const fs::path& folder) {
    const fs::path file = folder / "bake.json";
    const nlohmann::json json = bake::parse_json(read_file(file, kMostJson_bytes), file.string());
    return bake_of(folder, JsonMember(json, file.string()));
}

}  // namespace gnomon
