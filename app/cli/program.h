#pragma once

#include <string>
#include <vector>

namespace candela::cli {

/// Does what a command line asks for, without the program's own name in front; returns the exit code. What goes wrong
/// is one line on standard error.
int run_program(const std::vector<std::string>& arguments);

}  // namespace candela::cli
