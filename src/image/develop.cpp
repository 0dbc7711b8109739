#include "image/develop.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "base/named_row.h"
#include "base/parallel.h"
#include "base/text.h"
#include "image/bloom.h"
#include "image/image_file.h"
#include "shade/color.glsl.h"

namespace candela {

namespace {

/// sRGB encoding times 255, as a table of straight lines: 256 per octave from 2^-9, which is below the curve's own
/// straight part. Off by less than 1.3e-4 of a code value (second-order error of x^(1/2.4) over 1/256 of an octave).
class SrgbEncoder {
 public:
  SrgbEncoder() {
    for (std::uint32_t i = 0; i < lines_.size(); ++i) {
      const float low = exact(value_at(i));
      lines_[i] = {low, (exact(value_at(i + 1)) - low) / static_cast<float>(1u << kFractionBits)};
    }
  }

  /// `linear` in [0, 1] → [0, 255]; 0 and 1 come out exact.
  float operator()(float linear) const {
    if (linear <= 0.0031308f) return linear * (12.92f * 255.0f);
    if (linear >= 1.0f) return 255.0f;
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(linear) - kFirst;
    const Line line = lines_[bits >> kFractionBits];
    return std::min(line.start + line.slope * static_cast<float>(bits & ((1u << kFractionBits) - 1)), 255.0f);
  }

 private:
  struct Line {
    float start, slope;
  };
  static constexpr std::uint32_t kFractionBits = 15;  // 23 mantissa bits less the 8 that choose the line
  static constexpr std::uint32_t kFirst = (127 - 9) << 23;
  static float value_at(std::uint32_t i) { return std::bit_cast<float>(kFirst + (i << kFractionBits)); }
  static float exact(float linear) { return 255.0f * shade::srgb_encode_channel(linear); }

  std::array<Line, std::size_t{9} * 256> lines_;
};

/// Rounding offset of a pixel in [0, 1), equidistributed over any neighbourhood: the plastic-number lattice folded to a
/// triangle (Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences", dithering mask). Integers, so
/// that every machine gives the same bytes; 16 bits, so that 255 + offset stays below 256 in single precision.
float dither_offset(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t z = x * 3242174889u + y * 2447445414u;  // 2^32 / 1.3247…, 2^32 / 1.3247…²
  const std::uint32_t folded = z < 0x80000000u ? z << 1 : ~z << 1;
  return static_cast<float>(folded >> 16) * 0x1p-16f;
}

/// What is developed: light, and what is seen through it, empty or of the same size.
struct Picture {
  const Image& beauty;
  const Image& through;
};

std::uint8_t code(float encoded, float offset) { return static_cast<std::uint8_t>(encoded + offset); }
float positive(float v) { return v > 0.0f ? v : 0.0f; }  // NaN becomes 0

/// Alpha of what covers `alpha` of a pixel, and of the background that shows in the rest.
float opacity_before(float alpha, const DevelopSettings& settings) {
  if (!settings.background) return alpha;
  return settings.background_opacity == 1.0f ? 1.0f : alpha + (1.0f - alpha) * settings.background_opacity;
}

/// A pixel whose light, `shown` where there is any, covers `coverage` of it and lets `through` of what is behind show:
/// what glass reflects and what is seen through it are added as they would be in an eye.
vec3 before_background(vec3 shown, float coverage, vec3 through, const DevelopSettings& settings, float& alpha) {
  shown *= coverage;
  if (settings.background) shown += settings.background_opacity * *settings.background * glm::max(through, vec3(0.0f));
  alpha = opacity_before(alpha, settings);
  if (alpha == 1.0f) return shown;
  alpha = std::max(alpha, std::min(max_component(shown), 1.0f));
  return alpha > 0.0f ? shown / alpha : vec3(0.0f);
}

template <shade::vec3 (*Curve)(shade::vec3)>
void develop_row(const Picture& picture, int y, float exposure, const DevelopSettings& settings,
                 const SrgbEncoder& encode, std::uint8_t* out) {
  const Image& beauty = picture.beauty;
  for (int x = 0; x < beauty.width; ++x, out += 4) {
    const float* p = beauty.pixels.data() + beauty.index(x, y);
    const float* behind = picture.through.empty() ? nullptr : picture.through.at(x, y).data();
    float alpha = beauty.channels == 4 ? std::min(positive(p[3]), 1.0f) : 1.0f;
    const float coverage = behind != nullptr ? std::min(positive(behind[3]), 1.0f) : alpha;
    const vec3 rgb = beauty.rgb(x, y);
    const float scale = coverage > 0.0f ? exposure / coverage : 0.0f;
    vec3 shown = Curve(vec3(positive(rgb.x), positive(rgb.y), positive(rgb.z)) * scale);
    if (behind != nullptr) {
      shown = before_background(shown, coverage, {behind[0], behind[1], behind[2]}, settings, alpha);
    } else if (settings.background) {
      const float both = opacity_before(alpha, settings);
      shown = shown * alpha + *settings.background * ((1.0f - alpha) * settings.background_opacity);
      if (both > 0.0f) shown = shown / both;
      alpha = both;
    }
    out[3] = static_cast<std::uint8_t>(alpha * 255.0f + 0.5f);
    if (max_component(rgb) == kInfinity) {
      out[0] = out[1] = out[2] = 255;
      continue;
    }
    // One offset for the three channels keeps greys grey; a plain background has no gradient to dither.
    const float offset = settings.dither && coverage > 0.0f
                             ? dither_offset(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))
                             : 0.5f;
    out[0] = code(encode(shown.x), offset);
    out[1] = code(encode(shown.y), offset);
    out[2] = code(encode(shown.z), offset);
  }
}

/// Of a curve in its table.
std::size_t place_of(ToneCurve curve) {
  const auto found = std::find_if(kToneCurves.begin(), kToneCurves.end(),
                                  [&](const ToneCurveInfo& info) { return info.curve == curve; });
  CANDELA_CHECK(found != kToneCurves.end());
  return static_cast<std::size_t>(found - kToneCurves.begin());
}

using RowFunction = void (*)(const Picture&, int, float, const DevelopSettings&, const SrgbEncoder&, std::uint8_t*);

RowFunction row_function(ToneCurve curve) {
  constexpr auto kFunctions = []<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<RowFunction, sizeof...(I)>{develop_row<kToneCurves[I].function>...};
  }
  (std::make_index_sequence<kToneCurves.size()>{});
  return kFunctions[place_of(curve)];
}

