#include "candela/difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "candela/verdict.h"
#include "image/flip.h"
#include "shade/color.glsl.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

struct Pixels {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<double> values;
};

/// What numbers are compared by: linear values as they are, those of a display as they are shown.
Pixels compared_values(const Image& image, int channels, bool is_display) {
  Pixels result{image.width, image.height, channels, {}};
  const std::size_t count = image.pixels.size() / static_cast<std::size_t>(image.channels);
  result.values.reserve(count * static_cast<std::size_t>(channels));
  for (std::size_t i = 0; i < count; ++i) {
    const float* pixel = image.pixels.data() + i * static_cast<std::size_t>(image.channels);
    for (int c = 0; c < channels; ++c) {
      const float value = c < image.channels ? pixel[c] : 1.0f;  // without alpha a picture is opaque
      result.values.push_back(is_display && c < 3 ? shade::srgb_encode_channel(value) : value);
    }
  }
  return result;
}

void require_equal_sizes(const Image& a, const Image& b, const std::string& first, const std::string& second) {
  if (a.width == b.width && a.height == b.height) return;
  throw Error(second + " is " + std::to_string(b.width) + "x" + std::to_string(b.height) + " pixels, " + first + " " +
              std::to_string(a.width) + "x" + std::to_string(a.height));
}

LayerDifference compare_values(const Pixels& a, const Pixels& b, double tolerance) {
  LayerDifference result;
  double sum = 0.0;
  std::size_t finite = 0;
  const std::size_t channels = static_cast<std::size_t>(a.channels);
  for (std::size_t i = 0; i < a.values.size(); i += channels) {
    bool has_changed = false;
    bool is_broken = false;
    for (std::size_t c = i; c < i + channels; ++c) {
      const double p = a.values[c];
      const double q = b.values[c];
      if (std::isfinite(p) && std::isfinite(q)) {
        const double difference = std::abs(q - p);
        sum += difference;
        ++finite;
        result.max = std::max(result.max, difference);
        has_changed = has_changed || difference > tolerance;
      } else if (!(p == q)) {  // both may be infinitely far
        is_broken = true;
      }
    }
    result.broken += is_broken ? 1 : 0;
    result.changed += is_broken || has_changed ? 1 : 0;
  }
  result.mean = finite > 0 ? sum / static_cast<double>(finite) : 0.0;
  return result;
}

LayerDifference compare_images(const Image& a, const Image& b, bool is_display, double tolerance) {
  const int channels = std::max(a.channels, b.channels);
  return compare_values(compared_values(a, channels, is_display), compared_values(b, channels, is_display), tolerance);
}

/// Four channels, no NaN: a meter and a tone curve have no answer to that.
Film film_of(const Image& image) {
  Film film;
  film.beauty = Image(image.width, image.height, 4);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const vec3 color = image.rgb(x, y);
      const auto finite = [](float v) { return std::isfinite(v) ? v : 0.0f; };
      film.beauty.set_rgb(x, y, {finite(color.x), finite(color.y), finite(color.z)});
      film.beauty.at(x, y)[3] = image.channels == 4 ? glm::clamp(finite(image.at(x, y)[3]), 0.0f, 1.0f) : 1.0f;
    }
  }
  return film;
}

bool is_transparent(const Film& film) {
  for (std::size_t i = 3; i < film.beauty.pixels.size(); i += 4) {
    if (film.beauty.pixels[i] < 1.0f) return true;
  }
  return false;
}

Image linear(const DisplayImage& image) {
  Image result(image.width, image.height, 3);
  for (std::size_t i = 0; i < result.pixels.size(); ++i) {
    const float code = static_cast<float>(image.rgba[i / 3 * 4 + i % 3]) / 255.0f;
    result.pixels[i] = shade::srgb_decode_channel(code);
  }
  return result;
}

/// A picture and how it is shown: without a background, with an exposure.
struct Side {
  const Film& film;
  DevelopSettings develop;
};

Image shown_over(const Side& side, float background) {
  DevelopSettings settings = side.develop;
  settings.background = vec3(background);
  return linear(develop(side.film, settings));
}

