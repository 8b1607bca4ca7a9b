#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::bake {

/// The text of a file as JSON. Throws Error{input} that says where it is none.
nlohmann::json parse_json(std::span<const std::uint8_t> text, std::string_view file);

/// A value in a JSON file, which names file, member, value and what is allowed when it is wrong:
/// all functions throw Error{input}. The file's JSON must outlive it.
class JsonMember {
public:
    JsonMember(const nlohmann::json& root, std::string_view file) : file_(file), json_(&root) {}

    JsonMember at(std::string_view member) const;
    bool has(std::string_view member) const;  ///< and not null
    /// Of a list of so many.
    std::vector<JsonMember> items(std::size_t least, std::size_t most) const;

    double number(double least, double most) const;
    std::int64_t integer(std::int64_t least, std::int64_t most) const;
    std::string text() const;

    /// File and member, for a message.
    std::string label() const;

    /// `allowed`: "8 or 16".
    [[noreturn]] void fail(std::string_view allowed) const;

private:
    JsonMember(const nlohmann::json& json, std::string_view file, std::string name)
        : file_(file), name_(std::move(name)), json_(&json) {}

    std::string file_, name_;
    const nlohmann::json* json_;
};

}  // namespace gnomon::bake
