#include <gnomon/web.h>

#include "bake/json_mark.h"
#include "base/check.h"
#include "base/file.h"
#include "base/folder.h"
#include "web/page_files.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kVersion = 1;

static_assert(std::endian::native == std::endian::little, "the page's numbers are little-endian");

std::string page_name(std::size_t page) {
    return "page" + std::to_string(page) + ".bin";
}

void append(std::string& bytes, const std::uint16_t* values, std::size_t count, BakeBits bits) {
    if (bits == BakeBits::sixteen) {
        bytes.append(reinterpret_cast<const char*>(values), count * sizeof *values);
        return;
    }
    for (std::size_t i = 0; i < count; ++i)
        bytes.push_back(static_cast<char>(std::min<unsigned>(values[i], 255)));
}

/// Layers of a texture array: the rises of the first pair, its falls, the rises of the second, ..
/// Plain numbers: browsers decode PNG to 8 bits and may multiply by alpha.
std::string layers(const IntervalPage& page, BakeBits bits) {
    std::string bytes;
    const std::size_t layer = page.rises.size() / static_cast<std::size_t>(page.pairs);
    for (std::size_t at = 0; at < page.rises.size(); at += layer) {
        append(bytes, &page.rises[at], layer, bits);
        append(bytes, &page.falls[at], layer, bits);
    }
    return bytes;
}

/// Of the texel that sees the light longest, in codes.
std::uint64_t most_codes(const IntervalPage& page) {
    std::vector<std::uint64_t> sums(std::size_t{page.side_texels} * page.side_texels, 0);
    for (std::size_t i = 0; i < page.rises.size(); ++i) {
        if (page.falls[i] > page.rises[i])
            sums[i / IntervalPage::kIntervalsPerPair % sums.size()] +=
                static_cast<std::uint64_t>(page.falls[i] - page.rises[i]);
    }
    return sums.empty() ? 0 : *std::ranges::max_element(sums);
}

ordered_json json_of(const IntervalBake& bake, const std::string& title) {
    const BakePath& path = bake.path;
    const PathEnds ends = path_ends(path);
    ordered_json directions = ordered_json::array();
    for (const DVec3& d : path.to_light_ws)
        directions.push_back({d.x, d.y, d.z});
    ordered_json pages = ordered_json::array();
    std::uint64_t codes = 0;
    for (std::size_t p = 0; p < bake.pages.size(); ++p) {
        const IntervalPage& page = bake.pages[p];
        pages.push_back(
            {{"file", page_name(p)}, {"side_texels", page.side_texels}, {"pairs", page.pairs}});
        codes = std::max(codes, most_codes(page));
    }
    const double code_s =
        (path.end_s - path.begin_s) / std::max(1, path.steps() * bake.codes_per_step());
    return {{"gnomon_web", kVersion},
            {"title", title.empty() ? "Sun and shadow" : title},
            {"place", path.place},
            {"date", path.date},
            {"summary", path.summary},
            {"utc_offset", path.utc_offset ? utc_offset_text(*path.utc_offset) : ""},
            {"begin_s", path.begin_s},
            {"end_s", path.end_s},
            {"closed", ends.closed},
            {"begins_up", ends.begins_up},
            {"ends_up", ends.ends_up},
            {"bits", static_cast<int>(bake.bits)},
            {"codes_per_step", bake.codes_per_step()},
            {"width_steps", disc_width_steps(path, bake.codes_per_step())},
            {"most_sun_s", static_cast<double>(codes) * code_s},
            {"to_light_ws", directions},
            {"pages", pages},
            {"mesh_pages", bake.mesh_pages}};
}

FolderKind web_kind() {
    return {.noun = "page of gnomon web",
            .mark = "web.json",
            .has_entry =
                [](std::string_view name) {
                    return name == "index.html" || name == "style.css" || name == "app.js" ||
                           name == "scene.glb" ||
                           (name.starts_with("page") && name.ends_with(".bin"));
                },
            .is_mark = [](const fs::path& mark) { return bake::is_json_with(mark, "gnomon_web"); }};
}

}  // namespace

void check_web_folder(const fs::path& folder) {
    if (web::page_files().empty()) {
        fail_machine(
            "web: this Gnomon was built without its page: install nodejs and npm, then configure "
            "and build again");
    }
    check_replaceable(folder, web_kind());
}

void write_web(const fs::path& folder, const IntervalBake& bake, const std::string& title) {
    check_web_folder(folder);
    replace_folder(folder, web_kind(), [&](const fs::path& inside) {
        for (const web::PageFile& file : web::page_files())
            write_file(inside / file.name, file.content);
        for (std::size_t p = 0; p < bake.pages.size(); ++p)
            write_file(inside / page_name(p), layers(bake.pages[p], bake.bits));
        write_glb(inside / "scene.glb", bake.scene);
        // A title from the command line may be no UTF-8, which JSON must be.
        write_file(
            inside / "web.json",
            json_of(bake, title).dump(1, ' ', false, ordered_json::error_handler_t::replace) +
                "\n");
    });
}

}  // namespace gnomon
