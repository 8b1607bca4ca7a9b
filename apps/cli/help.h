#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace gnomon::cli {

/// A subcommand whose help is: summary, usage, arguments, flags, examples.
CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& summary,
                      const std::string& usage, const std::string& examples);

/// Gives `app` (the program) our layout of help, with this usage line.
void set_help(CLI::App& app, const std::string& usage, const std::string& examples);

}  // namespace gnomon::cli
