#pragma once

#include <gnomon/technique.h>

#include <functional>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace gnomon {

/// Throws Error{input} when `value` is not of `info`'s type or out of its range; returns it as a
/// value of exactly that type (a whole number given for a number becomes one).
ParamValue checked_value(std::string_view technique, const ParamInfo& info,
                         const ParamValue& value);

/// The options of a technique, written once: each row gives name, member, range, unit and meaning;
/// defaults are those of a default-constructed Options. Everything that needs to know of parameters
/// reads this table.
///
///     struct Options { int map_size = 2048; Filter filter = Filter::box_4x4; };
///     const ParamTable<Options> kTable("shadow_map", {
///         integer("map_size", &Options::map_size, 16, 16384, "texels", "side of the map"),
///         choice("filter", &Options::filter, {"nearest", "box_4x4"}, "how the map is read")});
template <typename Options>
class ParamTable {
public:
    struct Row {
        ParamInfo info;
        std::function<void(Options&, const ParamValue&)> set;
    };

    /// `more` come after `rows`: those of a group of techniques.
    ParamTable(std::string_view technique, std::initializer_list<Row> rows,
               const std::vector<Row>& more = {})
        : technique_(technique), rows_(rows) {
        rows_.insert(rows_.end(), more.begin(), more.end());
        for (const Row& row : rows_)
            infos_.push_back(row.info);
    }

    const std::vector<ParamInfo>& infos() const { return infos_; }

    /// Defaults with `params` over them. Throws Error{input} for an unknown name or a bad value.
    Options options(const Params& params) const {
        Options options;
        for (const auto& [name, value] : params.values()) {
            const ParamInfo& info = find_param(technique_, infos_, name);
            const auto index = static_cast<std::size_t>(&info - infos_.data());
            rows_[index].set(options, checked_value(technique_, info, value));
        }
        return options;
    }

private:
    std::string technique_;
    std::vector<Row> rows_;
    std::vector<ParamInfo> infos_;
};

template <typename Options>
typename ParamTable<Options>::Row boolean(std::string name, bool Options::*member,
                                          std::string meaning) {
    return {{.name = std::move(name),
             .type = ParamType::boolean,
             .default_value = Options{}.*member,
             .meaning = std::move(meaning)},
            [member](Options& o, const ParamValue& v) { o.*member = std::get<bool>(v); }};
}

template <typename Options>
typename ParamTable<Options>::Row integer(std::string name, int Options::*member, int min, int max,
                                          std::string unit, std::string meaning) {
    return {{.name = std::move(name),
             .type = ParamType::integer,
             .default_value = Options{}.*member,
             .min = static_cast<double>(min),
             .max = static_cast<double>(max),
             .unit = std::move(unit),
             .meaning = std::move(meaning)},
            [member](Options& o, const ParamValue& v) { o.*member = std::get<int>(v); }};
}

template <typename Options>
typename ParamTable<Options>::Row number(std::string name, double Options::*member, double min,
                                         double max, std::string unit, std::string meaning) {
    return {{.name = std::move(name),
             .type = ParamType::number,
             .default_value = Options{}.*member,
             .min = min,
             .max = max,
             .unit = std::move(unit),
             .meaning = std::move(meaning)},
            [member](Options& o, const ParamValue& v) { o.*member = std::get<double>(v); }};
}

/// `words` in the order of the enumeration's values, from 0.
template <typename Options, typename Enum>
typename ParamTable<Options>::Row choice(std::string name, Enum Options::*member,
                                         std::vector<std::string> words, std::string meaning) {
    static_assert(std::is_enum_v<Enum>);
    const auto chosen = static_cast<std::size_t>(Options{}.*member);
    return {{.name = std::move(name),
             .type = ParamType::choice,
             .default_value = words[chosen],
             .choices = words,
             .meaning = std::move(meaning)},
            [member, words](Options& o, const ParamValue& v) {
                const std::string& word = std::get<std::string>(v);
                for (std::size_t i = 0; i < words.size(); ++i) {
                    if (words[i] == word) o.*member = static_cast<Enum>(i);
                }
            }};
}

}  // namespace gnomon
