#include "io/json_view.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace candela::io {

namespace {

constexpr double kLargestWhole = 9007199254740992.0;  // 2^53, beyond which a double skips integers

}  // namespace

std::string escaped_token(const std::string& token) {
  std::string out;
  for (const char c : token) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

JsonView JsonView::child(const nlohmann::json& value, const std::string& token) const {
  return JsonView(value, *file_, pointer_ + '/' + escaped_token(token));
}

void JsonView::expected(const char* what) const {
  throw error(fmt::format("must be {}, not {}", what, value_->type_name()));
}

bool JsonView::is_object() const { return value_->is_object(); }

std::optional<JsonView> JsonView::find(const char* key) const {
  if (!value_->is_object()) expected("an object");
  const auto it = value_->find(key);
  if (it == value_->end()) return std::nullopt;
  return child(*it, key);
}

JsonView JsonView::at(const char* key) const {
  auto member = find(key);
  if (!member) throw error(fmt::format("'{}' is missing", key));
  return *std::move(member);
}

std::vector<std::string> JsonView::keys() const {
  if (!value_->is_object()) expected("an object");
  std::vector<std::string> result;
  for (const auto& item : value_->items()) result.push_back(item.key());
  return result;
}

std::optional<JsonView> JsonView::extension(const char* name) const {
  const auto extensions = find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

std::optional<JsonView> JsonView::extras(const char* name) const {
  const auto extras = find("extras");
  return extras && extras->is_object() ? extras->find(name) : std::nullopt;
}

std::size_t JsonView::size() const {
  if (!value_->is_array()) expected("an array");
  return value_->size();
}

JsonView JsonView::operator[](std::size_t i) const { return child((*value_)[i], std::to_string(i)); }

const std::string& JsonView::string() const {
  if (!value_->is_string()) expected("a string");
  return value_->get_ref<const std::string&>();
}

bool JsonView::boolean() const {
  if (!value_->is_boolean()) expected("true or false");
  return value_->get<bool>();
}

float JsonView::real() const {
  if (!value_->is_number()) expected("a number");
  const auto result = static_cast<float>(value_->get<double>());
  if (!std::isfinite(result)) throw error("the number is not finite");
  return result;
}

std::uint64_t JsonView::whole() const {
  if (!value_->is_number()) expected("a whole number");
  const double number = value_->get<double>();
  if (!(number >= 0 && number < kLargestWhole) || number != std::floor(number)) {
    throw error(fmt::format("must be a whole number that is not negative, not {}", value_->dump()));
  }
  return static_cast<std::uint64_t>(number);
}

std::size_t JsonView::index(std::size_t count, const char* kind) const {
  const std::uint64_t result = whole();
  if (result >= count) throw error(fmt::format("{} {} does not exist (there are {})", kind, result, count));
  return static_cast<std::size_t>(result);
}

std::vector<float> JsonView::reals(std::size_t count) const {
  if (size() != count) throw error(fmt::format("must have {} numbers, not {}", count, size()));
  std::vector<float> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = (*this)[i].real();
  return result;
}

std::string JsonView::string_or(const char* key, const std::string& fallback) const {
  const auto member = find(key);
  return member ? member->string() : fallback;
}

bool JsonView::boolean_or(const char* key, bool fallback) const {
  const auto member = find(key);
  return member ? member->boolean() : fallback;
}

float JsonView::real_or(const char* key, float fallback) const {
  const auto member = find(key);
  return member ? member->real() : fallback;
}

std::uint64_t JsonView::whole_or(const char* key, std::uint64_t fallback) const {
  const auto member = find(key);
  return member ? member->whole() : fallback;
}

std::optional<std::size_t> JsonView::index_of(const char* key, std::size_t count, const char* kind) const {
  const auto member = find(key);
  if (!member) return std::nullopt;
  return member->index(count, kind);
}

std::size_t count_of(const JsonView& root, const char* key) {
  const auto array = root.find(key);
  return array ? array->size() : 0;
}

}  // namespace candela::io
