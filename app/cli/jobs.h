#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/progress.h"

namespace candela::cli {

/// The words of a line as a shell would part it: blanks, '…', "…" and backslashes; what follows a # is a remark. Throws
/// UsageError for a quotation mark that nothing closes.
std::vector<std::string> words_of(const std::string& line);

/// Without a leading "candela render", or "render".
std::vector<std::string> without_verb(std::vector<std::string> words);

/// Calls `run` with the words of each line of a file, or of standard input where its name is "-", as soon as the line
/// is there; see without_verb(). A line that fails is named, and the others go on; throws Error at
/// the end where any has, Interrupted after a stop.
void run_jobs(const std::string& file, const std::function<void(const std::vector<std::string>&)>& run,
              ProgressLine& progress);

}  // namespace candela::cli
