#include "cli/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "cli/css_colors.h"
#include "scene/shading_model.h"

namespace candela::cli {

namespace {

/// The number `text` begins with, and what follows it.
std::pair<double, std::string_view> leading_number(std::string_view text) {
  double value = 0.0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || !std::isfinite(value)) throw UsageError(fmt::format("'{}' is not a number", text));
  return {value, text.substr(static_cast<std::size_t>(end - text.data()))};
}

double whole_number(std::string_view text) {
  const auto [value, rest] = leading_number(text);
  if (!rest.empty()) throw UsageError(fmt::format("'{}' is not a number", text));
  return value;
}

/// As float; a value that only a double can hold is refused rather than turned into infinity or zero.
float narrow(double value, std::string_view text) {
  const auto result = static_cast<float>(value);
  if (!std::isfinite(result)) throw UsageError(fmt::format("'{}' is too large", text));
  return result;
}

std::vector<float> number_list(std::string_view text) {
  std::vector<float> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view part = text.substr(begin, end - begin);
    values.push_back(narrow(whole_number(part), part));
    begin = end + 1;
  }
  return values;
}

/// IEC 61966-2-1.
float srgb_to_linear(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace

float parse_number(const std::string& text, float low, float high) {
  const float value = narrow(whole_number(text), text);
  if (value < low || value > high) throw UsageError(fmt::format("{} is not within {} to {}", text, low, high));
  return value;
}

int parse_count(const std::string& text, int low, int high) {
  int value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = end == text.data() + text.size();
  if (!whole || code == std::errc::invalid_argument) throw UsageError(fmt::format("'{}' is not a whole number", text));
  if (code != std::errc{} || value < low || value > high) {
    throw UsageError(fmt::format("{} is not within {} to {}", text, low, high));
  }
  return value;
}

std::uint32_t parse_seed(const std::string& text) {
  return static_cast<std::uint32_t>(parse_count(text, 0, std::numeric_limits<int>::max()));
}

ivec2 parse_size(const std::string& text) {
  constexpr int kMostPixels = 16384;  // per side, as for textures
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) throw UsageError(fmt::format("'{}' is not WIDTHxHEIGHT, e.g. 1280x720", text));
  return {parse_count(text.substr(0, cross), 1, kMostPixels), parse_count(text.substr(cross + 1), 1, kMostPixels)};
}

double parse_moment(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, double>, 6> kUnits{
      {{"", 1.0}, {"ms", 1e-3}, {"s", 1.0}, {"m", 60.0}, {"min", 60.0}, {"h", 3600.0}}};
  const auto [value, unit] = leading_number(text);
  const double seconds = value * one_of(std::string(unit), kUnits);
  constexpr double kLongest = 365.0 * 24.0 * 3600.0;
  if (!(seconds >= 0.0 && seconds <= kLongest)) throw UsageError(fmt::format("'{}' is not a time", text));
  return seconds;
}

std::uint64_t parse_bytes(const std::string& text) {
  constexpr double kKilo = 1000.0, kKibi = 1024.0;
  constexpr std::array<std::pair<std::string_view, double>, 11> kUnits{{{"", 1.0},
                                                                        {"B", 1.0},
                                                                        {"K", kKilo},
                                                                        {"KB", kKilo},
                                                                        {"KiB", kKibi},
                                                                        {"M", kKilo * kKilo},
                                                                        {"MB", kKilo * kKilo},
                                                                        {"MiB", kKibi * kKibi},
                                                                        {"G", kKilo * kKilo * kKilo},
                                                                        {"GB", kKilo * kKilo * kKilo},
                                                                        {"GiB", kKibi * kKibi * kKibi}}};
  const auto [value, unit] = leading_number(text);
  const double bytes = value * one_of(std::string(unit), kUnits);
  constexpr double kMost = 1e15;
  if (!(bytes >= 1.0 && bytes <= kMost)) throw UsageError(fmt::format("'{}' is not within 1 B and 1000000 GB", text));
  return static_cast<std::uint64_t>(bytes);
}

