#include <fmt/format.h>

#include <array>
#include <cmath>

#include "figures/figure.h"
#include "figures/plot.h"
#include "scene/metals.h"
#include "shade/fresnel.glsl.h"

namespace candela::figures {
namespace {

constexpr int kPoints = 361;

float cosine(double degrees) { return static_cast<float>(std::cos(degrees * 3.14159265358979 / 180.0)); }

Axis angle_axis() { return {.label = "angle of incidence, degrees", .low = 0.0, .high = 90.0, .step = 15.0}; }

std::vector<dvec2> over_angle(const std::function<float(float)>& f) {
  return sampled(0.0, 90.0, kPoints, [&](double degrees) { return static_cast<double>(f(cosine(degrees))); });
}

struct Dielectric {
  const char* name;
  float index;
};
constexpr std::array<Dielectric, 3> kDielectrics{{{"diamond", 2.417f}, {"glass", 1.5f}, {"water", 1.333f}}};

float schlick(float f0, float c) { return shade::fresnel_schlick(vec3(f0), vec3(1.0f), c).x; }
float spherical_gaussian(float f0, float c) { return shade::fresnel_spherical_gaussian(vec3(f0), c).x; }

/// Curves, errors and the largest of them.
void add_approximations(Figure& figure) {
  Plot curves{.title = "Fresnel reflectance of dielectrics", .x = angle_axis(), .y = {.label = "reflectance"}};
  Plot errors{.title = "Error of the approximations",
              .x = angle_axis(),
              .y = {.label = "approximation − exact", .low = -0.04, .high = 0.08, .step = 0.02}};
  figure.table.head = {"", "index", "F₀", "largest error, Schlick", "spherical Gaussian"};
  for (std::size_t i = 0; i < kDielectrics.size(); ++i) {
    const Dielectric d = kDielectrics[i];
    const Ink ink = categorical_ink(static_cast<int>(i));
    const float f0 = shade::f0_from_eta(d.index);
    const auto exact = [&](float c) { return shade::fresnel_dielectric(c, d.index); };
    curves.curves.push_back({.label = d.name, .points = over_angle(exact), .ink = ink});
    curves.curves.push_back({.label = "",
                             .points = over_angle([&](float c) { return schlick(f0, c); }),
                             .ink = ink,
                             .stroke = Stroke::dashed});
    curves.curves.push_back({.label = "",
                             .points = over_angle([&](float c) { return spherical_gaussian(f0, c); }),
                             .ink = ink,
                             .stroke = Stroke::dotted});
    std::vector<std::string> row{d.name, fmt::format("{:.4g}", d.index), fmt::format("{:.4f}", f0)};
    for (const bool is_gauss : {false, true}) {
      const auto error =
          over_angle([&](float c) { return (is_gauss ? spherical_gaussian(f0, c) : schlick(f0, c)) - exact(c); });
      double worst = 0.0;
      for (const dvec2 p : error) worst = std::max(worst, std::abs(p.y));
      row.push_back(fmt::format("{:.4f}", worst));
      errors.curves.push_back({.label = is_gauss ? "" : d.name,
                               .points = error,
                               .ink = ink,
                               .stroke = is_gauss ? Stroke::dotted : Stroke::dashed});
    }
    figure.table.rows.push_back(std::move(row));
  }

  figure.panels.push_back({"fresnel-dielectrics-curves.svg", plot_svg(curves),
                           "Exact (solid), Schlick (dashed), spherical Gaussian (dotted)"});
  figure.panels.push_back({"fresnel-dielectrics-errors.svg", plot_svg(errors),
                           "Error of Schlick (dashed) and of the spherical Gaussian (dotted)"});
}

/// Both sides of glass, for both polarisations.
void add_polarised(Figure& figure) {
  const float glass = 1.5f;
  Plot outside{.title = "Polarised light on glass", .x = angle_axis(), .y = {.label = "reflectance"}};
  Plot inside{.title = "Light inside glass", .x = angle_axis(), .y = {.label = "reflectance"}};
  for (const bool is_inside : {false, true}) {
    const float eta = is_inside ? 1.0f / glass : glass;
    Plot& plot = is_inside ? inside : outside;
    plot.curves.push_back({.label = "s: across the plane",
                           .points = over_angle([&](float c) { return shade::fresnel_dielectric_s(c, eta); }),
                           .ink = categorical_ink(0),
                           .stroke = Stroke::dashed});
    plot.curves.push_back({.label = "unpolarised",
                           .points = over_angle([&](float c) { return shade::fresnel_dielectric(c, eta); }),
                           .ink = categorical_ink(6)});
    plot.curves.push_back({.label = "p: in the plane",
                           .points = over_angle([&](float c) { return shade::fresnel_dielectric_p(c, eta); }),
                           .ink = categorical_ink(1),
                           .stroke = Stroke::dashed});
  }
  const double brewster = std::atan(static_cast<double>(glass)) * 180.0 / 3.14159265358979;
  const double critical = std::asin(1.0 / static_cast<double>(glass)) * 180.0 / 3.14159265358979;
  figure.panels.push_back({"fresnel-dielectrics-outside.svg", plot_svg(outside),
                           fmt::format("From air onto glass: Brewster’s angle is {:.1f}°", brewster)});
  figure.panels.push_back({"fresnel-dielectrics-inside.svg", plot_svg(inside),
                           fmt::format("From glass into air: total reflection beyond {:.1f}°", critical)});
}

Figure dielectrics(FigureContext&) {
  Figure figure;
  figure.text = {
      "Water reflects 2 %, glass 4 % and diamond 17 % of what falls onto them from the front, and all of them "
      "everything at the horizon. Schlick’s fifth power is within a few hundredths of the exact curve between; the "
      "spherical Gaussian is the same curve as a power of two, for hardware on which powers of five are dear.",
      "Polarised light knows an angle at which a dielectric reflects nothing of it, Brewster’s; light that comes "
      "from the denser side is reflected wholly beyond the critical angle."};
  figure.formulas = {"F_0 = ( \\frac{n_1 − n_2}{n_1 + n_2} )^2", "F_{\\op{Schlick}} = F_0 + (1 − F_0) (1 − v·h)^5",
                     "F_{\\op{Gauss}} = F_0 + (1 − F_0) 2^{(−5.55473 v·h − 6.98316) v·h}",
                     "n_1 \\, \\op{sin} \\, θ_1 = n_2 \\, \\op{sin} \\, θ_2 ; \\op{tan} \\, θ_{\\op{Brewster}} = "
                     "\\frac{n_2}{n_1} ; \\op{sin} \\, θ_{\\op{critical}} = \\frac{n_2}{n_1}"};
  figure.sources = {"Born & Wolf 1999, Principles of Optics, §1.5.2",
                    "Schlick 1994, An Inexpensive BRDF Model for Physically-based Rendering, eq. 15",
                    "Karis 2013, Real Shading in Unreal Engine 4, eq. 5"};
  figure.functions = {"shade::fresnel_dielectric", "shade::fresnel_schlick", "shade::fresnel_spherical_gaussian",
                      "shade::fresnel_dielectric_s", "shade::fresnel_dielectric_p"};
  figure.columns = 2;

  add_approximations(figure);
  add_polarised(figure);
  return figure;
}

const Metal& metal_of(std::string_view name) { return *find_metal(name); }

void add_channels(Figure& figure) {
  const std::array<const char*, 3> channels{"red", "green", "blue"};
  const std::array<Ink, 3> inks{categorical_ink(1), categorical_ink(2), categorical_ink(0)};
  for (const char* name : {"gold", "copper"}) {
    const Metal& m = metal_of(name);
    Plot plot{.title = fmt::format("Reflectance of {}", name), .x = angle_axis(), .y = {.label = "reflectance"}};
    const vec3 f0 = shade::fresnel_conductor3(1.0f, m.n, m.k);
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      plot.curves.push_back({.label = channels[k],
                             .points = over_angle([&](float c) { return shade::fresnel_conductor3(c, m.n, m.k)[i]; }),
                             .ink = inks[k]});
      plot.curves.push_back({.label = "",
                             .points = over_angle([&](float c) { return schlick(f0[i], c); }),
                             .ink = inks[k],
                             .stroke = Stroke::dashed});
    }
    figure.panels.push_back({fmt::format("fresnel-metals-{}.svg", name), plot_svg(plot),
                             fmt::format("{}: exact (solid) and Schlick (dashed)", name)});
  }
}

void add_luminous(Figure& figure) {
  Plot grey{
      .title = "Luminous reflectance of metals", .x = angle_axis(), .y = {.label = "luminous reflectance", .low = 0.4}};
  int ink = 0;
  for (const char* name : {"silver", "aluminium", "gold", "copper", "iron", "titanium"}) {
    const Metal& m = metal_of(name);
    grey.curves.push_back(
        {.label = name,
         .points = over_angle([&](float c) { return luminance(shade::fresnel_conductor3(c, m.n, m.k)); }),
         .ink = categorical_ink(ink++)});
  }
  figure.panels.push_back({"fresnel-metals-luminous.svg", plot_svg(grey), "Six metals"});
}

/// The dip of aluminium, which Schlick does not have.
void add_f82(Figure& figure) {
  Plot dip{.title = "Aluminium, Schlick and F82",
           .x = {.label = "angle of incidence, degrees", .low = 45.0, .high = 90.0, .step = 15.0},
           .y = {.label = "luminous reflectance", .low = 0.84, .high = 1.0}};
  const Metal& aluminium = metal_of("aluminium");
  constexpr float kCosine82 = 1.0f / 7.0f;
  const auto exact = [&](float c) { return shade::fresnel_conductor3(c, aluminium.n, aluminium.k); };
  const vec3 f0 = exact(1.0f);
  const vec3 tint = exact(kCosine82) / shade::fresnel_schlick(f0, vec3(1.0f), kCosine82);
  dip.curves = {
      {.label = "exact", .points = over_angle([&](float c) { return luminance(exact(c)); }), .ink = categorical_ink(6)},
      {.label = "Schlick",
       .points = over_angle([&](float c) { return luminance(shade::fresnel_schlick(f0, vec3(1.0f), c)); }),
       .ink = categorical_ink(1),
       .stroke = Stroke::dashed},
      {.label = "F82",
       .points = over_angle([&](float c) { return luminance(shade::fresnel_f82(f0, tint, c)); }),
       .ink = categorical_ink(2),
       .stroke = Stroke::dotted}};
  figure.panels.push_back({"fresnel-metals-f82.svg", plot_svg(dip), "The dip of aluminium, and two models of it"});
}

void add_metal_table(Figure& figure) {
  figure.table.head = {"", "F₀ red", "green", "blue", "largest error of Schlick"};
  for (const Metal& m : metals()) {
    const vec3 normal = shade::fresnel_conductor3(1.0f, m.n, m.k);
    float worst = 0.0f;
    for (int degrees = 0; degrees <= 90; ++degrees) {
      const float c = cosine(degrees);
      worst = std::max(worst, max_component(glm::abs(shade::fresnel_schlick(normal, vec3(1.0f), c) -
                                                     shade::fresnel_conductor3(c, m.n, m.k))));
    }
    figure.table.rows.push_back({std::string(m.name), fmt::format("{:.3f}", normal.x), fmt::format("{:.3f}", normal.y),
                                 fmt::format("{:.3f}", normal.z), fmt::format("{:.3f}", worst)});
  }
}

Figure metals_figure(FigureContext&) {
  Figure figure;
  figure.text = {
      "Metals reflect most of the light from every side, and coloured ones lose their colour towards the horizon. "
      "Their index is complex: light that enters is absorbed within its first wavelength. Some dip before they rise, "
      "which Schlick’s curve between F₀ and 1 cannot do; a tint of that curve at 82° can.",
      "The indices are measured ones, reduced to the three primaries so that the colour is right at the normal and "
      "at 82°."};
  figure.formulas = {
      "F_s = \\frac{a^2 + b^2 − 2 a \\, \\op{cos} \\, θ + \\op{cos}^2 \\, θ}{a^2 + b^2 + 2 a \\, \\op{cos} \\, θ + "
      "\\op{cos}^2 \\, θ} ; (a + i b)^2 = (n + i k)^2 − \\op{sin}^2 \\, θ",
      "F_0 = \\frac{(n − 1)^2 + k^2}{(n + 1)^2 + k^2}"};
  figure.sources = {"Born & Wolf 1999, Principles of Optics, §14.2",
                    "Johnson & Christy 1974, Optical constants of transition metals",
                    "Kutz, Hasan & Edmondson 2021, Novel Aspects of the Adobe Standard Material (F82)"};
  figure.functions = {"shade::fresnel_conductor3", "shade::fresnel_schlick", "shade::fresnel_f82", "find_metal"};
  figure.commands = {"candela render demo:row-conductor -o metals.png --size 840x140"};
  figure.columns = 2;

  add_channels(figure);
  add_luminous(figure);
  add_f82(figure);
  add_metal_table(figure);
  return figure;
}

}  // namespace

void add_fresnel_figures(std::vector<FigureInfo>& list) {
  list.push_back({"fresnel-dielectrics", "Fresnel curves of dielectrics", Chapter::fresnel, dielectrics});
  list.push_back({"fresnel-metals", "Fresnel curves of metals", Chapter::fresnel, metals_figure});
}

}  // namespace candela::figures
