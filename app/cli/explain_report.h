#pragma once

#include <string>

#include "candela/explain.h"

/// What `candela explain` says: to people, to programs, as a page.
namespace candela::cli {

std::string explain_text(const Explanation& explanation);
std::string explain_json(const std::string& scene, const Explanation& explanation);
/// In one file, with the picture and the lobes drawn.
std::string explain_page(const std::string& scene, const Explanation& explanation);

}  // namespace candela::cli
