#include "io/ies.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/file.h"

namespace candela::io {

namespace {

constexpr std::size_t kLargestFile = std::size_t{8} << 20;  // real ones have some ten kilobytes
constexpr double kLargestCandela = 1e12;                    // a lighthouse has 1e7; keeps sums of a scene finite
constexpr float kLeastStep = 1e-3f;  // degrees between angles: stays above a float's step when mirrored up to 360

/// Lines at first, then numbers that flow over lines; it always knows the line it is in. CR, LF and CR LF end a line.
class Reader {
 public:
  Reader(std::string_view text, const std::string& where) : text_(text), where_(where) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(fmt::format("line {}: {}", line_, message), where_);
  }

  /// Without blanks at its ends; empty optional at the end of the text.
  std::optional<std::string_view> next_line() {
    if (at_ >= text_.size()) return std::nullopt;
    if (started_) line_ += 1;
    started_ = true;
    const std::size_t begin = at_;
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    at_ = std::min(end + (text_.substr(end).starts_with("\r\n") ? 2 : 1), text_.size());
    std::string_view line = text_.substr(begin, end - begin);
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    return line;
  }

  /// Called once, after the last next_line(): what follows stands in the next line.
  void begin_numbers() { line_ += 1; }

  /// The next number. `what`, number `index` of `count` where there are several, names it in errors.
  double number(const char* what, std::size_t index = 0, std::size_t count = 0) {
    const auto name = [&] {
      return count > 0 ? fmt::format("{} {} of {}", what, index + 1, count) : std::string(what);
    };
    skip_separators();
    if (at_ >= text_.size()) fail(fmt::format("the file ends before the {}", name()));
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_separator(text_[at_])) at_ += 1;
    std::string_view token = text_.substr(begin, at_ - begin);
    const std::string_view digits = token.starts_with('+') ? token.substr(1) : token;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      fail(fmt::format("the {} is '{}', which is no finite number", name(), printable(token)));
    }
    return value;
  }

  std::size_t whole(const char* what, std::size_t most) {
    const double value = number(what);
    if (!(value >= 0.0 && value <= static_cast<double>(most)) || value != std::floor(value)) {
      fail(fmt::format("the {} is {:g}; must be a whole number from 0 to {}", what, value, most));
    }
    return static_cast<std::size_t>(value);
  }

  bool has_more() {
    skip_separators();
    return at_ < text_.size();
  }
  /// How many numbers there can be in the rest of the text at most.
  std::size_t capacity() const { return (text_.size() - at_ + 1) / 2; }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v' || c == '\0' || c == '\x1A'; }
  static bool is_separator(char c) { return is_blank(c) || c == ',' || c == '\r' || c == '\n'; }
  static std::string printable(std::string_view token) {
    constexpr std::size_t kMostShown = 20;
    std::string out(token.substr(0, kMostShown));
    std::replace_if(
        out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return out;
  }
  void skip_separators() {
    for (; at_ < text_.size() && is_separator(text_[at_]); ++at_) {
      const bool is_first_of_two = text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n';
      if (text_[at_] == '\n' || (text_[at_] == '\r' && !is_first_of_two)) line_ += 1;
    }
  }

  std::string_view text_;
  const std::string& where_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool started_ = false;
};

struct Header {
  bool has_lamp_factor = false;  ///< the number after the ballast factor multiplies too; later it means something else
  bool has_tilt_table = false;
};

/// Everything up to the line TILT=…
Header read_header(Reader& reader, const std::string& where, Diagnostics& diagnostics) {
  Header header;
  const auto first = reader.next_line();
  if (!first) throw Error("line 1: the file is empty", where);
  // 1986 had no such line: its label lines begin at once.
  header.has_lamp_factor = !first->starts_with("IESNA:LM-63") && !first->starts_with("IES:LM-63");
  for (auto line = first; line; line = reader.next_line()) {
    if (!line->starts_with("TILT=")) continue;
    std::string_view tilt = line->substr(5);
    while (tilt.starts_with(' ')) tilt.remove_prefix(1);
    header.has_tilt_table = tilt == "INCLUDE";
    if (!header.has_tilt_table && tilt != "NONE") {
      diagnostics.warn("the tilt factors stand in another file and are left out", where);
    }
    return header;
  }
  reader.fail("no line begins with TILT=; this is no IES file");
}

