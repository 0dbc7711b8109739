#pragma once

#include <map>
#include <string>
#include <vector>

#include "cli/command_line.h"

namespace candela::cli {

/// The manual, in the language of man(7): the text of each page by its file's name, "candela.1" and "candela-VERB.1".
std::map<std::string, std::string> man_pages(const std::vector<CommandInfo>& commands, const std::string& version);

}  // namespace candela::cli