double parse_duration(const std::string& text) {
  const double seconds = parse_moment(text);
  if (seconds <= 0.0) throw UsageError(fmt::format("'{}' is not a time above zero", text));
  return seconds;
}

float parse_angle(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, double>, 3> kUnits{
      {{"", 180.0 / kPi}, {"deg", 180.0 / kPi}, {"rad", 1.0}}};
  const auto [value, unit] = leading_number(text);
  return narrow(value / one_of(std::string(unit), kUnits), text);
}

float parse_field_of_view(const std::string& text) {
  const float angle = parse_angle(text);
  constexpr float kLeast = radians(0.01f);  // a telescope; below, directions lose their precision
  constexpr float kMost = radians(179.0f);
  if (angle < kLeast || angle > kMost) throw UsageError(fmt::format("'{}' is not within 0.01deg to 179deg", text));
  return angle;
}

vec3 parse_vec3(const std::string& text) {
  const std::vector<float> v = number_list(text);
  if (v.size() != 3) throw UsageError(fmt::format("'{}' is not three numbers X,Y,Z", text));
  return {v[0], v[1], v[2]};
}

namespace {

/// CSS Color 4, §5.2: "#rgb", "#rgba", "#rrggbb" or "#rrggbbaa". Linear colour, and alpha.
std::optional<vec4> hex_color(const std::string& text) {
  const std::size_t digits = text.size() - 1;
  if (digits != 3 && digits != 4 && digits != 6 && digits != 8) return std::nullopt;
  const std::size_t each = digits < 6 ? 1 : 2;
  std::array<float, 4> channels{0.0f, 0.0f, 0.0f, 1.0f};
  for (std::size_t i = 0; i * each < digits; ++i) {
    const char* begin = text.data() + 1 + i * each;
    unsigned code = 0;
    if (std::from_chars(begin, begin + each, code, 16).ptr != begin + each) return std::nullopt;
    channels[i] = static_cast<float>(each == 1 ? 17 * code : code) / 255.0f;
  }
  return vec4(srgb_to_linear(channels[0]), srgb_to_linear(channels[1]), srgb_to_linear(channels[2]), channels[3]);
}

/// By its name in CSS, which may be in capitals.
std::optional<vec3> named_color(const std::string& text) {
  const std::string name = lower_case(text);
  for (const NamedColor& color : kCssColors) {
    if (color.name != name) continue;
    const auto channel = [&](unsigned shift) {
      return srgb_to_linear(static_cast<float>(color.rgb >> shift & 255U) / 255.0f);
    };
    return vec3(channel(16), channel(8), channel(0));
  }
  return std::nullopt;
}

/// What may have been meant by a name that no colour has.
std::string nearest_color(const std::string& text) {
  std::vector<std::string> names;
  names.reserve(kCssColors.size());
  for (const NamedColor& color : kCssColors) names.emplace_back(color.name);
  const std::string meant = did_you_mean(lower_case(text), names, "");
  return meant.empty() ? "give #rgb, #rrggbb, r,g,b or a name of CSS" : meant;
}

}  // namespace

vec3 parse_color(const std::string& text) {
  if (const std::optional<vec3> color = named_color(text)) return *color;
  if (text.starts_with('#')) {
    const std::optional<vec4> color = hex_color(text);
    if (!color) throw UsageError(fmt::format("'{}' is no colour #rgb or #rrggbb", text));
    if (color->w != 1.0f) throw UsageError(fmt::format("'{}' has an alpha, which counts for nothing here", text));
    return {color->x, color->y, color->z};
  }
  if (text.find(',') == std::string::npos) {
    throw UsageError(fmt::format("'{}' is no colour: {}", text, nearest_color(text)));
  }
  const vec3 color = parse_vec3(text);
  if (color.x < 0.0f || color.y < 0.0f || color.z < 0.0f) throw UsageError(fmt::format("'{}' is negative", text));
  return color;
}

