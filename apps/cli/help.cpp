#include "help.h"

#include <memory>
#include <sstream>

namespace gnomon::cli {

namespace {

constexpr std::size_t kTextColumns = 100;
constexpr std::size_t kNameColumns = 30;

/// `text` broken at spaces into lines of at most `columns`.
std::string wrap(const std::string& text, std::size_t columns) {
    std::istringstream words(text);
    std::string result, word;
    std::size_t used = 0;
    while (words >> word) {
        if (used > 0 && used + 1 + word.size() > columns) {
            result += '\n';
            used = 0;
        } else if (used > 0) {
            result += ' ';
            ++used;
        }
        result += word;
        used += word.size();
    }
    return result;
}

class HelpFormatter : public CLI::Formatter {
public:
    explicit HelpFormatter(std::string usage) : usage_(std::move(usage)) {
        column_width(kNameColumns);
        label("Positionals", "Arguments");
        label("Subcommands", "Commands");
    }

    std::string make_usage(const CLI::App*, std::string) const override {
        return "\nUsage: " + usage_ + "\n";
    }

    std::string make_option_name(const CLI::Option* option, bool positional) const override {
        if (positional) return option->get_name(true);
        std::string names = option->get_name(false, true);
        const std::size_t comma = names.find(',');
        if (comma != std::string::npos) return names.replace(comma, 1, ", ");
        return "    " + names;  // where the long names of the others are
    }

    std::string make_option_opts(const CLI::Option* option) const override {
        const bool valued = option->get_type_size() != 0 && !option->get_positional();
        return valued ? " " + option->get_type_name() : std::string();
    }

    std::string make_option_desc(const CLI::Option* option) const override {
        return wrap(option->get_description(), kTextColumns - kNameColumns);
    }

    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override {
        std::string help = CLI::Formatter::make_help(app, name, mode);
        for (std::size_t at = 0; (at = help.find("\n\n\n", at)) != std::string::npos;) {
            help.erase(at, 1);
        }
        return help;
    }

private:
    std::string usage_;
};

}  // namespace

void set_help(CLI::App& app, const std::string& usage, const std::string& examples) {
    app.formatter(std::make_shared<HelpFormatter>(usage));
    app.option_defaults()->group("Flags");
    app.set_help_flag("-h,--help", "print this help");
    app.footer(examples);
}

CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& summary,
                      const std::string& usage, const std::string& examples) {
    CLI::App* const app = program.add_subcommand(name, summary);
    app->group("Commands");
    set_help(*app, usage, examples);
    return app;
}

}  // namespace gnomon::cli
