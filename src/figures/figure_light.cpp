#include <fmt/format.h>

#include <array>
#include <cmath>

#include "content/demo_scenes.h"
#include "figures/figure.h"
#include "figures/plot.h"
#include "math/spectrum.h"
#include "shade/color.glsl.h"
#include "shade/lights.glsl.h"

// How far a lamp reaches, and what colour it has.

namespace candela::figures {
namespace {

constexpr float kRange = 10.0f;  // metres
/// The attenuation that texts print for a lamp that reaches about 50 m.
const vec3 kPolynomial(0.032f, 0.09f, 1.0f);

struct NamedFalloff {
  const char* name;  ///< as on the command line
  const char* label;
  Falloff kind;
  Stroke stroke;
};
const std::array<NamedFalloff, 4> kFalloffs{{{"inverse-square", "1/d²", Falloff::inverse_square, Stroke::solid},
                                             {"gltf", "glTF window", Falloff::gltf, Stroke::dashed},
                                             {"ue4", "UE4 window", Falloff::ue4, Stroke::dashed},
                                             {"polynomial", "polynomial", Falloff::polynomial, Stroke::dotted}}};

float falloff(const NamedFalloff& f, double distance) {
  return shade::light_falloff(static_cast<int>(f.kind), static_cast<float>(distance), kRange, kPolynomial);
}

constexpr float kLampHeight = 1.0f, kLampAt = 0.6f, kFloorLength = 12.0f, kFloorWidth = 2.0f;  // metres

/// A white floor with a lamp above its left end.
Scene lamp_over_floor(const NamedFalloff& f) {
  content::SceneBuilder builder("lamp");
  Material white;
  white.metallic = 0.0f;
  white.specular = 0.0f;
  white.base_color = vec3(0.8f);
  const Primitive floor =
      content::quad(vec3(0.0f, 0.0f, 0.5f * kFloorWidth), vec3(kFloorLength, 0, 0), vec3(0, 0, -kFloorWidth));
  builder.node("floor", builder.mesh("floor", floor, builder.material(white)));
  const int lamp = builder.node("lamp", -1, content::translation(vec3(kLampAt, kLampHeight, 0.0f)));
  builder.scene().lights.push_back(
      {.name = "lamp", .intensity = 60.0f, .range = kRange, .falloff = f.kind, .polynomial = kPolynomial});
  builder.scene().nodes[static_cast<std::size_t>(lamp)].light = 0;
  return builder.finish("none", 1.0f);
}

View floor_from_above() {
  View view;
  view.world_from_camera = content::translation(vec3(0.5f * kFloorLength, 5.0f, 0.0f)) * content::rotation_x(-90.0f);
  view.projection = OrthographicCamera{.xmag = 0.5f * kFloorLength, .ymag = 0.5f * kFloorWidth};
  return view;
}

void add_falloff_curves(Figure& figure) {
  Plot curves{
      .title = "Fall-off over distance",
      .x = {.label = "distance d, metres", .low = 0.1, .high = 20, .scale = Scale::logarithmic},
      .y = {.label = "what is left of the intensity, 1/m²", .low = 1e-3, .high = 100, .scale = Scale::logarithmic}};
  Plot windows{.title = "Windows over distance",
               .x = {.label = "distance d, metres", .low = 0, .high = 12, .step = 2},
               .y = {.label = "over the inverse square", .low = 0, .high = 1.5}};
  figure.table.head = {"", "0.5 m", "1 m", "2 m", "5 m", "8 m", "10 m"};
  int ink = 0;
  for (const NamedFalloff& f : kFalloffs) {
    const Ink color = categorical_ink(ink++);
    std::vector<dvec2> points;
    for (const dvec2 p : sampled(std::log(0.1), std::log(20.0), 401, [](double) { return 0.0; })) {
      const double d = std::exp(p.x);
      points.emplace_back(d, static_cast<double>(falloff(f, d)));
    }
    curves.curves.push_back({.label = f.label, .points = std::move(points), .ink = color, .stroke = f.stroke});
    windows.curves.push_back({.label = f.label,
                              .points = sampled(0.01, 12, 401,
                                                [&](double d) {
                                                  return static_cast<double>(falloff(f, d)) /
                                                         static_cast<double>(falloff(kFalloffs[0], d));
                                                }),
                              .ink = color,
                              .stroke = f.stroke});
    std::vector<std::string> row{f.name};
    for (const double d : {0.5, 1.0, 2.0, 5.0, 8.0, 10.0}) row.push_back(fmt::format("{:.4f}", falloff(f, d)));
    figure.table.rows.push_back(std::move(row));
  }
  figure.panels = {{"falloff-curves.svg", plot_svg(curves), "Straight lines of slope −2 are inverse squares"},
                   {"falloff-windows.svg", plot_svg(windows), "Divided by the inverse square: the window alone"}};
}

void add_falloff_pictures(FigureContext& context, Figure& figure) {
  path::Settings settings;
  settings.width = context.pixels(600);
  settings.height = settings.width / 6;
  settings.samples = std::max(1, context.settings().samples / 8);
  settings.bounces = 1;
  Image truth;
  for (const NamedFalloff& f : kFalloffs) {
    const Film film = context.trace(lamp_over_floor(f), context.environment("none"), floor_from_above(), settings);
    const bool is_truth = truth.empty();
    if (is_truth) truth = film.beauty;
    figure.panels.push_back({fmt::format("falloff-{}.png", f.name),
                             develop(film, {.exposure = 1.0f, .tone_curve = ToneCurve::reinhard}),
                             f.label,
                             is_truth ? "a small lamp" : "error " + percent_text(relative_error(film.beauty, truth)),
                             {"1 m", "3 m", "5 m", "7 m", "9 m", "11 m"}});
  }
}

Figure falloff_figure(FigureContext& context) {
  Figure figure;
  figure.text = {
      "A small lamp’s light spreads over spheres, so it thins with the square of the distance, and never ends. "
      "Engines let it end at a range, so that a lamp need not be asked about everywhere: a window that is 1 nearby "
      "and 0 at the range. glTF’s leaves the inverse square untouched below half the range; UE4’s adds 1 to d² so "
      "that nothing is divided by 0, which in metres halves the light at one metre. The polynomial is an artist’s, "
      "not a lamp’s.",
      "The range here is 10 m. Below, a lamp of 60 cd one metre above the left end of a floor of 12 m."};
  figure.formulas = {"E(d) = \\frac{I}{d^2} \\, \\op{cos} \\, θ",
                     "w_{\\op{glTF}} = \\op{max}(\\op{min}(1 − (\\frac{d}{R})^4, 1), 0) \\frac{1}{d^2}",
                     "w_{\\op{UE4}} = \\frac{\\op{saturate}(1 − (\\frac{d}{R})^4)^2}{d^2 + 1} ; w_{\\op{polynomial}} "
                     "= \\frac{1}{a_0 d^2 + a_1 d + a_2}"};
  figure.sources = {"Khronos Group, KHR_lights_punctual", "Karis 2013, Real Shading in Unreal Engine 4, eq. 9",
                    "Segal & Akeley, The OpenGL Graphics System (attenuation)"};
  figure.functions = {"shade::light_falloff"};
  figure.commands = {"candela render lamp.glb -o lamp.png --light-falloff ue4"};
  figure.columns = 2;

  add_falloff_curves(figure);
  add_falloff_pictures(context, figure);
  return figure;
}

Figure color_temperature(FigureContext& context) {
  Figure figure;
  figure.text = {
      "What glows has the spectrum of its temperature, and the eye reduces any spectrum to three numbers: how much "
      "it excites three broad bands. Candles are near 1900 K, bulbs near 2700 K, noon near 5500 K, a blue sky beyond "
      "10 000 K. In the strip each is as bright as a display can be; below 1900 K the colour lies outside of what it "
      "can show, and the missing blue is held at 0."};
  figure.formulas = {"L_λ(T) = \\frac{2 h c^2}{λ^5} \\frac{1}{\\op{exp}(\\frac{h c}{λ k T}) − 1}",
                     "X = ∫ L_λ \\op{x̄}(λ) \\text{ d}λ ; Y = ∫ L_λ \\op{ȳ}(λ) \\text{ d}λ ; Z = ∫ L_λ \\op{z̄}(λ) "
                     "\\text{ d}λ"};
  figure.sources = {"Planck 1901, Ueber das Gesetz der Energieverteilung im Normalspectrum",
                    "CIE 15:2004, Colorimetry, table T.4", "ITU-R BT.709-6"};
  figure.functions = {"planck", "cie_xyz", "blackbody_color"};
  figure.columns = 2;
  const Axis wavelength{.label = "wavelength, nm", .low = 380, .high = 730, .step = 50};
  Plot observer{.title = "CIE 1931 observer", .x = wavelength, .y = {.label = "x̄, ȳ, z̄", .low = 0, .high = 2}};
  const std::array<const char*, 3> names{"x̄, reddish", "ȳ, luminance", "z̄, bluish"};
  const std::array<int, 3> inks{1, 2, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    observer.curves.push_back(
        {.label = names[i],
         .points = sampled(380, 730, 351, [i](double nm) { return cie_xyz(nm)[static_cast<int>(i)]; }),
         .ink = categorical_ink(inks[i])});
  }
  Plot bodies{
      .title = "Black bodies", .x = wavelength, .y = {.label = "spectral radiance, 560 nm = 1", .low = 0, .high = 3}};
  const std::array<double, 5> kelvin{2000, 2700, 4000, 6500, 10000};
  for (std::size_t i = 0; i < kelvin.size(); ++i) {
    bodies.curves.push_back(
        {.label = fmt::format("{:.0f} K", kelvin[i]),
         .points = sampled(380, 730, 176, [&](double nm) { return planck(nm, kelvin[i]) / planck(560.0, kelvin[i]); }),
         .ink = sequential_ink(static_cast<int>(kelvin.size() - 1 - i), static_cast<int>(kelvin.size()))});
  }
  constexpr double kLeast = 1000.0, kMost = 12000.0;
  Film strip;
  strip.beauty = Image(context.pixels(900), context.pixels(90), 3);
  for (int x = 0; x < strip.beauty.width; ++x) {
    const double t = (x + 0.5) / strip.beauty.width;
    const vec3 color = blackbody_color(kLeast + t * (kMost - kLeast));
    for (int y = 0; y < strip.beauty.height; ++y) strip.beauty.set_rgb(x, y, color / max_component(color));
  }
  figure.panels = {{"color-temperature-observer.svg", plot_svg(observer), "What the three bands see"},
                   {"color-temperature-bodies.svg", plot_svg(bodies), "Spectra of black bodies"},
                   {"color-temperature.png",
                    develop(strip, {.exposure = 1.0f, .tone_curve = ToneCurve::linear}),
                    "Black bodies from 1000 to 12 000 K",
                    {},
                    {"2100 K", "4300 K", "6500 K", "8700 K", "10 900 K"},
                    true}};
  return figure;
}

}  // namespace

void add_light_figures(std::vector<FigureInfo>& list) {
  list.push_back({"falloff", "Inverse square and its windows", Chapter::light, falloff_figure});
  list.push_back({"color-temperature", "The colour of what glows", Chapter::light, color_temperature});
}

}  // namespace candela::figures
