#include <gnomon/bake.h>

#include "bake/json_mark.h"
#include "base/check.h"
#include "base/file.h"
#include "base/folder.h"
#include "image/codec.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>

namespace gnomon {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::uint64_t kMostJson_bytes = 64 << 20;
constexpr std::uint64_t kMostTexture_bytes = std::uint64_t{1} << 30;

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
            return static_cast<std::uint8_t>(std::min<unsigned>(value, 255));
        });
        file = image::encode_png8({side, side}, kChannels, bytes);
    }
    write_file(path, {reinterpret_cast<const char*>(file.data()), file.size()});
}

ordered_json json_of(const BakePath& path) {
    ordered_json directions = ordered_json::array();
    for (const DVec3& d : path.to_light_ws)
        directions.push_back({d.x, d.y, d.z});
    return {{"place", path.place},
            {"date", path.date},
            {"summary", path.summary},
            {"begin_s", path.begin_s},
            {"end_s", path.end_s},
            {"angular_diameter_rad", path.angular_diameter_rad},
            {"pole_ws", {path.pole_ws.x, path.pole_ws.y, path.pole_ws.z}},
            {"to_light_ws", directions}};
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

DVec3 vector_of(const nlohmann::json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

BakePath path_of(const nlohmann::json& json) {
    BakePath path{.to_light_ws = {},
                  .pole_ws = vector_of(json.at("pole_ws")),
                  .begin_s = json.at("begin_s"),
                  .end_s = json.at("end_s"),
                  .angular_diameter_rad = json.at("angular_diameter_rad"),
                  .place = json.at("place"),
                  .date = json.at("date"),
                  .summary = json.at("summary")};
    for (const nlohmann::json& direction : json.at("to_light_ws"))
        path.to_light_ws.push_back(vector_of(direction));
    return path;
}

BakeReport report_of(const nlohmann::json& json) {
    return {.texels = json.at("texels"),
            .lit_texels = json.at("lit_texels"),
            .intervals = json.at("intervals"),
            .buried_texels = json.at("buried_texels"),
            .most_intervals = json.at("most_intervals"),
            .closed_gaps = json.at("closed_gaps"),
            .closed_share = json.at("closed_share"),
            .warnings = json.at("warnings")};
}

void append_texture(const fs::path& path, unsigned side, bool is_rise, BakeBits bits,
                    std::vector<std::uint16_t>& values) {
    const image::Rgba16 texture =
        image::decode_png_numbers(read_file(path, kMostTexture_bytes), path.string());
    if (texture.size != Extent{side, side}) {
        fail_input("{}: is {}x{}; bake.json says {}x{}", path.string(), texture.size.width,
                   texture.size.height, side, side);
    }
    for (const std::uint16_t value : texture.rgba) {
        const bool is_none = is_rise && bits == BakeBits::eight && value == 255;
        values.push_back(is_none ? IntervalPage::kNoRise : value);
    }
}

IntervalBake bake_of(const fs::path& folder, const nlohmann::json& json) {
    if (json.at("gnomon_bake") != kVersion) {
        fail_input("{}: is of version {}; this Gnomon reads version {}",
                   (folder / "bake.json").string(), json.at("gnomon_bake").dump(), kVersion);
    }
    IntervalBake bake;
    const int bits = json.at("bits");
    if (bits != 8 && bits != 16)
        fail_input("{}: bits is {}; it must be 8 or 16", (folder / "bake.json").string(), bits);
    bake.bits = static_cast<BakeBits>(bits);
    bake.path = path_of(json.at("path"));
    bake.report = report_of(json.at("report"));
    bake.mesh_pages = json.at("mesh_pages").get<std::vector<std::uint32_t>>();
    bake.scene = load_scene((folder / "scene.glb").string());
    for (std::size_t p = 0; p < json.at("pages").size(); ++p) {
        const nlohmann::json& entry = json.at("pages").at(p);
        IntervalPage page{.side_texels = entry.at("side_texels"),
                          .pairs = entry.at("pairs"),
                          .rises = {},
                          .falls = {}};
        if (page.side_texels == 0 || page.pairs < 1) {
            fail_input("{}: page {} has {} texels a side and {} pairs",
                       (folder / "bake.json").string(), p, page.side_texels, page.pairs);
        }
        for (int pair = 0; pair < page.pairs; ++pair) {
            append_texture(folder / texture_name(p, pair, "rise"), page.side_texels, true,
                           bake.bits, page.rises);
            append_texture(folder / texture_name(p, pair, "fall"), page.side_texels, false,
                           bake.bits, page.falls);
        }
        bake.pages.push_back(std::move(page));
    }
    if (std::ranges::any_of(bake.mesh_pages, [&](auto p) { return p >= bake.pages.size(); })) {
        fail_input("{}: a mesh is on page {}; there are {}", (folder / "bake.json").string(),
                   std::ranges::max(bake.mesh_pages), bake.pages.size());
    }
    if (bake.mesh_pages.size() != bake.scene.meshes().size()) {
        fail_input("{}: scene.glb has {} meshes, and bake.json pages for {}", folder.string(),
                   bake.scene.meshes().size(), bake.mesh_pages.size());
    }
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
    const std::vector<std::uint8_t> bytes = read_file(file, kMostJson_bytes);
    try {
        return bake_of(folder, nlohmann::json::parse(bytes));
    } catch (const nlohmann::json::exception& error) {
        fail_input("{}: is damaged or no bake: {}", file.string(), error.what());
    }
}

}  // namespace gnomon
