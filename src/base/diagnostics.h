#pragma once

#include <string>
#include <vector>

namespace candela {

/// One oddity that did not stop the work. `where` as in Error.
struct Diagnostic {
  std::string message;
  std::string where;

  std::string text() const { return where.empty() ? message : where + ": " + message; }
};

/// Collects warnings, and notes, in the order they arise; the caller decides what to do with them. A warning says that
/// the picture may not be the one that was meant; a note tells of what no picture shows. Not thread-safe.
class Diagnostics {
 public:
  void warn(std::string message, std::string where = {}) {
    warnings_.push_back({std::move(message), std::move(where)});
  }
  void note(std::string message, std::string where = {}) { notes_.push_back({std::move(message), std::move(where)}); }
  const std::vector<Diagnostic>& warnings() const { return warnings_; }
  const std::vector<Diagnostic>& notes() const { return notes_; }

 private:
  std::vector<Diagnostic> warnings_;
  std::vector<Diagnostic> notes_;
};

}  // namespace candela