/// Colours over black, and the alpha of `shown` where there are four channels.
Image shown_values(const Side& side, const DisplayImage& shown, int channels) {
  const Image over_black = shown_over(side, 0.0f);
  Image result(over_black.width, over_black.height, channels);
  for (std::size_t i = 0; i < shown.rgba.size() / 4; ++i) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
      result.pixels[i * static_cast<std::size_t>(channels) + c] =
          c < 3 ? over_black.pixels[i * 3 + c] : static_cast<float>(shown.rgba[i * 4 + 3]) / 255.0f;
    }
  }
  return result;
}

/// What the eye sees of the difference, and what it sees it in.
void compare_as_seen(const Side& a, const Side& b, PictureDifference& result) {
  result.first = develop(a.film, a.develop);
  result.second = develop(b.film, b.develop);
  result.error = flip(shown_over(a, 0.0f), shown_over(b, 0.0f));
  if (is_transparent(a.film) || is_transparent(b.film)) {
    const Image over_white = flip(shown_over(a, 1.0f), shown_over(b, 1.0f));
    for (std::size_t i = 0; i < over_white.pixels.size(); ++i) {
      result.error.pixels[i] = std::max(result.error.pixels[i], over_white.pixels[i]);
    }
  }
  double sum = 0.0;
  for (const float error : result.error.pixels) {
    sum += error;
    result.flip_max = std::max(result.flip_max, static_cast<double>(error));
  }
  result.flip = sum / static_cast<double>(result.error.pixels.size());
}

/// A picture, and its file where that has layers beside it which count too.
struct Opened {
  explicit Opened(const ImageName& name) {
    const bool is_whole = name.layer.empty();
    if (is_whole && sniff_image_format(read_head(name.path, kSniffedBytes)) == ImageFormat::exr)
      file.emplace(name.path);
    picture = file ? file->read() : read_image_file(name);
  }
  std::vector<std::string> layers() const { return file ? file->header().layers : std::vector<std::string>(); }

  std::optional<ExrFile> file;
  ImageFile picture;
};

void compare_layers(const ImageName& first, const ImageName& second, Opened& a, Opened& b, double tolerance,
                    PictureDifference& result) {
  const std::vector<std::string> of_a = a.layers(), of_b = b.layers();
  std::set_symmetric_difference(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                                std::back_inserter(result.unmatched));
  std::vector<std::string> common;
  std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(common));
  for (const std::string& layer : common) {
    const Image p = a.file->read(layer).image;
    const Image q = b.file->read(layer).image;
    require_equal_sizes(p, q, first.text() + ":" + layer, second.text() + ":" + layer);
    result.layers.push_back(compare_images(p, q, false, tolerance));
    result.layers.back().layer = layer;
  }
}

bool is_picture(const fs::path& path) {
  constexpr std::array<std::string_view, 7> kExtensions = {".png", ".jpg", ".jpeg", ".webp", ".avif", ".hdr", ".exr"};
  return std::find(kExtensions.begin(), kExtensions.end(), lower_extension(path)) != kExtensions.end();
}

std::vector<fs::path> pictures_below(const fs::path& folder) {
  std::error_code code;
  std::vector<fs::path> result;
  fs::recursive_directory_iterator it(folder, code);
  for (; !code && it != fs::recursive_directory_iterator(); it.increment(code)) {
    if (it->is_regular_file() && is_picture(it->path())) result.push_back(it->path());
  }
  if (code) throw Error("cannot list: " + code.message(), folder.string());
  return result;
}

struct Listed {
  fs::path folder;
  std::vector<fs::path> files;
};

std::vector<FilePair> pairs_of(const Listed& first, const Listed& second) {
  std::map<std::string, FilePair> pairs;
  for (const fs::path& path : first.files) pairs[path.lexically_relative(first.folder).generic_string()].first = path;
  for (const fs::path& path : second.files) {
    pairs[path.lexically_relative(second.folder).generic_string()].second = path;
  }
  std::vector<FilePair> result;
  result.reserve(pairs.size());
  for (auto& [name, pair] : pairs) {
    pair.name = name;
    result.push_back(std::move(pair));
  }
  return result;
}

}  // namespace