/// Lamp-to-luminaire geometry, angles and factors by which a lamp that is mounted askew gives less light.
void skip_tilt_table(Reader& reader) {
  reader.whole("lamp-to-luminaire geometry", 3);
  const std::size_t count = reader.whole("number of tilt angles", reader.capacity());
  for (std::size_t i = 0; i < count; ++i) reader.number("tilt angle", i, count);
  for (std::size_t i = 0; i < count; ++i) reader.number("tilt factor", i, count);
}

double positive(Reader& reader, const char* what) {
  const double value = reader.number(what);
  if (!(value > 0.0)) reader.fail(fmt::format("the {} is {:g}; must be positive", what, value));
  return value;
}

std::vector<float> read_angles(Reader& reader, const char* what, std::size_t count, double lowest, double highest) {
  std::vector<float> angles(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = reader.number(what, i, count);
    if (!(angle >= lowest && angle <= highest)) {
      reader.fail(
          fmt::format("{} {} of {} is {:g}; must lie within {:g} to {:g}", what, i + 1, count, angle, lowest, highest));
    }
    angles[i] = static_cast<float>(angle);
    if (i > 0 && !(angles[i] >= angles[i - 1] + kLeastStep)) {
      reader.fail(fmt::format("{} {} of {} is {:g}; must be greater than the one before, {:g}", what, i + 1, count,
                              angle, angles[i - 1]));
    }
    // Whole quarters exactly: they say what the symmetry is.
    const float quarter = 90.0f * std::round(angles[i] / 90.0f);
    if (std::fabs(angles[i] - quarter) < 0.4f * kLeastStep) angles[i] = quarter;
  }
  return angles;
}

/// Rows of candela values with the horizontal angle of each.
struct Rows {
  std::size_t length = 0;
  std::vector<float> angles;
  std::vector<float> values;

  const float* row(std::size_t i) const { return values.data() + i * length; }
  void add(float angle, const Rows& from, std::size_t i) {
    angles.push_back(angle);
    values.insert(values.end(), from.row(i), from.row(i) + length);
  }
};

/// Adds the mirror images of all rows but the last at `axis`, which the last row stands on.
void mirror_at(Rows& rows, float axis) {
  const Rows half_turn = rows;
  for (std::size_t i = half_turn.angles.size() - 1; i-- > 0;) rows.add(2.0f * axis - half_turn.angles[i], half_turn, i);
}

/// From 90 … 270 (LM-63-1995, symmetric about the plane of 90° and 270°) to 0 … 180 … 360.
Rows unfolded_sideways(const Rows& rows) {
  Rows whole;
  whole.length = rows.length;
  const auto& angles = rows.angles;
  // The row of 180° becomes 0° and 360° too; interpolated where the file has none.
  const auto after = static_cast<std::size_t>(std::lower_bound(angles.begin(), angles.end(), 180.0f) - angles.begin());
  Rows back;
  back.length = rows.length;
  for (std::size_t i = 0; i < after; ++i) back.add(angles[i], rows, i);
  if (angles[after] != 180.0f) {
    const float t = (180.0f - angles[after - 1]) / (angles[after] - angles[after - 1]);
    back.angles.push_back(180.0f);
    for (std::size_t k = 0; k < rows.length; ++k) {
      back.values.push_back(rows.row(after - 1)[k] * (1.0f - t) + rows.row(after)[k] * t);
    }
  }
  for (std::size_t i = after; i < angles.size(); ++i) back.add(angles[i], rows, i);
  const std::size_t middle = after;
  for (std::size_t i = middle + 1; i-- > 0;) whole.add(180.0f - back.angles[i], back, i);
  for (std::size_t i = 1; i < back.angles.size(); ++i) whole.add(back.angles[i], back, i);
  for (std::size_t i = back.angles.size() - 1; i-- > middle;) whole.add(540.0f - back.angles[i], back, i);
  return whole;
}

/// By the range of the horizontal angles, which says the symmetry (LM-63-1995 §5.15).
void unfold(Rows& rows, const Reader& reader, const std::string& where, Diagnostics& diagnostics) {
  if (rows.angles.size() == 1) {
    rows.angles[0] = 0.0f;
    return;
  }
  const float first = rows.angles.front(), last = rows.angles.back();
  if (first == 90.0f && last == 270.0f) {
    rows = unfolded_sideways(rows);
    return;
  }
  if (first == 0.0f && last > 180.0f && last < 360.0f) {
    diagnostics.warn(fmt::format("the horizontal angles end at {:g}; the circle is closed with those of 0", last),
                     where);
    const Rows open = rows;
    rows.add(360.0f, open, 0);
    return;
  }
  if (first != 0.0f || (last != 90.0f && last != 180.0f && last != 360.0f)) {
    reader.fail(
        fmt::format("the horizontal angles run from {:g} to {:g}; must be one alone, 0 to 90, 0 to 180, "
                    "0 to 360 or 90 to 270",
                    first, last));
  }
  if (last == 90.0f) mirror_at(rows, 90.0f);
  if (last != 360.0f) mirror_at(rows, 180.0f);
}

