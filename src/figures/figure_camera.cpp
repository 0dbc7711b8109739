#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "content/demo.h"
#include "figures/figure.h"
#include "figures/plot.h"
#include "shade/color.glsl.h"
#include "shade/tonemap.glsl.h"

namespace candela::figures {
namespace {

Material paint(vec3 color, float metallic, float roughness) {
  Material material;
  material.base_color = color;
  material.metallic = metallic;
  material.roughness = roughness;
  return material;
}

/// Straight colour as a camera would clip it; alpha is kept.
Image clipped(const Image& beauty) {
  Image image = beauty;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float alpha = image.at(x, y)[3];
      image.set_rgb(x, y, alpha > 0.0f ? shade::tone_linear(image.rgb(x, y) / alpha) : vec3(0.0f));
    }
  }
  return image;
}

/// Values in [0, 1] as the codes of a display that was told nothing of them.
DisplayImage as_codes(const Image& values) {
  DisplayImage shown{values.width, values.height, {}};
  shown.rgba.reserve(values.pixels.size());
  for (const float v : values.pixels) {
    shown.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(v, 0.0f, 1.0f))));
  }
  return shown;
}

/// Each colour value by a function, times alpha: what light leaves the display.
Image displayed(const Image& straight, vec3 (*f)(vec3)) {
  Image image = straight;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.set_rgb(x, y, f(image.rgb(x, y)) * image.at(x, y)[3]);
  }
  return image;
}

Image encoded(const Image& straight) {
  Image image = straight;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.set_rgb(x, y, shade::srgb_encode(image.rgb(x, y)));
  }
  return image;
}

vec3 itself(vec3 v) { return v; }

Figure gamma(FigureContext& context) {
  Figure figure;
  figure.text = {
      "Light adds, codes do not: 8-bit codes are spaced as the eye sees, about by the root of the light. A renderer "
      "decodes colours on the way in, works with light, and encodes once on the way out.",
      "Without encoding the display shows the square of what was meant: dark, hard, too colourful. Leaving both "
      "conversions out brings the colours back, but lights are added as codes, so that shading falls off too fast, "
      "highlights burn out and where two lights meet their sum is wrong. The error is of the light that leaves the "
      "display."};
  figure.formulas = {"C = 12.92 c \\text{ for } c ≤ 0.0031308 \\text{, else } C = 1.055 c^{1/2.4} − 0.055"};
  figure.sources = {"IEC 61966-2-1:1999, sRGB",
                    "Gritz & d’Eon 2007, The Importance of Being Linear, GPU Gems 3, chapter 24"};
  figure.functions = {"shade::srgb_encode", "shade::srgb_decode"};
  figure.columns = 2;

  std::vector<Material> materials{paint(vec3(0.18f), 0.0f, 0.6f), paint(vec3(0.5f, 0.05f, 0.03f), 0.0f, 0.4f),
                                  paint(vec3(0.06f, 0.28f, 0.08f), 0.0f, 0.4f),
                                  paint(vec3(1.0f, 0.782f, 0.344f), 1.0f, 0.3f)};
  const int side = context.pixels(150);
  path::Settings settings;
  settings.width = settings.height = side;
  settings.samples = context.settings().samples;
  settings.background = Background::transparent;
  const Image right = clipped(trace_balls(context, materials, settings).beauty);
  for (Material& material : materials) material.base_color = shade::srgb_encode(material.base_color);
  const Image raw = clipped(trace_balls(context, materials, settings).beauty);

  const Image truth = displayed(right, itself);
  const auto error = [&](const Image& codes) {
    return "error " + percent_text(relative_error(displayed(codes, shade::srgb_decode), truth));
  };
  figure.panels = {{"gamma-on.png", as_codes(encoded(right)), "light, encoded once for the display", "the truth"},
                   {"gamma-off.png", as_codes(right), "light, sent to the display as if it were codes", error(right)},
                   {"gamma-neither.png", as_codes(raw), "codes taken for light, and sent as codes", error(raw)}};

  Plot plot{.title = "The sRGB curve", .x = {.label = "linear light"}, .y = {.label = "code"}, .height = 360};
  plot.curves.push_back({.label = "sRGB", .points = sampled(0, 1, 301, [](double c) {
                                            return static_cast<double>(
                                                shade::srgb_encode_channel(static_cast<float>(c)));
                                          })});
  plot.curves.push_back({.label = "power 1/2.2",
                         .points = sampled(0, 1, 301, [](double c) { return std::pow(c, 1 / 2.2); }),
                         .ink = categorical_ink(1),
                         .stroke = Stroke::dashed});
  plot.curves.push_back(
      {.label = "none", .points = {{0, 0}, {1, 1}}, .ink = categorical_ink(6), .stroke = Stroke::dotted});
  figure.panels.push_back({"gamma-curve.svg", plot_svg(plot), "The curve, and the power that stands in for it"});
  return figure;
}

