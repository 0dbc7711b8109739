#include "base/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <vector>

namespace candela {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string lower_extension(const std::filesystem::path& path) { return lower_case(path.extension().string()); }

std::string counted(std::uint64_t count, std::string_view thing) {
  return std::to_string(count) + ' ' + std::string(thing) + (count == 1 ? "" : "s");
}

namespace {

/// Damerau 1964, "A technique for computer detection and correction of spelling errors": slips between two words, a
/// pair of letters swapped once.
std::size_t slips_between(std::string_view a, std::string_view b) {
  const std::size_t columns = b.size() + 1;
  std::vector<std::size_t> table((a.size() + 1) * columns);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return table[i * columns + j]; };
  for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = i;
  for (std::size_t j = 0; j <= b.size(); ++j) at(0, j) = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t exchange = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, exchange});
      const bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_swap) at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return at(a.size(), b.size());
}

}  // namespace

std::string nearest_name(std::string_view text, std::span<const std::string> names) {
  constexpr std::size_t kLongest = 64;  // of what a person would mistype
  std::string nearest;
  if (text.size() > kLongest) return nearest;
  const std::string word = lower_case(std::string(text));
  std::size_t fewest = std::max<std::size_t>(word.size(), 3) / 3 + 1;
  for (const std::string& name : names) {
    const std::size_t slips = slips_between(word, lower_case(name));
    if (slips < fewest && slips < name.size()) fewest = slips, nearest = name;
  }
  return nearest;
}

std::string did_you_mean(std::string_view text, std::span<const std::string> names, std::string_view before) {
  const std::string nearest = nearest_name(text, names);
  return nearest.empty() ? nearest : std::string(before) + "did you mean " + nearest + "?";
}

double decimal_of(float value) {
  if (!std::isfinite(value)) return static_cast<double>(value);
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
  double result = 0.0;
  std::from_chars(text.data(), written.ptr, result);
  return result;
}

}  // namespace candela