/// The numbers after the counts, as the file has them.
struct Table {
  std::vector<float> vertical;
  Rows rows;  ///< one for each horizontal angle
};

/// `Rows` about the other of its two angles.
Rows transposed(const Table& table) {
  Rows result;
  result.length = table.rows.angles.size();
  result.angles = table.vertical;
  result.values.reserve(table.rows.values.size());
  for (std::size_t k = 0; k < table.vertical.size(); ++k) {
    for (std::size_t i = 0; i < result.length; ++i) result.values.push_back(table.rows.row(i)[k]);
  }
  return result;
}

/// Rows whose angles begin at 0, with their mirror images before them.
Rows mirrored_at_0(const Rows& rows) {
  if (rows.angles.front() != 0.0f) return rows;
  Rows whole;
  whole.length = rows.length;
  for (std::size_t i = rows.angles.size(); i-- > 1;) whole.add(-rows.angles[i], rows, i);
  for (std::size_t i = 0; i < rows.angles.size(); ++i) whole.add(rows.angles[i], rows, i);
  return whole;
}

/// Rows around a circle, from -180 to 180 at most, as 0 to 360: dark where there are none.
Rows around_circle(const Rows& rows) {
  std::vector<std::pair<float, std::vector<float>>> all;
  const auto copy = [&](std::size_t i) { return std::vector<float>(rows.row(i), rows.row(i) + rows.length); };
  const auto turned = [](float angle) { return angle < 0.0f ? angle + 360.0f : angle; };
  const float first = rows.angles.front(), last = rows.angles.back();
  const bool is_closed = last - first >= 360.0f - 2.0f * kLeastStep;
  for (std::size_t i = is_closed ? 1 : 0; i < rows.angles.size(); ++i)
    all.emplace_back(turned(rows.angles[i]), copy(i));
  if (!is_closed) {
    const std::vector<float> dark(rows.length, 0.0f);
    all.emplace_back(turned(last + kLeastStep), dark);
    all.emplace_back(turned(first - kLeastStep), dark);
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  // Where the circle begins, between its last row and its first where neither is there.
  if (all.front().first != 0.0f) {
    const auto& [before, low] = all.back();
    const auto& [after, high] = all.front();
    const float t = (360.0f - before) / (360.0f - before + after);
    std::vector<float> middle(rows.length);
    for (std::size_t k = 0; k < rows.length; ++k) middle[k] = low[k] + (high[k] - low[k]) * t;
    all.emplace(all.begin(), 0.0f, std::move(middle));
  }
  all.emplace_back(360.0f, all.front().second);
  Rows circle;
  circle.length = rows.length;
  for (const auto& [angle, values] : all) {
    circle.angles.push_back(angle);
    circle.values.insert(circle.values.end(), values.begin(), values.end());
  }
  return circle;
}

mat3 rows_of(vec3 x, vec3 y, vec3 z) { return glm::transpose(mat3(x, y, z)); }

/// Types A and B: the web of type C about another axis. Latitudes become angles from its pole.
void lay_on_side(bool is_type_b, const Table& table, IesProfile& profile) {
  Table whole = table;
  whole.rows = mirrored_at_0(table.rows);
  Table other{whole.rows.angles, mirrored_at_0(transposed(whole))};
  whole = {other.rows.angles, transposed(other)};

  Rows turned;
  std::vector<float> latitudes;
  if (is_type_b) {
    // About y: the vertical angle turns from -z to +x, the latitude rises towards -y.
    turned = other.rows;
    latitudes = whole.rows.angles;
    profile.web_from_light = rows_of({0, 0, -1}, {1, 0, 0}, {0, -1, 0});
  } else {
    // About x: the horizontal angle turns from -z to -y, which is against the web's, the latitude rises towards +x.
    turned.length = whole.rows.length;
    for (std::size_t i = whole.rows.angles.size(); i-- > 0;) turned.add(-whole.rows.angles[i], whole.rows, i);
    latitudes = whole.vertical;
    profile.web_from_light = rows_of({0, 0, -1}, {0, 1, 0}, {1, 0, 0});
  }
  Rows circle = around_circle(turned);
  profile.horizontal_deg = std::move(circle.angles);
  profile.candela = std::move(circle.values);
  for (const float latitude : latitudes) profile.vertical_deg.push_back(latitude + 90.0f);
}

enum class PhotometricType { c = 1, b = 2, a = 3 };

}  // namespace