struct Curve3 {
  ToneCurve curve;
  int number;
  const char* label;
};
const std::array<Curve3, 6> kCurves{{{ToneCurve::linear, shade::kToneLinear, "off: clipped"},
                                     {ToneCurve::exponential, shade::kToneExponential, "1 − exp(−c)"},
                                     {ToneCurve::reinhard, shade::kToneReinhard, "Reinhard"},
                                     {ToneCurve::aces, shade::kToneAces, "ACES"},
                                     {ToneCurve::agx, shade::kToneAgx, "AgX"},
                                     {ToneCurve::pbr_neutral, shade::kTonePbrNeutral, "PBR neutral"}}};

/// Share of pixels of which a channel is at the display's white.
double white_share(const DisplayImage& image) {
  std::size_t white = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    if (std::max({image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]}) == 255) ++white;
  }
  return 4.0 * static_cast<double>(white) / static_cast<double>(std::max<std::size_t>(image.rgba.size(), 1));
}

Figure tone_mapping(FigureContext& context) {
  Figure figure;
  figure.text = {
      "A lamp is thousands of times as bright as what it lights, a display at most a few hundred times as bright as "
      "its black. Off, all that is brighter than white is white, and coloured light burns out channel by channel. A "
      "tone curve bends the bright end so that there is room for it. The picture below is exposed two stops too long "
      "on purpose."};
  figure.formulas = {"T_{\\op{exponential}}(c) = 1 − \\op{exp}(−c · \\op{exposure})",
                     "T_{\\op{Reinhard}}(c) = \\frac{c}{1 + c}"};
  figure.sources = {"Reinhard, Stark, Shirley & Ferwerda 2002, Photographic Tone Reproduction for Digital Images",
                    "Khronos Group 2024, PBR Neutral Tone Mapping", "Sobotka 2022, AgX",
                    "Academy of Motion Picture Arts and Sciences, ACES; fit by Hill"};
  figure.functions = {"develop", "shade::tone_map"};
  figure.columns = 3;
  const Scene scene = content::make_demo("materials");
  path::Settings settings;
  settings.width = context.pixels(400);
  settings.height = context.pixels(225);
  settings.samples = context.settings().samples;
  const View view = scene_camera(scene, "0", 16.0f / 9.0f);
  const Film film = context.trace(scene, context.environment(*scene.preferred_environment), view, settings);
  const float exposure = 4.0f * *scene.preferred_exposure;
  Plot plot{.title = "Tone curves",
            .x = {.label = "exposed light, stops above middle grey (0.18)", .low = -8, .high = 8, .step = 2},
            .y = {.label = "code of the display", .low = 0, .high = 1},
            .height = 420};
  for (std::size_t i = 0; i < kCurves.size(); ++i) {
    const Curve3& c = kCurves[i];
    const DisplayImage shown = develop(film, {.exposure = exposure, .tone_curve = c.curve});
    figure.panels.push_back({fmt::format("tone-mapping-{}.png", tone_curve_name(c.curve)), shown, c.label,
                             fmt::format("{} of the pixels at white", percent_text(white_share(shown)))});
    figure.commands.push_back(fmt::format(
        "candela render demo:materials -o {0}.png --size {1}x{2} --spp {3} --exposure {4:.3g} --tonemap {0}",
        tone_curve_name(c.curve), settings.width, settings.height, settings.samples, std::log2(exposure)));
    plot.curves.push_back({.label = c.label,
                           .points = sampled(-8, 8, 321,
                                             [&](double stops) {
                                               const auto x = static_cast<float>(0.18 * std::exp2(stops));
                                               return static_cast<double>(
                                                   shade::srgb_encode(shade::tone_map(c.number, vec3(x))).x);
                                             }),
                           .ink = categorical_ink(static_cast<int>(i)),
                           .stroke = i == 0 ? Stroke::dashed : Stroke::solid});
  }
  figure.panels.push_back(
      {"tone-mapping-curves.svg", plot_svg(plot), "Grey light, after the sRGB encoding", {}, {}, true});
  return figure;
}

