#pragma once

#include <filesystem>

namespace candela::cli {

/// The list of a folder of work.
inline constexpr const char* kJobList = "jobs.txt";

/// The list of what follows once all lines of a list are done: LIST-merge.txt.
std::filesystem::path merge_list_of(const std::filesystem::path& list);

}  // namespace candela::cli
