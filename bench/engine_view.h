#pragma once

#include <gnomon/technique.h>

#include <memory>
#include <sstream>
#include <string>
#include <string_view>

namespace gnomon {

/// The size of the pictures in the comparison of engines.
inline constexpr Extent kEngineView{1920, 1080};

/// Of "[PARAMETER=VALUE...]".
inline Params params_of(std::string_view technique, std::istream& words) {
    const TechniqueInfo& info = find_technique(technique);
    Params params;
    for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        const ParamInfo& param = find_param(technique, info.params(), word.substr(0, equals));
        params.set(param.name, parse_param(technique, param, word.substr(equals + 1)));
    }
    return params;
}

/// Of "TECHNIQUE [PARAMETER=VALUE...]".
inline std::unique_ptr<Technique> technique_of(Context& context, const std::string& spec) {
    std::istringstream words(spec);
    std::string name;
    words >> name;
    return make_technique(context, name, params_of(name, words));
}

}  // namespace gnomon