Figure exposure(FigureContext& context) {
  Figure figure;
  figure.text = {
      "The same light, let in for longer and longer: each picture has four times the exposure of the one before. "
      "Metered is what a camera would choose, which brings the logarithmic mean of the picture to middle grey. A "
      "camera’s three numbers, aperture, shutter and sensitivity, are one: EV 100."};
  figure.formulas = {"T(c) = 1 − \\op{exp}(−c · \\op{exposure})",
                     "\\op{EV}_{100} = \\op{log}_2 ( \\frac{N^2}{t} \\frac{100}{S} ) ; \\op{exposure} = "
                     "\\frac{1}{1.2 · 2^{\\op{EV}_{100}}}"};
  figure.sources = {
      "Lagarde & de Rousiers 2014, Moving Frostbite to Physically Based Rendering, §5.1",
      "Reinhard, Stark, Shirley & Ferwerda 2002, Photographic Tone Reproduction for Digital Images, eq. 1"};
  figure.functions = {"develop", "metered_exposure", "shade::tone_exponential"};
  figure.columns = 2;
  const Scene scene = content::make_demo("materials");
  path::Settings settings;
  settings.width = context.pixels(400);
  settings.height = context.pixels(225);
  settings.samples = context.settings().samples;
  const Film film = context.trace(scene, context.environment(*scene.preferred_environment),
                                  scene_camera(scene, "0", 16.0f / 9.0f), settings);
  const std::string command = fmt::format("candela render demo:materials --size {}x{} --spp {} --tonemap exponential",
                                          settings.width, settings.height, settings.samples);
  const auto add = [&](const std::string& file, const std::string& option, std::optional<float> factor,
                       const std::string& caption) {
    const std::string name = "exposure-" + file + ".png";
    const DisplayImage shown = develop(film, {.exposure = factor, .tone_curve = ToneCurve::exponential});
    figure.panels.push_back(
        {name, shown, caption, fmt::format("{} of the pixels at white", percent_text(white_share(shown)))});
    figure.commands.push_back(fmt::format("{} --exposure {} -o {}", command, option, name));
  };
  for (const int stops : {-2, 0, 2}) {
    add(stops < 0   ? "less"
        : stops > 0 ? "more"
                    : "even",
        fmt::format("{}", stops), std::exp2(static_cast<float>(stops)),
        fmt::format("{}{} stops",
                    stops < 0   ? "−"
                    : stops > 0 ? "+"
                                : "",
                    std::abs(stops)));
  }
  const float metered = metered_exposure(film);
  add("metered", "auto", std::nullopt, fmt::format("metered: {:+.1f} stops", std::log2(metered)));
  return figure;
}

}  // namespace

void add_camera_figures(std::vector<FigureInfo>& list) {
  list.push_back({"gamma", "Gamma correction on and off", Chapter::camera, gamma});
  list.push_back({"tone-mapping", "Tone mapping on and off", Chapter::camera, tone_mapping});
  list.push_back({"exposure", "Exposure", Chapter::camera, exposure});
}

}  // namespace candela::figures
