#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "candela/difference.h"
#include "candela/shot.h"

/// How far the real-time frame is from the truth, and why: each thing that it approximates beside its exact
/// counterpart, which the path tracer has.
namespace candela {

enum class GapCause {
  sampling,
  far_light,
  occlusion,
  lamps,
  areas,
  shadows,
  between,
  probes,
  glass,
  scattering,
  rest,
};

struct GapCauseInfo {
  GapCause cause;
  std::string_view name;   ///< in JSON
  std::string_view title;  ///< for people
  std::string_view drawn;  ///< what the frame does
  std::string_view exact;  ///< what it is replaced by
};
inline constexpr auto kGapCauses = std::to_array<GapCauseInfo>({
    {GapCause::sampling, "sampling", "Edges and textures", "one frame: its samples per pixel, mips, widened highlights",
     "the mean of many frames"},
    {GapCause::far_light, "far-light", "Light from far away", "prefiltered levels, irradiance, albedos",
     "the integral over the environment, nothing in its way"},
    {GapCause::occlusion, "occlusion", "What hides the environment", "occlusion texture, --ao, horizon of normal maps",
     "traced visibility of the environment"},
    {GapCause::lamps, "lamps", "Point, spot and directional lights, suns", "the lamp's light on the surface",
     "the same by the path tracer, nothing in its way"},
    {GapCause::areas, "area-lights", "Light from surfaces that glow", "linearly transformed cosines of flat parts",
     "the integral over the glowing surfaces, nothing in its way"},
    {GapCause::shadows, "shadows", "Shadows of lamps", "shadow maps", "traced visibility of the lamps"},
    {GapCause::between, "between-surfaces", "Light between surfaces", "none", "all bounces"},
    {GapCause::probes, "probes", "Light of probes", "prefiltered levels of the nearest probe",
     "light from far away, what hides it, and all bounces"},
    {GapCause::glass, "glass", "Glass and other transmission", "refraction of the picture behind, once",
     "paths through the body"},
    {GapCause::scattering, "scattering", "Scattering in bodies", "light blurred by a profile", "paths in the body"},
    {GapCause::rest, "rest", "What none of these is", "emission, background, coverage", "the same of the path tracer"},
});
constexpr const GapCauseInfo& gap_cause_info(GapCause cause) { return kGapCauses[static_cast<std::size_t>(cause)]; }

struct GapSettings {
  int samples = 128;  ///< of the truth, per pixel, at least 2; half of them are of another seed, to know the noise
  int frames = 16;    ///< whose mean is what the frame converges to
  bool looks_for_suspects = true;
};

/// What one approximation has in an error.
struct CauseGap {
  GapCause cause = GapCause::rest;
  /// Of the squared error: its covariance with the whole, so that all shares add up to 1. Below 0, it hides what others
  /// do: without it, the error would be larger.
  double share = 0.0;
  double flip_without = 0.0;  ///< FLIP of the frame with this alone made exact
  vec3 bias{0.0f};            ///< mean of what it adds to the frame, over the mean of the truth
  Image error;                ///< what it adds, 3 channels, linear
};

/// How far a part of a picture is from the truth.
struct GapNumbers {
  std::size_t pixels = 0;
  double flip = 0.0;  ///< mean
  /// √ of the mean of |frame − truth|² / (3 (L² + g²)), L being the luminance of the truth and g middle grey at the
  /// exposure. Without the noise of the truth, which two independent halves of it tell from the error.
  double relative_l2 = 0.0;
  vec3 bias{0.0f};  ///< mean of the frame over the mean of the truth, less 1, by channel
};

struct MaterialGap {
  std::string name;  ///< empty: the background
  GapNumbers numbers;
  std::optional<GapCause> largest;  ///< where there is an error beyond the noise
  double largest_share = 0.0;
};

/// A mistake that would make such a frame.
struct GapSuspect {
  std::string name;        ///< in JSON
  std::string what;        ///< a sentence
  std::string of;          ///< in which light it was looked for
  double explained = 0.0;  ///< share of the squared error of that light that would not be there without it
};

/// How a picture of another program was laid over the truth.
struct GapMatch {
  ivec2 shift{0};           ///< pixels, right and down, that it is away from the truth; its margins were cut off
  float exposure = 1.0f;    ///< linear: what it was multiplied by; shown: the exposure of the truth that is nearest
  bool is_display = false;  ///< numbers are of what a display shows, and the tone curve was assumed
};

/// A frame beside the truth.
struct ViewGap {
  std::size_t index = 0;
  PictureLabel label;
  Film truth, frame;  ///< linear
  DevelopSettings develop;
  PictureDifference difference;  ///< as seen; the truth is the first
  GapNumbers numbers;            ///< of all pixels
  double flip_noise = 0.0;       ///< what of the FLIP is the truth's noise, about: half of that between its halves
  std::vector<CauseGap> causes;  ///< those that there are, the largest share first; empty where the error is noise
  std::vector<MaterialGap> materials;  ///< those seen, the most pixels first
  std::vector<GapSuspect> suspects;    ///< the most convincing first
  std::optional<GapMatch> match;       ///< of another program's picture, of which no causes are known
};

/// Makes the pictures of a shot by both engines, in linear light, of the same views under the same environment, and
/// passes how far the rasterizer's are from the path tracer's. Of the shot the engine does not count; it has no other
/// background than the environment, no ground, no shutter, no parts. Warnings go to Job::diagnostics. Throws Error as
/// Take does, Interrupted after a stop.
void measure_gaps(const Shot& shot, const GapSettings& settings, const std::function<void(ViewGap)>& take,
                  const Job& job = {});

/// How far a picture of the same view by another program is from the truth, overall and by material. It is moved by
/// whole pixels and its exposure is matched, unless the shot has one for a picture that a display shows (where `shot`
/// has the tone curve that it was made with). The shot has one view, and the picture's size. What lit it, and what else
/// its program did, cannot be known. Throws Error as measure_gaps(), and for a picture of another size.
ViewGap measure_against(const Shot& shot, const GapSettings& settings, const ImageName& picture, const Job& job = {});

}  // namespace candela
