#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
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

/// What identifies a finding in another run, whatever was measured then. Empty members count as equal to empty ones.
struct KnownFinding {
  std::string file, code, material, texture, subject;

  /// An order, to be looked up by.
  bool operator<(const KnownFinding& other) const;
};
KnownFinding identity_of(const std::string& file, const NamedFinding& finding);

/// Takes from a verdict the findings for which `is_left_out` is true; returns their number.
std::size_t leave_out(const std::function<bool(const NamedFinding&)>& is_left_out, Verdict& verdict);

/// Judges a file with all its variants, or "demo:NAME". A file that cannot be read has a verdict, too: the reason.
/// Throws Interrupted after a stop, Error for an unknown demo.
Verdict judge(const std::string& name, const LoadOptions& options = {}, const Job& job = {},
              const check::Limits& limits = {});

/// The same of a scene in memory, which is called `name`; of files only what `input` says.
Verdict judge(const std::string& name, const check::CheckInput& input, const Job& job = {});

/// A verdict together with what it is about.
struct JudgedScene {
  Verdict verdict;
  Scene scene;
  io::FileInfo info;  ///< empty for a built-in scene
};
/// The same of a scene that is needed further on. Throws Error where it cannot be read.
JudgedScene judge_scene(const std::string& name, const LoadOptions& options = {}, const Job& job = {},
                        const check::Limits& limits = {});

/// The scenes below a folder, sorted by name. Throws Error if there is none.
std::vector<std::string> scenes_below(const std::filesystem::path& folder);
/// The same, none where there is none.
std::vector<std::string> find_scenes_below(const std::filesystem::path& folder);

}  // namespace candela
