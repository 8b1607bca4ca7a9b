#include "bake/json_member.h"

#include "base/check.h"

#include <algorithm>

namespace gnomon::bake {

using nlohmann::json;

json parse_json(std::span<const std::uint8_t> text, std::string_view file) {
    try {
        return json::parse(text.begin(), text.end());
    } catch (const json::parse_error& error) {
        // Its own message quotes what may be no text at all.
        const auto before =
            text.first(std::min(std::max<std::size_t>(error.byte, 1) - 1, text.size()));
        const auto line_begin = std::find(before.rbegin(), before.rend(), '\n').base();
        fail_input("{}: is damaged or no JSON: line {}, column {}", file,
                   1 + std::count(before.begin(), before.end(), '\n'),
                   1 + (before.end() - line_begin));
    } catch (const json::exception&) {
        fail_input("{}: holds a number that is too large", file);  // all that parsing can find else
    }
}

bool JsonMember::has(std::string_view member) const {
    if (!json_->is_object()) fail("an object");
    const auto found = json_->find(member);
    return found != json_->end() && !found->is_null();
}

JsonMember JsonMember::at(std::string_view member) const {
    std::string name = name_.empty() ? std::string(member) : fmt::format("{}.{}", name_, member);
    if (!json_->is_object()) fail("an object");
    const auto found = json_->find(member);
    if (found == json_->end()) fail_input("{}: has no {}", file_, name);
    return {*found, file_, std::move(name)};
}

std::vector<JsonMember> JsonMember::items(std::size_t least, std::size_t most) const {
    if (!json_->is_array()) fail("a list");
    if (json_->size() < least || json_->size() > most) {
        fail_input("{}: {} has {} entries; it must have {}", file_, name_, json_->size(),
                   least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most));
    }
    std::vector<JsonMember> items;
    for (std::size_t i = 0; i < json_->size(); ++i)
        items.push_back({(*json_)[i], file_, fmt::format("{}[{}]", name_, i)});
    return items;
}

double JsonMember::number(double least, double most) const {
    if (!json_->is_number()) fail("a number");
    const double number = json_->get<double>();
    if (!(number >= least && number <= most)) fail(fmt::format("{:.7g} to {:.7g}", least, most));
    return number;
}

std::int64_t JsonMember::integer(std::int64_t least, std::int64_t most) const {
    if (!json_->is_number_integer()) fail("a whole number");
    const auto number = json_->get<std::int64_t>();
    if (number < least || number > most) fail(fmt::format("{} to {}", least, most));
    return number;
}

std::string JsonMember::text() const {
    if (!json_->is_string()) fail("a text");
    return json_->get<std::string>();
}

void JsonMember::fail(std::string_view allowed) const {
    constexpr std::size_t kMostQuoted = 60;
    std::string value = json_->dump(-1, ' ', true);
    if (value.size() > kMostQuoted) value = value.substr(0, kMostQuoted) + "..";
    fail_input("{} is {}; it must be {}", label(), value, allowed);
}

std::string JsonMember::label() const {
    return fmt::format("{}: {}", file_, name_.empty() ? "the text" : name_);
}

}  // namespace gnomon::bake
