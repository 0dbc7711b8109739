#include "image/table_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/error.h"
#include "base/file.h"

namespace candela {

namespace {

/// A JSON string.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      result += std::string("\\") + c;
    else if (code < 32)
      result += fmt::format("\\u{:04x}", code);
    else
      result += c;
  }
  return result + "\"";
}

/// Text that may stand in a C comment, on one line.
std::string comment(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == '*'; }, ' ');
  return text;
}

std::string number(float value, const std::string& where) {
  if (!std::isfinite(value)) throw Error("a number that is not finite cannot be written", where);
  return fmt::format("{}", value);
}

/// A float literal of C: "1" is no float, and neither is "1f".
std::string literal(float value, const std::string& where) {
  std::string text = number(value, where);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "f";
}

void check_name(const std::string& name, const std::string& where) {
  const bool good = !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0 &&
                    std::all_of(name.begin(), name.end(),
                                [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
  if (!good) throw Error("\"" + name + "\" cannot be a name in C", where);
}

void check_table(const Image& table, const TableText& text, const std::string& where) {
  if (table.empty()) throw Error("cannot write an empty table", where);
  if (text.channels.empty() || text.channels.size() > static_cast<std::size_t>(table.channels))
    throw Error(fmt::format("a table of {} channels has {} names", table.channels, text.channels.size()), where);
}

std::size_t bands_of(std::size_t coefficients, const std::string& where) {
  const auto bands = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(coefficients))));
  if (bands < 1 || bands * bands != coefficients)
    throw Error(fmt::format("{} coefficients are no whole number of bands", coefficients), where);
  return bands;
}

/// The first `count` channels of a texel, separated by commas.
template <class Format>
std::string texel(const Image& table, int x, int y, std::size_t count, Format format) {
  std::string text;
  for (std::size_t c = 0; c < count; ++c) text += (c == 0 ? "" : ", ") + format(table.at(x, y)[c]);
  return text;
}

}  // namespace

void write_sh_json(const std::filesystem::path& path, std::span<const dvec3> coefficients, const ShText& text) {
  const std::string where = path.string();
  std::string out = fmt::format(
      "{{\n  \"bands\": {},\n  \"unit\": {},\n  \"basis\": {},\n  \"axes\": {},\n  \"source\": {},\n"
      "  \"coefficients\": [\n",
      bands_of(coefficients.size(), where), quoted(text.unit), quoted(text.basis), quoted(text.axes),
      quoted(text.source));
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const vec3 c(coefficients[i]);
    out += fmt::format("    [{}, {}, {}]{}\n", number(c.x, where), number(c.y, where), number(c.z, where),
                       i + 1 < coefficients.size() ? "," : "");
  }
  write_file(path, out + "  ]\n}\n");
}

void write_sh_header(const std::filesystem::path& path, std::span<const dvec3> coefficients, const ShText& text,
                     const std::string& name) {
  const std::string where = path.string();
  check_name(name, where);
  const std::size_t bands = bands_of(coefficients.size(), where);
  std::string out =
      fmt::format("/* Spherical harmonics of {}, {} bands: {}.\n   {}; looked up by {}. */\n", comment(text.source),
                  bands, comment(text.unit), comment(text.basis), comment(text.axes));
  out += fmt::format("enum {{ {}_coefficients = {} }};\n", name, coefficients.size());
  out += fmt::format("static const float {}[{}][3] = {{\n", name, coefficients.size());
  for (const dvec3& coefficient : coefficients) {
    const vec3 c(coefficient);
    out += fmt::format("    {{{}, {}, {}}},\n", literal(c.x, where), literal(c.y, where), literal(c.z, where));
  }
  write_file(path, out + "};\n");
}

void write_table_json(const std::filesystem::path& path, const Image& table, const TableText& text) {
  const std::string where = path.string();
  check_table(table, text, where);
  std::string names;
  for (const std::string& channel : text.channels) names += (names.empty() ? "" : ", ") + quoted(channel);
  std::string out = fmt::format(
      "{{\n  \"title\": {},\n  \"width\": {},\n  \"height\": {},\n  \"columns\": {},\n  \"rows\": {},\n"
      "  \"channels\": [{}],\n  \"values\": [\n",
      quoted(text.title), table.width, table.height, quoted(text.columns), quoted(text.rows), names);
  for (int y = 0; y < table.height; ++y) {
    out += "    [";
    for (int x = 0; x < table.width; ++x) {
      out += x == 0 ? "[" : ", [";
      out += texel(table, x, y, text.channels.size(), [&](float v) { return number(v, where); }) + "]";
    }
    out += y + 1 < table.height ? "],\n" : "]\n";
  }
  write_file(path, out + "  ]\n}\n");
}

void write_table_header(const std::filesystem::path& path, const Image& table, const TableText& text,
                        const std::string& name) {
  const std::string where = path.string();
  check_table(table, text, where);
  check_name(name, where);
  std::string names;
  for (const std::string& channel : text.channels) names += (names.empty() ? "" : ", ") + comment(channel);
  std::string out = fmt::format("/* {}: {}.\n   Columns: {}. Rows: {}. */\n", comment(text.title), names,
                                comment(text.columns), comment(text.rows));
  out += fmt::format("enum {{ {0}_width = {1}, {0}_height = {2}, {0}_channels = {3} }};\n", name, table.width,
                     table.height, text.channels.size());
  out += fmt::format("static const float {}[{}][{}][{}] = {{\n", name, table.height, table.width, text.channels.size());
  for (int y = 0; y < table.height; ++y) {
    out += "    {";
    for (int x = 0; x < table.width; ++x) {
      out += x == 0 ? "{" : ", {";
      out += texel(table, x, y, text.channels.size(), [&](float v) { return literal(v, where); }) + "}";
    }
    out += "},\n";
  }
  write_file(path, out + "};\n");
}

}  // namespace candela
