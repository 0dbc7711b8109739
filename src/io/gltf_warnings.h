#pragma once

#include <set>
#include <string>

#include "base/diagnostics.h"
#include "io/json_view.h"

namespace candela::io {

/// Warnings and notes of one load: the same message is given once, at the first place that caused it.
class Warnings {
 public:
  explicit Warnings(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void warn(const std::string& message, const JsonView& place) { warn(message, place.where()); }
  void warn(const std::string& message, const std::string& where) {
    if (given_.insert(message).second) diagnostics_.warn(message, where);
  }
  void note(const std::string& message, const JsonView& place) { note(message, place.where()); }
  void note(const std::string& message, const std::string& where) {
    if (given_.insert(message).second) diagnostics_.note(message, where);
  }
  /// What another thread has collected.
  void add(const Diagnostics& others) {
    for (const Diagnostic& d : others.warnings()) warn(d.message, d.where);
    for (const Diagnostic& d : others.notes()) note(d.message, d.where);
  }

 private:
  Diagnostics& diagnostics_;
  std::set<std::string> given_;
};

}  // namespace candela::io
