#include "report/mustache.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace gnomon::report {
namespace {

using nlohmann::json;

TEST(FillTemplate, EscapesUnlessAskedNotTo) {
    const json view = {{"a", "<b class='x\"'>&"}};
    EXPECT_EQ(fill_template("{{a}}", view), "&lt;b class=&#39;x&quot;&#39;&gt;&amp;");
    EXPECT_EQ(fill_template("{{{a}}}", view), "<b class='x\"'>&");
}

TEST(FillTemplate, DoesNotReadTagsInValues) {
    const json view = {{"a", "{{b}} {{{b}}} {{#b}}"}, {"b", "secret"}};
    EXPECT_EQ(fill_template("{{a}}", view), "{{b}} {{{b}}} {{#b}}");
}

TEST(FillTemplate, RepeatsAListAndLooksOutwards) {
    const json view = {{"unit", "ms"}, {"list", {{{"n", 1}}, {{"n", 2}, {"unit", "s"}}}}};
    EXPECT_EQ(fill_template("{{#list}}{{n}} {{unit}};{{/list}}", view), "1 ms;2 s;");
    EXPECT_EQ(fill_template("{{#l}}[{{.}}]{{/l}}", {{"l", {"a", "b"}}}), "[a][b]");
}

TEST(FillTemplate, ShowsASectionOrItsOpposite) {
    const std::string text = "{{#x}}yes{{/x}}{{^x}}no{{/x}}";
    EXPECT_EQ(fill_template(text, {{"x", true}}), "yes");
    EXPECT_EQ(fill_template(text, {{"x", false}}), "no");
    EXPECT_EQ(fill_template(text, {{"x", json::array()}}), "no");
    EXPECT_EQ(fill_template(text, {{"x", ""}}), "no");
    EXPECT_EQ(fill_template(text, {{"x", "text"}}), "yes");
}

TEST(FillTemplate, NestsSectionsOfOneName) {
    const json view = {{"x", {{"x", true}}}};
    EXPECT_EQ(fill_template("a{{#x}}b{{#x}}c{{/x}}d{{/x}}e", view), "abcde");
}

TEST(FillTemplate, ThrowsForAFaultInTheTemplate) {
    const json view = {{"a", "x"}, {"list", {1, 2}}, {"half", 0.5}};
    for (const char* text : {"{{missing}}", "{{#a}}", "{{/a}}", "{{a", "{{list}}", "{{half}}"}) {
        EXPECT_THROW(fill_template(text, view), std::logic_error) << text;
    }
}

}  // namespace
}  // namespace gnomon::report
