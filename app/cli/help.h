#pragma once

#include <string>

namespace candela::cli {

/// The built-in scenes, one a line.
std::string demos_text();

/// What to say of a first word that is no verb: the verb that was meant, or the one for a file of that name.
std::string unknown_verb_text(const std::string& word);

}  // namespace candela::cli