IesProfile parse_ies(std::string_view text, const std::string& where, Diagnostics& diagnostics) {
  if (text.size() > kLargestFile) throw Error("line 1: the file is larger than 8 MiB", where);
  Reader reader(text, where);
  const Header header = read_header(reader, where, diagnostics);
  reader.begin_numbers();
  if (header.has_tilt_table) skip_tilt_table(reader);

  // ----- the lamp
  reader.number("number of lamps");
  reader.number("lumens per lamp");  // -1: absolute photometry
  const double multiplier = positive(reader, "candela multiplier");
  const std::size_t vertical_count = reader.whole("number of vertical angles", reader.capacity());
  if (vertical_count < 2) reader.fail("needs at least 2 vertical angles");
  const std::size_t horizontal_count = reader.whole("number of horizontal angles", reader.capacity());
  if (horizontal_count < 1) reader.fail("needs at least 1 horizontal angle");
  if (vertical_count > reader.capacity() / horizontal_count) {
    reader.fail(fmt::format("the file is too short for {} × {} candela values", vertical_count, horizontal_count));
  }
  const std::size_t type_number = reader.whole("photometric type", 3);
  if (type_number == 0) reader.fail("the photometric type must be 1 (C), 2 (B) or 3 (A)");
  const auto type = static_cast<PhotometricType>(type_number);
  const bool is_type_c = type == PhotometricType::c;
  if (!is_type_c && horizontal_count < 2) reader.fail("types A and B need at least 2 horizontal angles");
  for (const char* what : {"units type", "width", "length", "height"}) reader.number(what);
  const double ballast_factor = positive(reader, "ballast factor");
  const double lamp_factor = header.has_lamp_factor ? positive(reader, "ballast-lamp photometric factor")
                                                    : (reader.number("reserved field"), 1.0);
  reader.number("input watts");

  // ----- the table
  // What turns about the pole of its web may go all around, latitudes go from pole to pole.
  const double vertical_reach = type == PhotometricType::b ? 180.0 : 90.0;
  const double horizontal_reach = type == PhotometricType::a ? 180.0 : 90.0;
  Table table;
  table.vertical = is_type_c ? read_angles(reader, "vertical angle", vertical_count, 0.0, 180.0)
                             : read_angles(reader, "vertical angle", vertical_count, -vertical_reach, vertical_reach);
  Rows& rows = table.rows;
  rows.length = vertical_count;
  rows.angles = is_type_c
                    ? read_angles(reader, "horizontal angle", horizontal_count, 0.0, 360.0)
                    : read_angles(reader, "horizontal angle", horizontal_count, -horizontal_reach, horizontal_reach);
  const double factor = multiplier * ballast_factor * lamp_factor;
  const std::size_t count = vertical_count * horizontal_count;
  rows.values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double candela = reader.number("candela value", i, count) * factor;
    if (!(candela >= 0.0 && candela <= kLargestCandela)) {
      reader.fail(fmt::format("candela value {} of {} is {:g} cd; must lie within 0 to {:g}", i + 1, count, candela,
                              kLargestCandela));
    }
    rows.values.push_back(static_cast<float>(candela));
  }
  IesProfile profile;
  if (is_type_c) {
    unfold(rows, reader, where, diagnostics);
    profile.vertical_deg = std::move(table.vertical);
    profile.horizontal_deg = std::move(rows.angles);
    profile.candela = std::move(rows.values);
  } else {
    lay_on_side(type == PhotometricType::b, table, profile);
  }
  if (reader.has_more()) diagnostics.warn("more follows after the last candela value and is left out", where);
  return profile;
}

IesProfile load_ies(const std::filesystem::path& path, Diagnostics& diagnostics) {
  const std::vector<std::byte> bytes = read_file(path, kLargestFile);
  IesProfile profile =
      parse_ies({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string(), diagnostics);
  profile.name = path.stem().string();
  return profile;
}

}  // namespace candela::io