// ----- exposure as text

/// The whole of `text` as a finite number.
std::optional<float> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  float value = 0.0f;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// "1/125" or "0.008"
std::optional<float> parse_seconds(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_number(text);
  const auto above = parse_number(text.substr(0, slash));
  const auto below = parse_number(text.substr(slash + 1));
  if (!above || !below) return std::nullopt;
  return *above / *below;
}

/// 1 / (1.2 · 2^EV100) with 2^EV100 = N² / t · 100 / S. Lagarde & de Rousiers 2014, "Moving Frostbite to PBR", §5.1.2.
std::optional<float> exposure_of_camera(std::string_view text) {
  const std::size_t first = text.find(',');
  const std::size_t second = text.find(',', first + 1);
  if (!text.starts_with("f/") || first == std::string_view::npos || second == std::string_view::npos)
    return std::nullopt;
  const auto aperture = parse_number(text.substr(2, first - 2));
  const auto seconds = parse_seconds(text.substr(first + 1, second - first - 1));
  const auto iso = parse_number(text.substr(second + 1));
  if (!aperture || !seconds || !iso || !(*aperture > 0.0f) || !(*seconds > 0.0f) || !(*iso > 0.0f)) return std::nullopt;
  return 1.0f / (1.2f * (*aperture * *aperture / *seconds * (100.0f / *iso)));
}

// ----- metering

// Six stops below the bright tenth of a picture things are as good as black, and soon count as little: a backdrop that
// lamps in real units do not light, and how little light arrives in shadows, which approximations differ in most.
constexpr double kLeastSeen = 1.0 / 64.0;
// What the bright tenth is exposed to at most, middle grey being 0.18: tone curves are white a little above it.
constexpr double kMostBright = 1.7;

struct MeterPixel {
  float luminance;
  float weight;
};

/// Straight luminance and coverage of every pixel that shows light.
std::vector<MeterPixel> lit_pixels(const Image& beauty) {
  std::vector<MeterPixel> lit;
  lit.reserve(beauty.pixels.size() / static_cast<std::size_t>(std::max(beauty.channels, 1)));
  for (int y = 0; y < beauty.height; ++y) {
    for (int x = 0; x < beauty.width; ++x) {
      const float alpha = beauty.channels == 4 ? std::min(beauty.at(x, y)[3], 1.0f) : 1.0f;
      const float l = luminance(beauty.rgb(x, y)) / alpha;
      if (alpha > 0.0f && l > 0.0f && std::isfinite(l)) lit.push_back({l, alpha});
    }
  }
  return lit;
}

}  // namespace

ToneCurve parse_tone_curve(std::string_view name) { return row_named(kToneCurves, name, "unknown tone curve").curve; }

std::string_view tone_curve_name(ToneCurve curve) { return kToneCurves[place_of(curve)].name; }

std::optional<float> parse_exposure(std::string_view text) {
  if (text == "auto") return std::nullopt;
  const auto stops = parse_number(text);
  const std::optional<float> exposure = stops ? std::exp2(*stops) : exposure_of_camera(text);
  if (!exposure || !(*exposure > 0.0f) || !std::isfinite(*exposure))
    throw Error("exposure \"" + std::string(text) +
                "\" is neither \"auto\", nor stops such as -1.5, nor a camera such as f/8,1/125,100");
  return exposure;
}

