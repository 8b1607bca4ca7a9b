/// The program `gnomon`: one command per file; this one parses and turns errors into exit codes.

#include "command.h"
#include "fail.h"
#include "flags.h"
#include "help.h"
#include "output.h"

#include <algorithm>
#include <csignal>
#include <exception>
#include <new>

namespace gnomon::cli {

namespace {

constexpr int kExitDone = 0;
constexpr int kExitMachine = 1;
constexpr int kExitInput = 2;
constexpr int kExitSignalBase = 128;  // as shells have it: Ctrl-C is 130

constexpr const char* kGlobalsGroup = "Everywhere";
constexpr const char* kExamples = R"(Examples:
  gnomon compare courtyard -o report       then open report/index.html
  gnomon render model.glb -o frame.png --technique shadow_map
  gnomon COMMAND --help                    flags and examples of a command)";

std::vector<std::string_view> command_names(const std::vector<Command>& commands) {
    std::vector<std::string_view> names;
    for (const Command& command : commands)
        names.push_back(command.app->get_name());
    return names;
}

std::vector<std::string> flag_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
    }
    return names;
}

/// Whatever no flag and no argument took.
void reject_leftovers(const CLI::App& program, const std::vector<Command>& commands,
                      const Command* command) {
    const CLI::App& app = command == nullptr ? program : *command->app;
    std::vector<std::string> left = program.remaining(true);
    std::erase(left, "--");  // ends the flags, so that a file may be named -x
    if (left.empty()) return;
    const std::string unknown = left.front().substr(0, left.front().find('='));
    if (unknown.starts_with("-")) {
        const std::vector<std::string> names = flag_names(app);
        const std::vector<std::string_view> candidates(names.begin(), names.end());
        fail_usage("unknown flag {}{} ({} --help lists them)", unknown,
                   unknown.starts_with("--") ? suggestion(unknown, candidates) : "",
                   command == nullptr ? "gnomon" : "gnomon " + app.get_name());
    }
    if (command == nullptr) {
        const std::vector<std::string_view> names = command_names(commands);
        fail_usage("unknown command \"{}\"{}; commands: {}", unknown, suggestion(unknown, names),
                   join(names));
    }
    fail_usage("{}: \"{}\" is one argument too many", app.get_name(), left.front());
}

/// CLI11 reads from the back. `gnomon help render` is `gnomon render --help`.
void parse(CLI::App& program, std::vector<std::string> args) {
    if (!args.empty() && args.front() == "help") {
        args.erase(args.begin());
        args.emplace_back("--help");
    }
    std::reverse(args.begin(), args.end());
    program.parse(std::move(args));
}

const CLI::App& deepest(const CLI::App& program) {
    const std::vector<CLI::App*> chosen = program.get_subcommands();
    return chosen.empty() ? program : *chosen.front();
}

void run(std::vector<std::string> args) {
    CLI::App program(
        "Gnomon: shadow techniques on any Vulkan device, measured against the "
        "ray-traced truth.",
        "gnomon");
    Session session;
    set_help(program, "gnomon COMMAND [flags]", kExamples);
    program.set_version_flag("--version", fmt::format("gnomon {}", GNOMON_VERSION),
                             "print the version");
    program.allow_extras();
    program.require_subcommand(0, 1);
    const std::vector<Command> commands = {
        add_info(program),  add_scene(program), add_render(program), add_compare(program),
        add_bench(program), add_bake(program),  add_sun(program),    add_web(program)};
    add_globals(program, session.globals, kGlobalsGroup);
    for (const Command& command : commands) {
        command.app->allow_extras();
        add_globals(*command.app, session.globals, command.shows_globals ? kGlobalsGroup : "");
    }

    try {
        session.param_flags = take_param_flags(args, is_switch);
        parse(program, std::move(args));
    } catch (const CLI::CallForHelp&) {
        print(deepest(program).help());
        return;
    } catch (const CLI::CallForVersion& version) {
        print(fmt::format("{}\n", version.what()));
        return;
    } catch (const CLI::ArgumentMismatch& error) {
        const std::string message = error.what();  // "--size: ..."
        const bool missing = message.find("missing") != std::string::npos;
        fail_usage("{}: {}", message.substr(0, message.find(':')),
                   missing ? "a value is missing" : "is given more than once");
    } catch (const CLI::ParseError& error) {
        fail_usage("{}", error.what());
    }

    const auto command = std::find_if(commands.begin(), commands.end(),
                                      [](const Command& c) { return c.app->parsed(); });
    reject_leftovers(program, commands, command == commands.end() ? nullptr : &*command);
    if (command == commands.end()) {
        print(program.help());
        return;
    }
    if (!command->takes_params && !session.param_flags.empty()) {
        fail_usage("{}: {} takes no parameters of techniques", session.param_flags.front().written,
                   command->app->get_name());
    }
    ConsoleProgress progress(session.globals.quiet);
    command->run(session, progress);
}

int exit_code(const Error& error) {
    switch (error.kind()) {
        case ErrorKind::input:
            return kExitInput;
        case ErrorKind::machine:
            return kExitMachine;
        case ErrorKind::cancelled:
            break;
    }
    return kExitSignalBase + (stop_signal() == 0 ? SIGINT : stop_signal());
}

}  // namespace

}  // namespace gnomon::cli

int main(int argc, char** argv) {
    using namespace gnomon::cli;
    install_signal_handlers();
    try {
        run({argv + 1, argv + argc});
        return kExitDone;
    } catch (const ReaderGone&) {
        return kExitDone;  // it has read what it wanted
    } catch (const gnomon::Error& error) {
        print_error(error.what());
        return exit_code(error);
    } catch (const std::bad_alloc&) {
        print_error("out of memory");
        return kExitMachine;
    } catch (const std::exception& error) {
        print_error(error.what());
        return kExitMachine;
    }
}
