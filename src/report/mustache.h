#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace gnomon::report {

/// Text that HTML shows as it is, in an element or in a quoted attribute.
std::string escape_html(std::string_view text);

/// Fills a template, a part of the Mustache language (mustache.github.io/mustache.5.html):
///     {{name}}             the value, escaped for HTML
///     {{{name}}}           the value as it is
///     {{#name}}..{{/name}} once per element of a list, or once when it is true, an object or a
///     text
///     {{^name}}..{{/name}} when it is false, an empty list or an empty text
///     {{.}}                the element or the text itself
/// A name is looked up in the innermost section first. Values are strings or whole numbers.
/// Throws std::logic_error naming the tag when a name is missing, a section is not closed, or a
/// value is of another type: templates are ours, so this is never a user's fault.
std::string fill_template(std::string_view text, const nlohmann::json& view);

}  // namespace gnomon::report
