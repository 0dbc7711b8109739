#pragma once

#include <functional>
#include <map>
#include <string>

namespace candela::cli {

/// The files of share/completion by the name of their shell. The build writes the function.
const std::map<std::string, std::string, std::less<>>& completion_scripts();

}  // namespace candela::cli
