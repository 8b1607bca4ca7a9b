#include <gnomon/technique.h>

#include "base/check.h"
#include "base/text.h"

namespace gnomon {

bool supports(LightKinds kinds, const Light& light) {
    LightKinds kind = LightKinds::area;
    if (std::holds_alternative<DirectionalLight>(light)) kind = LightKinds::directional;
    if (std::holds_alternative<PointLight>(light)) kind = LightKinds::point;
    if (std::holds_alternative<SpotLight>(light)) kind = LightKinds::spot;
    return (static_cast<unsigned>(kinds) & static_cast<unsigned>(kind)) != 0;
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
