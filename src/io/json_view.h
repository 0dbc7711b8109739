#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela::io {

/// A value inside a JSON document together with its place. Every getter checks type and range and throws an Error that
/// reads `file#/json/pointer: message`; nothing is defaulted unless the caller names the default. The document and
/// `file` must outlive the view.
class JsonView {
 public:
  JsonView(const nlohmann::json& value, const std::string& file, std::string pointer = {})
      : value_(&value), file_(&file), pointer_(std::move(pointer)) {}

  std::string where() const { return pointer_.empty() ? *file_ : *file_ + '#' + pointer_; }
  Error error(std::string message) const { return Error(std::move(message), where()); }

  bool is_object() const;
  /// Members of an object: empty when absent, an Error when this is no object.
  std::optional<JsonView> find(const char* key) const;
  JsonView at(const char* key) const;
  std::vector<std::string> keys() const;
  /// `extensions/name`.
  std::optional<JsonView> extension(const char* name) const;
  /// `extras/name`; empty too where extras is no object, for an application may put anything there.
  std::optional<JsonView> extras(const char* name) const;

  /// Elements of an array.
  std::size_t size() const;
  JsonView operator[](std::size_t i) const;

  const std::string& string() const;
  bool boolean() const;
  float real() const;           ///< finite as a float
  std::uint64_t whole() const;  ///< not negative and below 2^53; `3.0` counts as whole
  /// An index into `count` things called `kind`.
  std::size_t index(std::size_t count, const char* kind) const;
  /// An array of exactly `count` finite numbers.
  std::vector<float> reals(std::size_t count) const;

  std::string string_or(const char* key, const std::string& fallback = {}) const;
  bool boolean_or(const char* key, bool fallback) const;
  float real_or(const char* key, float fallback) const;
  std::uint64_t whole_or(const char* key, std::uint64_t fallback) const;
  std::optional<std::size_t> index_of(const char* key, std::size_t count, const char* kind) const;

  /// A glm vector or matrix from an array of as many numbers.
  template <class V>
  V vector_or(const char* key, V fallback) const {
    const auto member = find(key);
    if (!member) return fallback;
    const auto numbers = member->reals(sizeof(V) / sizeof(float));
    float* out = &fallback[0];
    for (const float x : numbers) *out++ = x;
    return fallback;
  }

 private:
  JsonView child(const nlohmann::json& value, const std::string& token) const;
  [[noreturn]] void expected(const char* what) const;

  const nlohmann::json* value_;
  const std::string* file_;
  std::string pointer_;
};

/// A member's name as a JSON pointer has it (RFC 6901 §3).
std::string escaped_token(const std::string& name);

/// Number of elements of the array `key` of the document's root, 0 when absent.
std::size_t count_of(const JsonView& root, const char* key);

}  // namespace candela::io
