#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "candela/candela.h"
#include "check/check.h"

namespace candela {

/// A finding, and the names of its material and texture; empty if it concerns none. Its numbers are the file's.
struct NamedFinding {
  check::Finding finding;
  std::string material, texture;
};

/// All findings for one asset.
struct Verdict {
  std::string file;
  std::optional<std::string> unreadable;  ///< why it cannot be judged
  std::vector<NamedFinding> findings;     ///< errors first
  std::size_t material_count = 0;
  std::size_t triangle_count = 0;

  std::size_t count(check::Severity severity) const;
};

/// Judges a file with all its variants, or "demo:NAME". A file that cannot be read has a verdict, too: the reason.
/// Throws Interrupted after a stop, Error for an unknown demo.
Verdict judge(const std::string& name, const LoadOptions& options = {}, const Job& job = {});

/// The scenes below a folder, sorted by name. Throws Error if there is none.
std::vector<std::string> scenes_below(const std::filesystem::path& folder);

}  // namespace candela
