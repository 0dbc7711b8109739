#include "image/movie.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/text.h"

namespace candela {

namespace {

bool needs_ffmpeg(const std::string& extension) { return extension == ".mp4" || extension == ".webm"; }

}  // namespace

bool is_movie_name(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return needs_ffmpeg(extension) || extension == ".gif" || extension == ".webp";
}

void check_movie(const std::filesystem::path& path, const MovieSettings& settings) {
  const std::string extension = lower_extension(path);
  if (!is_movie_name(path)) throw Error("a film is a .mp4, .webm, .webp or .gif", path.string());
  if (!(settings.frame_rate >= 0.01 && settings.frame_rate <= 1000.0)) {
    throw Error(fmt::format("{:g} pictures per second are not within 0.01 and 1000", settings.frame_rate),
                path.string());
  }
  if (needs_ffmpeg(extension)) {
    movie::check_ffmpeg(path);
    if (settings.size.x < 2 || settings.size.y < 2) throw Error("a film is 2x2 pixels or more", path.string());
  }
  // Its delays are hundredths of a second, and programs take those below two for ten.
  if (extension == ".gif" && settings.frame_rate > 50.0) {
    throw Error("a GIF has at most 50 pictures per second", path.string());
  }
}

std::unique_ptr<MovieWriter> open_movie(const std::filesystem::path& path, const MovieSettings& settings) {
  check_movie(path, settings);
  const std::string extension = lower_extension(path);
  if (extension == ".gif") return movie::open_gif(path, settings);
  if (extension == ".webp") return movie::open_webp(path, settings);
  return movie::open_ffmpeg(path, settings);
}

namespace {

struct Bin {
  std::array<int, 3> at;  ///< 0 … 31
  std::uint64_t count;
};

/// Bins [first, end) that become one colour.
struct Cut {
  std::size_t first, end;
  int axis = 0;       ///< the longest
  double cost = 0.0;  ///< what cutting it saves: its squared length times its pixels
};

Cut measured(const std::vector<Bin>& bins, std::size_t first, std::size_t end) {
  Cut cut{.first = first, .end = end};
  std::uint64_t count = 0;
  std::array<double, 3> sum{}, squares{};
  for (std::size_t i = first; i < end; ++i) {
    count += bins[i].count;
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = bins[i].at[c], n = static_cast<double>(bins[i].count);
      sum[c] += n * x, squares[c] += n * x * x;
    }
  }
  double longest = -1.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double variance = squares[c] - sum[c] * sum[c] / static_cast<double>(std::max<std::uint64_t>(count, 1));
    if (variance > longest) longest = variance, cut.axis = static_cast<int>(c);
  }
  cut.cost = end - first > 1 ? longest : 0.0;
  return cut;
}

/// Where half of the pixels are on either side.
std::size_t median(std::vector<Bin>& bins, const Cut& cut) {
  const auto begin = bins.begin() + static_cast<std::ptrdiff_t>(cut.first);
  const auto end = bins.begin() + static_cast<std::ptrdiff_t>(cut.end);
  const auto axis = static_cast<std::size_t>(cut.axis);
  std::sort(begin, end, [&](const Bin& a, const Bin& b) {
    return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.at < b.at;
  });
  std::uint64_t all = 0, below = 0;
  for (std::size_t i = cut.first; i < cut.end; ++i) all += bins[i].count;
  std::size_t at = cut.first;
  for (; at + 1 < cut.end && 2 * (below + bins[at].count) <= all; ++at) below += bins[at].count;
  return std::max(at, cut.first + 1);
}

std::array<std::uint8_t, 3> mean_color(const std::vector<Bin>& bins, const Cut& cut) {
  std::array<double, 3> sum{};
  double count = 0.0;
  for (std::size_t i = cut.first; i < cut.end; ++i) {
    const auto n = static_cast<double>(bins[i].count);
    count += n;
    // The ends stay black and white.
    for (std::size_t c = 0; c < 3; ++c) sum[c] += n * bins[i].at[c] * 255.0 / 31.0;
  }
  std::array<std::uint8_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c) color[c] = static_cast<std::uint8_t>(sum[c] / count + 0.5);
  return color;
}

}  // namespace

Palette::Palette(const std::vector<std::uint64_t>& counts) : nearest_(kBins, 0) {
  std::vector<Bin> bins;
  for (std::size_t i = 0; i < kBins; ++i) {
    const int bin = static_cast<int>(i);
    if (counts[i] > 0) bins.push_back({{bin / 1024, bin / 32 % 32, bin % 32}, counts[i]});
  }
  if (bins.empty()) bins.push_back({{0, 0, 0}, 1});
  std::vector<Cut> cuts = {measured(bins, 0, bins.size())};
  while (cuts.size() < kColors) {
    const auto largest =
        std::max_element(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.cost < b.cost; });
    if (!(largest->cost > 0.0)) break;
    const std::size_t at = median(bins, *largest);
    const Cut second = measured(bins, at, largest->end);
    *largest = measured(bins, largest->first, at);
    cuts.push_back(second);
  }
  for (const Cut& cut : cuts) colors_.push_back(mean_color(bins, cut));
  for (std::size_t i = 0; i < kBins; ++i) {
    const int bin = static_cast<int>(i);
    const std::array<int, 3> at = {bin / 1024 * 255 / 31, bin / 32 % 32 * 255 / 31, bin % 32 * 255 / 31};
    int best = std::numeric_limits<int>::max();
    for (std::size_t k = 0; k < colors_.size(); ++k) {
      int distance = 0;
      // About as the eye weighs them.
      constexpr std::array<int, 3> kWeights = {3, 6, 1};
      for (std::size_t c = 0; c < 3; ++c) distance += kWeights[c] * (at[c] - colors_[k][c]) * (at[c] - colors_[k][c]);
      if (distance < best) best = distance, nearest_[i] = static_cast<std::uint8_t>(k);
    }
  }
}

std::uint8_t Palette::nearest(int r, int g, int b) const {
  const auto bin = [](int channel) { return static_cast<std::size_t>((std::clamp(channel, 0, 255) * 31 + 127) / 255); };
  return nearest_[bin(r) * 1024 + bin(g) * 32 + bin(b)];
}

}  // namespace candela
