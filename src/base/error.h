#pragma once

#include <stdexcept>
#include <string>

namespace candela {

/// Bad data or failed work: a file, a shader, a command line. `where` is a file and line, a JSON pointer or a shader
/// line, and may be empty. Programmer errors use CANDELA_CHECK instead (base/check.h).
class Error : public std::runtime_error {
 public:
  explicit Error(std::string message, std::string where = {})
      : std::runtime_error(where.empty() ? message : where + ": " + message),
        message_(std::move(message)),
        where_(std::move(where)) {}

  const std::string& message() const { return message_; }
  const std::string& where() const { return where_; }

 private:
  std::string message_;
  std::string where_;
};

/// Work that was stopped from outside before it was done, and of which no result can be handed on.
class Interrupted : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace candela
