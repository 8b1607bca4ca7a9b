#include <gnomon/web.h>

#include "command.h"
#include "fail.h"
#include "flags.h"
#include "help.h"
#include "output.h"

#include <fmt/format.h>

#include <memory>
#include <string>

namespace gnomon::cli {

namespace {

constexpr const char* kExamples = R"(Examples:
  gnomon web day -o page
  gnomon web winter -o page --title "Market square"
  python3 -m http.server --directory page     then open http://localhost:8000

BAKE is a folder of gnomon bake. The page needs a web server, any that hands out files, and WebGL 2.)";

struct WebFlags {
    std::string bake, title, output;
};

void run_web(const WebFlags& flags) {
    if (flags.bake.empty()) fail_usage("web: BAKE is missing");
    if (flags.output.empty()) fail_usage("web: -o is missing, as in -o page");
    const std::string folder =
        require_replaced_folder("-o", flags.output, check_web_folder).string();
    write_web(folder, read_bake(flags.bake), flags.title);
    print(fmt::format("page: {0}\nto see it: python3 -m http.server --directory {0}\n", folder));
}

}  // namespace

Command add_web(CLI::App& program) {
    CLI::App* const app =
        add_command(program, "web", "Make a page of a bake, to play its day in a browser",
                    "gnomon web BAKE [--title TEXT] -o DIR", kExamples);
    const auto flags = std::make_shared<WebFlags>();
    app->add_option("BAKE", flags->bake, "a folder of gnomon bake");
    app->add_option("--title", flags->title, "stands above place and date")->type_name("TEXT");
    app->add_option("-o,--output", flags->output, "the folder to write")->type_name("DIR");
    return {app, [flags](const Session&, ConsoleProgress&) { run_web(*flags); }};
}

}  // namespace gnomon::cli
