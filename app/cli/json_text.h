#pragma once

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "base/text.h"

namespace candela::cli {

/// Numbers that are floats with the digits that a float needs: 0.1, not 0.10000000149011612.
inline void shorten_floats(nlohmann::ordered_json& json) {
  if (json.is_structured()) {
    for (auto& value : json) shorten_floats(value);
    return;
  }
  if (!json.is_number_float()) return;
  const double value = json.get<double>();
  if (!(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) return;
  const auto narrow = static_cast<float>(value);
  if (static_cast<double>(narrow) == value) json = decimal_of(narrow);
}

/// As every verb prints it: indented, with a line break at the end. File names are bytes, JSON is UTF-8: what is not
/// becomes a replacement character.
inline std::string json_text(nlohmann::ordered_json json) {
  shorten_floats(json);
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace candela::cli
