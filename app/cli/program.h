#pragma once

#include <string>
#include <vector>

#include "cli/command_line.h"

namespace candela::cli {

/// Does what a command line asks for, without the program's own name in front; returns the exit code. What goes wrong
/// is one line on standard error.
int run_program(const std::vector<std::string>& arguments);

/// The program and its verbs with their options.
std::vector<CommandInfo> all_commands();

}  // namespace candela::cli
