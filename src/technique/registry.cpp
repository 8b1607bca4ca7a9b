#include <gnomon/technique.h>

#include "base/check.h"
#include "base/text.h"

#include <algorithm>
#include <utility>

namespace gnomon {

namespace {

constexpr std::pair<LightKinds, std::string_view> kKinds[] = {
    {LightKinds::directional, "directional"},
    {LightKinds::point, "point"},
    {LightKinds::spot, "spot"},
    {LightKinds::sphere, "sphere"},
    {LightKinds::disc, "disc"},
    {LightKinds::rect, "rect"}};

}  // namespace

std::vector<std::string_view> light_kinds(LightKinds kinds) {
    std::vector<std::string_view> names;
    for (const auto& [kind, name] : kKinds) {
        if ((static_cast<unsigned>(kinds) & static_cast<unsigned>(kind)) != 0)
            names.push_back(name);
    }
    return names;
}

bool supports(LightKinds kinds, const Light& light) {
    return std::ranges::count(light_kinds(kinds), light_kind(light)) != 0;
}

const TechniqueInfo& bake_technique() {
    return *std::ranges::find_if(
        techniques(), [](const TechniqueInfo& info) { return !info.lookup_params.empty(); });
}

const TechniqueInfo& find_technique(std::string_view name) {
    std::vector<std::string_view> names;
    for (const TechniqueInfo& info : techniques()) {
        if (info.name == name) return info;
        names.push_back(info.name);
    }
    const std::string nearest = suggestion(name, names);
    fail_input("there is no technique \"{}\"{}; there are {}", name, nearest,
               fmt::join(names, ", "));
}

std::unique_ptr<Technique> make_technique(Context& context, std::string_view name,
                                          const Params& params) {
    return find_technique(name).make(context, params);
}

void Technique::prepare(const Scene& scene) {
    Progress silent;
    prepare(scene, silent);
}

void Technique::render(const Frame& frame, Visibility& out) {
    Progress silent;
    render(frame, out, silent);
}

Visibility Technique::render(const Frame& frame) {
    Visibility visibility;
    render(frame, visibility);
    return visibility;
}

}  // namespace gnomon
