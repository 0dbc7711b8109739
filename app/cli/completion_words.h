#pragma once

#include <string>
#include <vector>

#include "cli/command_line.h"

namespace candela::cli {

/// What the last of `words` may become, of a command line without the program's name. The first line says what else the
/// shell has to offer, "words" (nothing), "files" or "folders", with "open " before it where no blank shall follow; the
/// others are a word each, a tab and what it is. Makes of any words what it can.
std::string completion_text(const std::vector<CommandInfo>& commands, const std::vector<std::string>& words);

}  // namespace candela::cli
