#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "candela/verdict.h"
#include "check/check.h"

/// What `candela check` leaves out, and from where on it speaks.
namespace candela::cli {

/// Codes separated by commas. Throws UsageError for one that no finding has.
std::set<std::string> parse_codes(const std::string& text);

/// "CODE=X", into `limits`. Throws UsageError.
void parse_limit(const std::string& text, check::Limits& limits);

/// Findings that were there before, in a file of JSON: their files by their way from the folder of that file, so that
/// it can be kept beside what it speaks of.
class Baseline {
 public:
  /// Empty, to be written.
  Baseline() = default;
  /// Throws Error for what is no such file.
  explicit Baseline(const std::filesystem::path& path);

  bool knows(const std::string& file, const NamedFinding& finding) const;
  void add(const Verdict& verdict, const std::filesystem::path& path);
  void write(const std::filesystem::path& path) const;

 private:
  std::filesystem::path folder_;
  std::set<KnownFinding> findings_;
};

}  // namespace candela::cli
