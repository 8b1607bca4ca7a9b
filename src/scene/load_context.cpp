#include "scene/load_context.h"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::scene {

namespace {

constexpr std::size_t kMaxExamples = 3;

bool is_utf8_tail(char c) {
    return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u;
}

}  // namespace

void Warnings::add(std::string_view fault, std::string_view where, std::uint64_t amount) {
    auto entry = std::find_if(entries_.begin(), entries_.end(),
                              [&](const Entry& e) { return e.fault == fault; });
    if (entry == entries_.end()) {
        entries_.push_back({.fault = std::string(fault)});
        entry = entries_.end() - 1;
    }
    entry->amount += amount;
    entry->counted = entry->counted || amount != 1 || where.empty();
    const std::string example = quotable(where);
    auto& examples = entry->examples;
    const bool known = std::find(examples.begin(), examples.end(), example) != examples.end();
    if (example.empty() || known) return;
    ++entry->places;
    if (examples.size() < kMaxExamples) examples.push_back(example);
}

std::vector<std::string> Warnings::lines() const {
    std::vector<std::string> lines;
    for (const Entry& entry : entries_) {
        std::string line = entry.fault;
        if (!entry.examples.empty()) {
            line += fmt::format(": {}", fmt::join(entry.examples, ", "));
            if (entry.places > entry.examples.size()) {
                line += fmt::format(" and {} more", entry.places - entry.examples.size());
            }
        }
        if (entry.counted && entry.amount > std::max<std::uint64_t>(entry.places, 1)) {
            line += fmt::format(" ({} in all)", entry.amount);
        }
        lines.push_back(std::move(line));
    }
    return lines;
}

std::string quotable(std::string_view text, std::size_t max_length) {
    std::string line;
    for (const char c : text) {
        if (line.size() >= max_length && !is_utf8_tail(c)) {
            line += "...";
            break;
        }
        const bool control = static_cast<unsigned char>(c) < 0x20u || c == 0x7F;
        line += control ? ' ' : c;
    }
    return line;
}

}  // namespace gnomon::scene
