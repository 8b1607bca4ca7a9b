#pragma once

#include <span>
#include <string>
#include <string_view>

namespace gnomon {

/// The candidate nearest to `word` by edit distance (V. Levenshtein, 1966), or empty when none is
/// near enough to be a likely misspelling: more than a third of the word, and more than 2, wrong.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> candidates);

/// `, did you mean "x"?`, or empty when no candidate is near.
std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace gnomon
