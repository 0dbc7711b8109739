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

/// Collects warnings in the order they arise; the caller decides what to do with them. Not thread-safe.
class Diagnostics {
 public:
  void warn(std::string message, std::string where = {}) {
    warnings_.push_back({std::move(message), std::move(where)});
  }
  const std::vector<Diagnostic>& warnings() const { return warnings_; }

 private:
  std::vector<Diagnostic> warnings_;
};

}  // namespace candela
