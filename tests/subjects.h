#pragma once

/// Techniques as parameters of tests: each at its defaults, and with each choice of its choices.

#include "harness.h"

#include <ostream>
#include <string>
#include <vector>

namespace gnomon::test {

inline bool casts(const TechniqueInfo& info) {
    return info.name != "local_illumination";
}

/// A technique as a test's parameter, with what is not at its default.
struct Subject {
    std::string label;
    std::string technique;
    Params params;
};

/// For GoogleTest.
inline std::ostream& operator<<(std::ostream& out, const Subject& subject) {
    return out << subject.label;
}

/// Every technique that casts shadows, at its defaults and once for each other choice of its
/// choices.
inline std::vector<Subject> casting_subjects() {
    std::vector<Subject> subjects;
    for (const TechniqueInfo& info : techniques()) {
        if (!casts(info) || !supports(info.lights, DirectionalLight{})) continue;
        const std::string name(info.name);
        subjects.push_back({name, name, {}});
        for (const ParamInfo& param : info.params()) {
            for (const std::string& word : param.choices) {
                if (word == to_string(param.default_value)) continue;
                subjects.push_back(
                    {name + "_" + param.name + "_" + word, name, {{param.name, word}}});
            }
        }
    }
    return subjects;
}

/// The same, but the choices that all maps share with only one of them.
inline std::vector<Subject> subjects_apart() {
    std::vector<Subject> subjects = casting_subjects();
    std::erase_if(subjects, [](const Subject& subject) {
        const bool shared = subject.label.find("_filter_") != std::string::npos ||
                            subject.label.find("_content_") != std::string::npos ||
                            subject.label.find("_skip_uniform_") != std::string::npos;
        return shared && subject.technique != "shadow_map";
    });
    return subjects;
}

inline std::string label(const testing::TestParamInfo<Subject>& test) {
    return test.param.label;
}

}  // namespace gnomon::test
