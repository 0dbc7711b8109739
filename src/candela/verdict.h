#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "candela/candela.h"
#include "check/check.h"

namespace candela {

/// A finding, and the names of what it is about; empty where it is about no such thing. Its numbers are the file's.
struct NamedFinding {
  check::Finding finding;
  std::string material, texture;
};

/// What is found in one asset.
struct Verdict {
  std::string file;
  std::optional<std::string> unreadable;  ///< why it cannot be judged
  std::vector<NamedFinding> findings;     ///< errors first
  std::size_t material_count = 0;
  std::size_t triangle_count = 0;

  std::size_t count(check::Severity severity) const;
};

/// Judges a file with all its variants, or "demo:NAME". One that cannot be read has a verdict, too: what keeps it from
/// being read. Throws Interrupted after a stop, Error for a demo that there is not.
Verdict judge(const std::string& name, const LoadOptions& options = {}, const Job& job = {});

/// The scenes below a folder, in the order of their names. Throws Error where there is none.
std::vector<std::string> scenes_below(const std::filesystem::path& folder);

}  // namespace candela
