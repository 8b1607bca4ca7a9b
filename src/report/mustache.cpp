#include "report/mustache.h"

#include <fmt/format.h>

#include <stdexcept>
#include <vector>

namespace gnomon::report {

namespace {

using nlohmann::json;

[[noreturn]] void fail(std::string_view what, std::string_view name) {
    throw std::logic_error(fmt::format("template: {} {{{{{}}}}}", what, name));
}

struct Tag {
    char kind = '=';  ///< '=' value, '{' raw value, '#', '^' or '/'
    std::string name;
    std::size_t begin = 0, end = 0;  ///< in the text, braces included
};

/// The first tag at or after `from`; begin = npos when there is none.
Tag next_tag(std::string_view text, std::size_t from) {
    Tag tag;
    tag.begin = text.find("{{", from);
    if (tag.begin == std::string_view::npos) return tag;
    const std::size_t inner = tag.begin + 2;
    const bool raw = text.substr(inner, 1) == "{";
    const std::string_view closing = raw ? "}}}" : "}}";
    const std::size_t close = text.find(closing, inner);
    if (close == std::string_view::npos) fail("unclosed tag", text.substr(inner, 20));
    tag.end = close + closing.size();
    std::string_view name = text.substr(inner, close - inner);
    if (raw || (!name.empty() && std::string_view("#^/").find(name[0]) != name.npos)) {
        tag.kind = name[0];
        name.remove_prefix(1);
    }
    tag.name = name;
    return tag;
}

/// Where the section that `open` begins ends: its closing tag.
Tag closing_tag(std::string_view text, const Tag& open) {
    int depth = 1;
    for (Tag tag = next_tag(text, open.end); tag.begin != text.npos;
         tag = next_tag(text, tag.end)) {
        if (tag.name != open.name) continue;
        if (tag.kind == '#' || tag.kind == '^') ++depth;
        if (tag.kind == '/' && --depth == 0) return tag;
    }
    fail("section is not closed", open.name);
}

/// What {{^name}} shows for.
bool is_absent(const json& value) {
    if (value.is_boolean()) return !value.get<bool>();
    if (value.is_string()) return value.get_ref<const std::string&>().empty();
    return value.is_array() && value.empty();
}

class Filler {
public:
    void fill(std::string_view text, const json& view) {
        stack_.push_back(&view);
        std::size_t at = 0;
        for (Tag tag = next_tag(text, at); tag.begin != text.npos; tag = next_tag(text, at)) {
            out_ += text.substr(at, tag.begin - at);
            at = tag.end;
            if (tag.kind == '/') fail("section was not opened", tag.name);
            if (tag.kind == '#' || tag.kind == '^') {
                const Tag close = closing_tag(text, tag);
                section(tag, text.substr(tag.end, close.begin - tag.end));
                at = close.end;
            } else {
                const std::string value = text_of(tag.name);
                out_ += tag.kind == '{' ? value : escape_html(value);
            }
        }
        out_ += text.substr(at);
        stack_.pop_back();
    }

    std::string take() { return std::move(out_); }

private:
    const json& find(const std::string& name) const {
        if (name == ".") return *stack_.back();
        for (std::size_t depth = stack_.size(); depth-- > 0;) {
            const json& view = *stack_[depth];
            if (view.is_object() && view.contains(name)) return view.at(name);
        }
        fail("nothing is named", name);
    }

    std::string text_of(const std::string& name) const {
        const json& value = find(name);
        if (value.is_string()) return value.get<std::string>();
        if (value.is_number_integer()) return value.dump();
        fail("neither text nor a whole number is", name);
    }

    void section(const Tag& tag, std::string_view inside) {
        const json& value = find(tag.name);
        const bool absent = is_absent(value);
        if (tag.kind == '^') {
            if (absent) fill(inside, value);
        } else if (value.is_array()) {
            for (const json& element : value)
                fill(inside, element);
        } else if (!absent) {
            fill(inside, value);
        }
    }

    std::vector<const json*> stack_;
    std::string out_;
};

}  // namespace

std::string escape_html(std::string_view text) {
    std::string escaped;
    escaped.reserve(text.size());
    for (const char c : text) {
        switch (c) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            case '\'':
                escaped += "&#39;";
                break;
            default:
                escaped += c;
        }
    }
    return escaped;
}

std::string fill_template(std::string_view text, const json& view) {
    Filler filler;
    filler.fill(text, view);
    return filler.take();
}

}  // namespace gnomon::report