Orbit parse_orbit(const std::string& text) {
  const std::vector<float> v = number_list(text);
  if (v.size() != 2 && v.size() != 3) {
    throw UsageError(fmt::format("'{}' is not AZIMUTH,ELEVATION or AZIMUTH,ELEVATION,DISTANCE", text));
  }
  if (std::abs(v[1]) > 90.0f) throw UsageError(fmt::format("an elevation of {} is not within -90 to 90", v[1]));
  if (v.size() == 3 && v[2] <= 0.0f) throw UsageError("the distance is not above zero (1 fits the subject)");
  return {radians(v[0]), radians(v[1]), v.size() == 3 ? v[2] : 1.0f};
}

std::vector<std::string> parse_names(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    names.push_back(text.substr(begin, end - begin));
    if (names.back().empty()) throw UsageError("a name of the list is empty");
    begin = end + 1;
  }
  return names;
}

namespace {

/// Of names with commas between them.
template <class Parse>
auto parse_set(std::string_view text, Parse parse) {
  std::set<decltype(parse(text))> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    values.insert(parse(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return values;
}

}  // namespace

std::set<Layer> parse_layers(const std::string& text) { return parse_set(text, parse_layer); }

std::set<MatteKind> parse_mattes(const std::string& text) { return parse_set(text, parse_matte_kind); }

shade::ShadingModel parse_shading(const std::string& text) {
  try {
    return parse_shading_model(text);
  } catch (const Error& error) {
    throw UsageError(error.message());
  }
}

FalloffChoice parse_falloff(const std::string& text) {
  constexpr std::string_view kPolynomial = "polynomial:";
  if (text.starts_with(kPolynomial)) {
    const vec3 a = parse_vec3(text.substr(kPolynomial.size()));
    if (glm::any(glm::lessThan(a, vec3(0.0f))) || !(max_component(a) > 0.0f)) {
      throw UsageError("the coefficients must not be negative, nor all 0");
    }
    return {Falloff::polynomial, a};
  }
  return {one_of(text, kFalloffs)};
}

BackgroundChoice parse_background(const std::string& text) {
  if (text == "env") return {Background::environment};
  if (text == "transparent") return {Background::transparent};
  const std::optional<vec4> color = text.starts_with('#') ? hex_color(text) : std::nullopt;
  if (!color) return {Background::transparent, parse_color(text)};
  if (color->w == 0.0f) return {Background::transparent};
  return {Background::transparent, vec3(*color), color->w};
}

GroundChoice parse_ground(const std::string& text) {
  constexpr std::string_view kMirror = "mirror:";
  GroundChoice ground;
  const std::size_t plus = text.find('+');
  const std::string first = text.substr(0, plus);
  const bool is_mirror_alone = plus == std::string::npos && first.starts_with(kMirror);
  const std::string mirror = is_mirror_alone ? first : plus == std::string::npos ? "" : text.substr(plus + 1);
  if (plus != std::string::npos && !mirror.starts_with(kMirror)) {
    throw UsageError(fmt::format("'{}' is not mirror:X with X from 0 to 1", mirror));
  }
  if (!mirror.empty()) ground.mirror = parse_number(mirror.substr(kMirror.size()), 0.0f, 1.0f);
  if (is_mirror_alone || first == "shadow") return ground;
  try {
    ground.color = parse_color(first);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("neither shadow, nor mirror:X; {}", error.what()));
  }
  if (max_component(*ground.color) > 1.0f) throw UsageError("no ground reflects more than all light");
  return ground;
}

bool parse_glass(const std::string& text) {
  if (text == "background") return false;
  if (text == "env") return true;
  throw UsageError(fmt::format("'{}' is neither 'background' nor 'env'", text));
}

std::optional<float> parse_focus(const std::string& text) {
  if (text == "auto") return std::nullopt;
  const auto [metres, unit] = leading_number(text);
  if ((!unit.empty() && unit != "m") || metres <= 0.0) {
    throw UsageError(fmt::format("'{}' is neither a distance in metres nor 'auto'", text));
  }
  return narrow(metres, text);
}

std::string one_line(const std::string& text) {
  std::string line = text;
  std::replace_if(
      line.begin(), line.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }, ' ');
  return line;
}

}  // namespace candela::cli