float metered_exposure(const Film& film) {
  const std::vector<MeterPixel> lit = lit_pixels(film.beauty);
  if (lit.empty()) return 1.0f;

  // ----- limits of the darkest and brightest 1 %, and of the bright tenth
  std::vector<float> sorted(lit.size());
  std::transform(lit.begin(), lit.end(), sorted.begin(), [](MeterPixel p) { return p.luminance; });
  const std::size_t trimmed = lit.size() / 100;
  const auto low = sorted.begin() + static_cast<std::ptrdiff_t>(trimmed);
  const auto high = sorted.end() - 1 - static_cast<std::ptrdiff_t>(trimmed);
  std::nth_element(sorted.begin(), low, sorted.end());
  const float darkest = *low;
  std::nth_element(low, high, sorted.end());
  const float brightest = *high;
  const auto tenth = sorted.begin() + static_cast<std::ptrdiff_t>((lit.size() - 1) * 9 / 10);
  std::nth_element(low, tenth, high);
  const auto bright = static_cast<double>(*tenth);

  // ----- log average; pixels equal to a limit stay, so that a flat picture keeps its pixels
  double sum = 0.0, weight = 0.0;
  for (const MeterPixel& p : lit) {
    if (p.luminance < darkest || p.luminance > brightest) continue;
    const double share = std::min(static_cast<double>(p.luminance) / (kLeastSeen * bright), 1.0);
    const double w = static_cast<double>(p.weight) * share * share;
    sum += w * static_cast<double>(std::log2(p.luminance));
    weight += w;
  }
  const double exposure = std::min(0.18 * std::exp2(-sum / weight), kMostBright / bright);
  return static_cast<float>(std::clamp(exposure, 1e-30, 1e30));
}

namespace {

const SrgbEncoder& srgb_encoder() {
  static const SrgbEncoder encoder;
  return encoder;
}

}  // namespace

Shown::Shown(ToneCurve curve, float exposure) : curve_(kToneCurves[place_of(curve)].function), exposure_(exposure) {}

vec3 Shown::operator()(vec3 light) const {
  const vec3 linear = curve_(vec3(positive(light.x), positive(light.y), positive(light.z)) * exposure_);
  const SrgbEncoder& encode = srgb_encoder();
  return vec3(encode(linear.x), encode(linear.y), encode(linear.z)) / 255.0f;
}

float Shown::error(vec3 light, float relative) const {
  if (!(relative < kInfinity)) return kInfinity;
  if (relative <= 0.0f) return 0.0f;
  const vec3 apart = (*this)(light * (1.0f + relative)) - (*this)(light * std::max(1.0f - relative, 0.0f));
  return 0.5f * max_component(glm::abs(apart));
}

DisplayImage develop(const Film& film, const DevelopSettings& settings) {
  const Image scattered = settings.bloom > 0.0f ? bloomed(film.beauty, settings.bloom) : Image();
  const Image scattered_through =
      settings.bloom > 0.0f && !film.through.empty() ? bloomed(film.through, settings.bloom) : Image();
  const Image& beauty = settings.bloom > 0.0f ? scattered : film.beauty;
  const Picture picture{beauty, settings.bloom > 0.0f ? scattered_through : film.through};
  DisplayImage image;
  image.width = beauty.width;
  image.height = beauty.height;
  image.rgba.resize(static_cast<std::size_t>(beauty.width) * static_cast<std::size_t>(beauty.height) * 4);

  const float exposure = settings.exposure ? *settings.exposure : metered_exposure(film);
  const RowFunction row = row_function(settings.tone_curve);
  const SrgbEncoder& encode = srgb_encoder();
  const std::size_t row_bytes = static_cast<std::size_t>(beauty.width) * 4;
  parallel_for(0, static_cast<std::size_t>(beauty.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      row(picture, static_cast<int>(y), exposure, settings, encode, image.rgba.data() + y * row_bytes);
  });
  return image;
}

void check_output_extension(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  for (const char* known : {".png", ".jpg", ".jpeg", ".webp", ".hdr", ".exr"})
    if (extension == known) return;
  throw Error("unknown picture extension \"" + extension + "\" (known: .png, .jpg, .jpeg, .webp, .hdr, .exr)",
              path.string());
}

namespace {

constexpr std::uint64_t kWebpBytes =
    48;  // libwebp's own copy, its chains of what repeats, and the file: 37 measured with noise

}  // namespace

std::uint64_t writing_bytes(const std::filesystem::path& path, int width, int height, const std::set<Layer>& layers) {
  const std::string extension = lower_extension(path);
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  // All of it, where noise does not compress, and what coloured glass lets through.
  if (extension == ".exr") return pixels * (film_bytes_per_pixel(layers) + 3 * sizeof(float));
  if (extension == ".hdr") return pixels * 12;  // four bytes, and as many once more and double while the text grows
  if (extension == ".webp") return pixels * kWebpBytes;
  return pixels * 16;  // the display image's four, and the meter's twelve or the file's
}

void write_film(const std::filesystem::path& path, const Film& film, const DevelopSettings& settings) {
  check_output_extension(path);
  const std::string extension = lower_extension(path);
  if (extension == ".exr") return write_exr(path, film);
  if (extension == ".hdr") return write_hdr(path, film.beauty);
  const DisplayImage image = develop(film, settings);
  if (extension == ".webp") return write_webp(path, image);
  return extension == ".png" ? write_png(path, image) : write_jpeg(path, image);
}

}  // namespace candela
