#include <gnomon/report.h>

#include "report/format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace gnomon {

namespace {

constexpr std::size_t kColumns = 10;
constexpr std::size_t kTextColumns = 2;  // to the left; the rest are numbers, to the right
using Row = std::array<std::string, kColumns>;

const Row kHeader = {"technique", "light",      "rmse", "false lit %", "false shadow %",
                     "stray %",   "artefact %", "flip", "ms",          "memory"};

std::string percent(double fraction) {
    return fmt::format("{:.3f}", 100.0 * fraction);
}

Row cells(const TechniqueResult& result) {
    Row row;
    row[0] = report::printable(result.technique);
    row[1] = report::printable(result.light);
    if (!result.supported) return row;
    const Comparison& error = result.error;
    row[2] = fmt::format("{:.4f}", error.rmse);
    row[3] = percent(error.false_lit);
    row[4] = percent(error.false_shadow);
    row[5] = percent(error.stray_lit + error.stray_shadow);
    row[6] = percent(error.artefact_lit + error.artefact_shadow);
    row[7] = fmt::format("{:.4f}", result.flip);
    row[8] = fmt::format("{:.2f}", result.total_ms.median);
    row[9] = report::short_bytes(result.memory_bytes);
    return row;
}

std::string aligned(const Row& row, const std::array<std::size_t, kColumns>& widths,
                    std::size_t columns, const std::string& remark) {
    std::string line;
    for (std::size_t i = 0; i < columns; ++i) {
        const std::string padding(widths[i] - report::columns(row[i]), ' ');
        if (i > 0) line += "  ";
        line += i < kTextColumns ? row[i] + padding : padding + row[i];
    }
    if (!remark.empty()) line += "  " + remark;
    return line + "\n";
}

/// What stands at the end of a result's row.
std::string remark(const TechniqueResult& result) {
    if (!result.supported) return "not supported: " + report::printable(result.note);
    return result.warning.empty() ? "" : "warning: " + report::printable(result.warning);
}

}  // namespace

std::string table(const ComparisonReport& report) {
    std::vector<Row> rows;
    for (const TechniqueResult& result : report.results)
        rows.push_back(cells(result));

    std::array<std::size_t, kColumns> widths{};
    for (std::size_t i = 0; i < kColumns; ++i) {
        widths[i] = report::columns(kHeader[i]);
        for (const Row& row : rows)
            widths[i] = std::max(widths[i], report::columns(row[i]));
    }
    std::string text = aligned(kHeader, widths, kColumns, {});
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const TechniqueResult& result = report.results[i];
        text +=
            aligned(rows[i], widths, result.supported ? kColumns : kTextColumns, remark(result));
    }
    return text;
}

}  // namespace gnomon