PictureDifference compare_pictures(const ImageName& first, const ImageName& second,
                                   const DifferenceSettings& settings) {
  Opened opened_a(first), opened_b(second);
  const ImageFile& a = opened_a.picture;
  const ImageFile& b = opened_b.picture;
  require_equal_sizes(a.image, b.image, first.text(), second.text());
  PictureDifference result;
  result.size = {a.image.width, a.image.height};
  const bool is_display_a = is_display_format(a.format);
  const bool is_display_b = is_display_format(b.format);
  result.is_display = is_display_a && is_display_b;
  result.layers.push_back(compare_images(a.image, b.image, result.is_display, settings.tolerance));
  compare_layers(first, second, opened_a, opened_b, settings.tolerance, result);

  const Film film_a = film_of(a.image);
  const Film film_b = film_of(b.image);
  const Film& metered = is_display_a ? film_b : film_a;
  const float exposure =
      settings.exposure ? *settings.exposure : (result.is_display ? 1.0f : metered_exposure(metered));
  const auto develop_of = [&](bool is_display) {
    if (is_display) return DevelopSettings{.exposure = 1.0f, .tone_curve = ToneCurve::linear, .dither = false};
    return DevelopSettings{.exposure = exposure, .tone_curve = settings.tone_curve, .dither = false};
  };
  compare_as_seen({film_a, develop_of(is_display_a)}, {film_b, develop_of(is_display_b)}, result);
  return result;
}

PictureDifference compare_films(const Film& first, const Film& second, const DevelopSettings& develop,
                                double tolerance) {
  require_equal_sizes(first.beauty, second.beauty, "the first", "the second");
  PictureDifference result;
  result.size = {first.width(), first.height()};
  result.is_display = true;
  const DevelopSettings shown{.exposure = develop.exposure ? *develop.exposure : metered_exposure(first),
                              .tone_curve = develop.tone_curve,
                              .dither = false};
  const Side a{first, shown}, b{second, shown};
  compare_as_seen(a, b, result);
  const int channels = is_transparent(first) || is_transparent(second) ? 4 : 3;
  result.layers.push_back(compare_images(shown_values(a, result.first, channels),
                                         shown_values(b, result.second, channels), true, tolerance));
  return result;
}

std::vector<FilePair> picture_pairs(const fs::path& first, const fs::path& second) {
  std::vector<FilePair> pairs = pairs_of({first, pictures_below(first)}, {second, pictures_below(second)});
  if (pairs.empty()) throw Error("no picture below", first.string());
  return pairs;
}

std::vector<FilePair> scene_pairs(const fs::path& first, const fs::path& second) {
  const auto scenes = [](const fs::path& folder) {
    const std::vector<std::string> names = find_scenes_below(folder);
    return Listed{folder, {names.begin(), names.end()}};
  };
  const Listed a = scenes(first), b = scenes(second);
  if (a.files.empty() || b.files.empty()) return {};
  return pairs_of(a, b);
}

Comparable comparable_of(const std::string& name) {
  std::error_code ignored;
  if (name.starts_with("demo:")) return Comparable::scene;
  if (fs::is_directory(name, ignored)) return Comparable::folder;
  const ImageName image = parse_image_name(name);
  if (!image.layer.empty() || is_picture(image.path)) return Comparable::picture;
  const bool is_image = sniff_image_format(read_head(image.path, kSniffedBytes)) != ImageFormat::unknown;
  return is_image ? Comparable::picture : Comparable::scene;
}

DisplayImage error_map(const Image& error) {
  constexpr std::array<vec3, 5> kColors = {vec3(0, 0, 0), vec3(80, 18, 110), vec3(200, 45, 70), vec3(250, 150, 40),
                                           vec3(255, 250, 200)};
  DisplayImage map{error.width, error.height, {}};
  map.rgba.reserve(error.pixels.size() * 4);
  for (const float value : error.pixels) {
    const float place = glm::clamp(value, 0.0f, 1.0f) * static_cast<float>(kColors.size() - 1);
    const std::size_t below = std::min(static_cast<std::size_t>(place), kColors.size() - 2);
    const vec3 color = glm::mix(kColors[below], kColors[below + 1], place - static_cast<float>(below));
    for (int c = 0; c < 3; ++c) map.rgba.push_back(static_cast<std::uint8_t>(std::lround(color[c])));
    map.rgba.push_back(255);
  }
  return map;
}

}  // namespace candela
