#include "scene/obj_text.h"

#include "base/check.h"
#include "scene/obj_parser.h"

#include <algorithm>
#include <istream>
#include <streambuf>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace gnomon::scene {

namespace {

constexpr std::string_view kBlanks = " \t\r\n\f\v";

// A stream over bytes that stay where they are.
class MemoryBuffer : public std::streambuf {
public:
    explicit MemoryBuffer(std::vector<std::uint8_t>& bytes) {
        char* begin = reinterpret_cast<char*>(bytes.data());
        setg(begin, begin, begin + bytes.size());
    }
};

std::string_view view(const std::vector<std::uint8_t>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void refuse_utf16(const std::vector<std::uint8_t>& file) {
    const bool big = file.size() >= 2 && file[0] == 0xFE && file[1] == 0xFF;
    const bool little = file.size() >= 2 && file[0] == 0xFF && file[1] == 0xFE;
    if (big || little) fail_input("is UTF-16 text; save it as UTF-8");
}

// A backslash at the end of a line continues it on the next; the parser does not know that. A
// byte-order mark is no part of the first line.
void join_lines(std::vector<std::uint8_t>& file) {
    if (view(file).starts_with("\xEF\xBB\xBF")) std::fill_n(file.begin(), 3, std::uint8_t{' '});
    for (std::size_t i = 0; i + 1 < file.size(); ++i) {
        if (file[i] != '\\') continue;
        const std::size_t end = file[i + 1] == '\r' ? i + 2 : i + 1;
        if (end < file.size() && file[end] == '\n') {
            std::fill(file.begin() + static_cast<std::ptrdiff_t>(i),
                      file.begin() + static_cast<std::ptrdiff_t>(end) + 1, std::uint8_t{' '});
        }
    }
}

// The parser splits the names of libraries at blanks, so its own handling is not used.
std::vector<std::string> find_libraries(std::string_view text) {
    constexpr std::string_view kKeyword = "mtllib";
    std::vector<std::string> libraries;
    for (std::size_t at = text.find(kKeyword); at != text.npos; at = text.find(kKeyword, at + 1)) {
        const std::size_t line = text.find_last_of("\r\n", at) + 1;  // npos + 1 = 0
        const std::size_t name = at + kKeyword.size();
        const bool leads = trimmed(text.substr(line, at - line)).empty();
        if (!leads || name >= text.size() || (text[name] != ' ' && text[name] != '\t')) continue;
        const std::size_t end = std::min(text.find_first_of("\r\n", name), text.size());
        libraries.push_back(trimmed(text.substr(name, end - name)));
    }
    return libraries;
}

class Collector {
public:
    ObjText text;

    Collector() {
        text.materials.emplace_back();
        text.objects.emplace_back();
    }

    void add_face(const tinyobj::index_t* indices, int count) {
        const std::size_t first = text.corners.size();
        for (int i = 0; i < count; ++i) {
            text.corners.push_back({resolved(indices[i].vertex_index, text.positions.size()),
                                    resolved(indices[i].texcoord_index, text.texcoords.size()),
                                    resolved(indices[i].normal_index, text.normals.size())});
        }
        text.faces.push_back({first, static_cast<std::uint32_t>(count), object_, material_});
    }

    void set_material(const char* name) {
        material_ = number_of(trimmed(name), text.materials, material_numbers_);
    }

    void set_group(const char** names, int count) {
        group_.clear();
        for (int i = 0; i < count; ++i) {
            if (i > 0) group_ += ' ';
            group_ += names[i];
        }
        set_object_number();
    }

    void set_object(const char* name) {
        name_ = trimmed(name);
        group_.clear();
        set_object_number();
    }

private:
    // 1 is the first; -1 is the last so far; 0 is none. What is out of range stays so.
    static std::uint32_t resolved(int index, std::size_t count) {
        if (index > 0) return static_cast<std::uint32_t>(index) - 1;
        const auto back = static_cast<std::uint64_t>(-static_cast<std::int64_t>(index));
        if (index == 0 || back > count) return ObjCorner::kNoIndex;
        return static_cast<std::uint32_t>(count - back);
    }

    static std::uint32_t number_of(const std::string& name, std::vector<std::string>& names,
                                   std::unordered_map<std::string, std::uint32_t>& numbers) {
        const auto [entry, is_new] =
            numbers.try_emplace(name, static_cast<std::uint32_t>(names.size()));
        if (is_new) names.push_back(name);
        return entry->second;
    }

    void set_object_number() {
        const std::string separator = name_.empty() || group_.empty() ? "" : "/";
        object_ = number_of(name_ + separator + group_, text.objects, object_numbers_);
    }

    std::unordered_map<std::string, std::uint32_t> material_numbers_{{"", 0}};
    std::unordered_map<std::string, std::uint32_t> object_numbers_{{"", 0}};
    std::string name_, group_;
    std::uint32_t object_ = 0;
    std::uint32_t material_ = 0;
};

tinyobj::callback_t callbacks() {
    tinyobj::callback_t calls;
    calls.vertex_cb = [](void* user, double x, double y, double z, double) {
        static_cast<Collector*>(user)->text.positions.emplace_back(x, y, z);
    };
    calls.normal_cb = [](void* user, double x, double y, double z) {
        static_cast<Collector*>(user)->text.normals.emplace_back(x, y, z);
    };
    calls.texcoord_cb = [](void* user, double x, double y, double) {
        static_cast<Collector*>(user)->text.texcoords.emplace_back(x, y);
    };
    calls.index_cb = [](void* user, tinyobj::index_t* indices, int count) {
        static_cast<Collector*>(user)->add_face(indices, count);
    };
    calls.usemtl_cb = [](void* user, const char* name, int) {
        static_cast<Collector*>(user)->set_material(name);
    };
    calls.group_cb = [](void* user, const char** names, int count) {
        static_cast<Collector*>(user)->set_group(names, count);
    };
    calls.object_cb = [](void* user, const char* name) {
        static_cast<Collector*>(user)->set_object(name);
    };
    return calls;
}

}  // namespace

std::string trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == text.npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(kBlanks) - first + 1));
}

ObjText parse_obj(std::vector<std::uint8_t> file) {
    refuse_utf16(file);
    join_lines(file);
    Collector collector;
    MemoryBuffer buffer(file);
    std::istream stream(&buffer);
    std::string warnings;
    std::string errors;
    if (!tinyobj::LoadObjWithCallback(stream, callbacks(), &collector, nullptr, &warnings,
                                      &errors)) {
        fail_input("is not OBJ text: {}", trimmed(errors));
    }
    if (collector.text.positions.empty()) fail_input("is not OBJ text: it has no vertex");
    collector.text.libraries = find_libraries(view(file));
    return std::move(collector.text);
}

}  // namespace gnomon::scene
