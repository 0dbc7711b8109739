#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "image/film.h"
#include "shade/tonemap.glsl.h"

namespace candela {

/// By the number that shade::tone_map knows.
enum class ToneCurve {
  pbr_neutral = shade::kTonePbrNeutral,
  agx = shade::kToneAgx,
  aces = shade::kToneAces,
  reinhard = shade::kToneReinhard,
  exponential = shade::kToneExponential,
  linear = shade::kToneLinear,
  hable = shade::kToneHable,
};

/// A new curve is its text in shade/tonemap.glsl.h, a value of the enum and a row here.
struct ToneCurveInfo {
  ToneCurve curve;
  std::string_view name;  ///< on the command line
  vec3 (*function)(vec3 color);
};
inline constexpr auto kToneCurves = std::to_array<ToneCurveInfo>({
    {ToneCurve::pbr_neutral, "pbr-neutral", shade::tone_pbr_neutral},
    {ToneCurve::agx, "agx", shade::tone_agx},
    {ToneCurve::aces, "aces", shade::tone_aces},
    {ToneCurve::reinhard, "reinhard", shade::tone_reinhard},
    {ToneCurve::hable, "hable", shade::tone_hable},
    {ToneCurve::exponential, "exponential", shade::tone_exponential},
    {ToneCurve::linear, "linear", shade::tone_linear},
});

/// Throws Error that lists what there is.
ToneCurve parse_tone_curve(std::string_view name);
std::string_view tone_curve_name(ToneCurve curve);

/// From linear radiance to a picture on a display: exposure, tone curve, sRGB encoding. Happens once, after the film.
struct DevelopSettings {
  /// Factor that radiance is multiplied by; empty = metered from the picture by metered_exposure().
  std::optional<float> exposure = {};
  ToneCurve tone_curve = ToneCurve::pbr_neutral;
  /// Linear colour, 1 = display white, that shows where the film is transparent, and through glass as that colours it.
  /// It is no light: neither exposure nor tone curve touch it, so the colour that was asked for is the one in the file.
  /// Empty = the picture keeps its alpha.
  std::optional<vec3> background = {};
  float background_opacity = 1.0f;  ///< below 1 the picture keeps the alpha that is left
  float bloom = 0.0f;               ///< share of the light that the lens scatters, see bloomed()
  bool dither = true;               ///< ±½ code value of deterministic noise before rounding to 8 bits
};

/// "auto" → empty; a number → 2^EV (stops); "f/8,1/125,100" → 1 / (1.2 · 2^EV100), radiance taken as cd/m².
/// Throws Error for anything else.
std::optional<float> parse_exposure(std::string_view text);

/// 0.18 over the log-average luminance (Reinhard 2002 "Photographic tone reproduction", eq. 1 and 2), weighted by
/// alpha, the brightest and darkest 1 % of pixels left out; 1 for an all-black picture. Of what is lit, the tenth that
/// is brightest says what else is seen: pixels that are darker than it by more than six stops count by the square of
/// how much, black ones not at all; and it is never exposed to more than 1.7, so that at most a tenth is white.
float metered_exposure(const Film& film);

/// What a display shows of light, from 0 (black) to 1 (white), by channel: exposure, tone curve, sRGB encoding.
class Shown {
 public:
  Shown(ToneCurve curve, float exposure);
  vec3 operator()(vec3 light) const;
  /// The standard error of what is shown of `light`, that of the light being `relative` times as large as the light
  /// itself: half the difference between light one standard error above and below, of the channel that differs most.
  /// This is the curve's slope times the error where the curve is straight over it. Infinite where `relative` is.
  float error(vec3 light, float relative) const;

 private:
  vec3 (*curve_)(vec3 color);
  float exposure_;
};

/// Encoded sRGB, 8 bits, RGBA (alpha straight, not premultiplied), row 0 at the top. Straight colour ends at white:
/// where clear glass reflects more than its alpha can show, alpha rises.
struct DisplayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};
DisplayImage develop(const Film& film, const DevelopSettings& settings);

/// PNG keeps alpha when the film is not opaque; its header says sRGB. JPEG is quality 92, 4:4:4, alpha over black.
void write_png(const std::filesystem::path& path, const DisplayImage& image);
void write_jpeg(const std::filesystem::path& path, const DisplayImage& image);
/// WebP without loss, with alpha where the picture is not opaque. Throws Error for a side above 16383.
void write_webp(const std::filesystem::path& path, const DisplayImage& image);

/// Writes `film` in the format that the extension names (.png .jpg .jpeg .webp .hdr .exr); .hdr and .exr stay linear.
void write_film(const std::filesystem::path& path, const Film& film, const DevelopSettings& settings);
/// Most bytes that write_film takes beside a film of this size with these layers.
std::uint64_t writing_bytes(const std::filesystem::path& path, int width, int height, const std::set<Layer>& layers);
/// Throws Error unless `path` ends in an extension that write_film knows; to be called before hours of rendering.
void check_output_extension(const std::filesystem::path& path);

}  // namespace candela
