#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/parallel.h"
#include "figures/figure.h"
#include "figures/plot.h"
#include "laws/laws.h"
#include "shade/microfacet.glsl.h"

// D, G, and the lobes that they make.

namespace candela::figures {
namespace {

constexpr std::array<float, 5> kRoughness{0.2f, 0.35f, 0.5f, 0.7f, 1.0f};
constexpr int kPoints = 241;

const char* const kWalter =
    "Walter, Marschner, Li & Torrance 2007, Microfacet Models for Refraction through Rough Surfaces";
const char* const kHeitz = "Heitz 2014, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs";
const char* const kKaris = "Karis 2013, Real Shading in Unreal Engine 4";

/// In the plane of incidence, positive angles to +x.
vec3 at_degrees(double degrees) {
  const double angle = degrees * 3.14159265358979 / 180.0;
  return {static_cast<float>(std::sin(angle)), 0.0f, static_cast<float>(std::cos(angle))};
}

std::string roughness_label(float roughness) { return fmt::format("r = {:.2g}", roughness); }

Axis angle_axis(std::string label, double high = 90.0) {
  return {.label = std::move(label), .low = 0.0, .high = high, .step = 15.0};
}

Figure ndf(FigureContext&) {
  Figure figure;
  figure.text = {
      "How many facets of a rough surface face a direction: the smoother it is, the more of them face the normal. D "
      "is a density of area per solid angle, so a narrow lobe is also a high one; the area that the facets cast onto "
      "the surface is always 1. Left each lobe over its own peak, right as it is.",
      "An artist authors the roughness r; the width of the lobe is its square, α = r²."};
  figure.formulas = {"D(h) = \\frac{α^2}{π ((n·h)^2 (α^2 − 1) + 1)^2}", "α = r^2", "∫_Ω D(h) (n·h) \\text{ d}h = 1"};
  figure.sources = {std::string(kWalter) + ", eq. 33",
                    "Trowbridge & Reitz 1975, Average irregularity representation of a rough surface for ray "
                    "reflection",
                    "Burley 2012, Physically-Based Shading at Disney (α = r²)"};
  figure.functions = {"shade::ggx_d", "shade::roughness_to_alpha"};
  figure.columns = 2;
  PolarPlot lobes{.title = "GGX lobes over roughness", .label = "D(h) / D(n)"};
  Plot curves{.title = "GGX over the angle to the normal",
              .x = angle_axis("angle between h and the normal, degrees"),
              .y = {.label = "D, 1/sr", .low = 1e-4, .high = 1e3, .scale = Scale::logarithmic}};
  for (std::size_t i = 0; i < kRoughness.size(); ++i) {
    const float alpha = shade::roughness_to_alpha(kRoughness[i]);
    const double peak = shade::ggx_d(vec3(0, 0, 1), alpha);
    const Ink ink = sequential_ink(static_cast<int>(i), static_cast<int>(kRoughness.size()));
    const auto d = [alpha](double degrees) { return static_cast<double>(shade::ggx_d(at_degrees(degrees), alpha)); };
    lobes.lobes.push_back(
        {roughness_label(kRoughness[i]), sampled(-90, 90, 2 * kPoints, [&](double t) { return d(t) / peak; }), ink});
    curves.curves.push_back(
        {.label = roughness_label(kRoughness[i]), .points = sampled(0, 90, kPoints, d), .ink = ink});
  }
  figure.panels = {{"ndf-ggx-lobes.svg", polar_plot_svg(lobes), "The lobe of facet normals h about the normal"},
                   {"ndf-ggx-curves.svg", plot_svg(curves), "The same in numbers, on a logarithmic scale"}};
  return figure;
}

Figure ndf_models(FigureContext&) {
  Figure figure;
  figure.text = {
      "Near the normal the three agree: the exponent of Blinn–Phong is chosen to make them. GGX has the longest "
      "tail, which is the glow around a highlight of metal or lacquer. Beckmann’s facets have normally distributed "
      "slopes and end sooner; the cosine power of Blinn–Phong cannot be told from them while the surface is smooth, "
      "and ends later where it is rough."};
  figure.formulas = {"D_{\\op{Beckmann}}(h) = \\frac{1}{π α^2 (n·h)^4} \\op{exp} ( \\frac{(n·h)^2 − 1}{α^2 (n·h)^2} )",
                     "D_{\\op{Blinn–Phong}}(h) = \\frac{m + 2}{2π} (n·h)^m ; m = \\frac{2}{α^2} − 2"};
  figure.sources = {std::string(kWalter) + ", eq. 25, 30 and 33",
                    "Beckmann & Spizzichino 1963, The Scattering of Electromagnetic Waves from Rough Surfaces",
                    "Blinn 1977, Models of Light Reflection for Computer Synthesized Pictures"};
  figure.functions = {"shade::ggx_d", "shade::beckmann_d", "shade::blinn_phong_d"};
  figure.columns = 2;
  for (const float roughness : {0.25f, 0.4f, 0.6f, 0.8f}) {
    const float alpha = shade::roughness_to_alpha(roughness);
    const double peak = shade::ggx_d(vec3(0, 0, 1), alpha);
    Plot plot{.title = fmt::format("Distributions of facets at roughness {}", roughness),
              .x = angle_axis("angle between h and the normal, degrees"),
              .y = {.label = "D, 1/sr",
                    .low = 1e-5 * std::exp2(std::round(std::log2(peak))),
                    .high = 3.0 * peak,
                    .scale = Scale::logarithmic}};
    const auto add = [&](const char* label, float (*d)(vec3, float), int ink, Stroke stroke) {
      plot.curves.push_back(
          {.label = label,
           .points = sampled(0, 89.9, kPoints,
                             [&](double degrees) { return static_cast<double>(d(at_degrees(degrees), alpha)); }),
           .ink = categorical_ink(ink),
           .stroke = stroke});
    };
    add("GGX", shade::ggx_d, 0, Stroke::solid);
    add("Beckmann", shade::beckmann_d, 1, Stroke::dashed);
    add("Blinn–Phong", shade::blinn_phong_d, 2, Stroke::dotted);
    figure.panels.push_back({fmt::format("ndf-models-r{:.0f}.svg", 100 * roughness), plot_svg(plot),
                             fmt::format("roughness {}, α = {:.2g}", roughness, alpha)});
  }
  return figure;
}

Figure geometry(FigureContext&) {
  Figure figure;
  figure.text = {
      "Facets stand in each other’s way: some are masked from the viewer, some lie in the shadow of others. G is the "
      "share of those that face h which are neither. The rougher the surface and the lower the light, the less is "
      "left."};
  figure.formulas = {"G_1(v) = \\frac{1}{1 + Λ(v)} ; Λ(v) = \\frac{1}{2} ( \\sqrt{1 + α^2 \\op{tan}^2 \\, θ} − 1 )",
                     "G_1(v) = \\frac{2 (n·v)}{(n·v) + \\sqrt{α^2 + (1 − α^2) (n·v)^2}}"};
  figure.sources = {std::string(kHeitz) + ", eq. 43 and 72", std::string(kWalter) + ", eq. 34"};
  figure.functions = {"shade::ggx_g1"};
  Plot plot{.title = "Smith’s masking over roughness",
            .x = angle_axis("angle between v and the normal, degrees"),
            .y = {.label = "G₁"}};
  for (std::size_t i = 0; i < kRoughness.size(); ++i) {
    const float alpha = shade::roughness_to_alpha(kRoughness[i]);
    plot.curves.push_back(
        {.label = roughness_label(kRoughness[i]),
         .points = sampled(0, 89.9, kPoints,
                           [alpha](double t) { return static_cast<double>(shade::ggx_g1(at_degrees(t), alpha)); }),
         .ink = sequential_ink(static_cast<int>(i), static_cast<int>(kRoughness.size()))});
  }
  figure.panels = {{"geometry-smith.svg", plot_svg(plot), "Masking of one direction by facets of GGX"}};
  return figure;
}

Figure geometry_models(FigureContext&) {
  Figure figure;
  figure.text = {
      "What engines and texts write for G, for a viewer and a light at equal angles on both sides of the normal. "
      "Smith’s height-correlated form is exact for its surface. The separable form treats masking and shadowing as "
      "if they were independent and loses most at the horizon. Schlick’s rational form has a k for lamps that "
      "brightens rough surfaces on purpose, and one for images that is close to Smith’s."};
  figure.formulas = {
      "G_{\\op{correlated}} = \\frac{1}{1 + Λ(v) + Λ(l)} ; G_{\\op{separable}} = G_1(v) G_1(l)",
      "G_{\\op{Schlick}}(x) = \\frac{x}{x (1 − k) + k} ; k_{\\op{direct}} = \\frac{(r + 1)^2}{8} ; k_{\\op{IBL}} = "
      "\\frac{r^2}{2}",
      "G_{\\op{Beckmann}}(v) = \\frac{3.535 c + 2.181 c^2}{1 + 2.276 c + 2.577 c^2} \\text{ for } c < 1.6 \\text{, "
      "else } 1 ; c = \\frac{1}{α \\op{tan} \\, θ}"};
  figure.sources = {std::string(kHeitz) + ", eq. 99", std::string(kKaris) + ", eq. 4",
                    "Schlick 1994, An Inexpensive BRDF Model for Physically-based Rendering",
                    std::string(kWalter) + ", eq. 23 and 27"};
  figure.functions = {"shade::ggx_v_smith", "shade::v_smith_separable", "shade::v_schlick_ggx",
                      "shade::v_beckmann_rational"};
  figure.columns = 2;
  for (const float roughness : {0.25f, 0.5f, 0.75f, 1.0f}) {
    const float alpha = shade::roughness_to_alpha(roughness);
    Plot plot{.title = fmt::format("Models of masking at roughness {}", roughness),
              .x = angle_axis("angle of v and of l to the normal, degrees"),
              .y = {.label = "G"}};
    const auto add = [&](const char* label, const std::function<float(vec3, vec3)>& v, int ink, Stroke stroke) {
      const auto g = [&](double degrees) {
        const vec3 wo = at_degrees(-degrees), wi = at_degrees(degrees);
        return 4.0 * static_cast<double>(wo.z) * static_cast<double>(wi.z) * static_cast<double>(v(wo, wi));
      };
      plot.curves.push_back(
          {.label = label, .points = sampled(0, 89.9, kPoints, g), .ink = categorical_ink(ink), .stroke = stroke});
    };
    add(
        "Smith, correlated", [=](vec3 o, vec3 i) { return shade::ggx_v_smith(o, i, alpha); }, 0, Stroke::solid);
    add(
        "Smith, separable", [=](vec3 o, vec3 i) { return shade::v_smith_separable(o, i, alpha); }, 5, Stroke::dashed);
    add(
        "Schlick, direct",
        [=](vec3 o, vec3 i) { return shade::v_schlick_ggx(o, i, shade::schlick_k_direct(roughness)); }, 1,
        Stroke::dashed);
    add(
        "Schlick, IBL", [=](vec3 o, vec3 i) { return shade::v_schlick_ggx(o, i, shade::schlick_k_ibl(roughness)); }, 4,
        Stroke::dotted);
    add(
        "Beckmann", [=](vec3 o, vec3 i) { return shade::v_beckmann_rational(o, i, alpha); }, 2, Stroke::dashed);
    figure.panels.push_back({fmt::format("geometry-models-r{:.0f}.svg", 100 * roughness), plot_svg(plot),
                             fmt::format("roughness {}", roughness)});
  }
  return figure;
}

shade::SurfaceParams white_metal(float roughness, const shade::ShadingModel& model) {
  shade::SurfaceParams params = shade::surface_params_default();
  params.roughness = roughness;
  params.model = model;
  if (!shade::shading_model_is_default(model)) params.lobes = shade::kLobeModel;
  return params;
}

Figure brdf_lobes(FigureContext&) {
  Figure figure;
  figure.text = {
      "What a metal makes of light from 45°, cut in the plane of incidence, each lobe over its own peak. Smooth "
      "metals reflect as a mirror; with roughness the lobe widens, and its middle leaves the mirror’s direction "
      "towards the horizon: the off-specular peak.",
      "Right a white dielectric of index 1.5: a diffuse lobe, which no longer knows where the light came from, with "
      "the reflection of its boundary on top, both in true proportion."};
  figure.formulas = {"f(l, v) = \\frac{D(h) F(v·h) G(l, v)}{4 (n·l) (n·v)}"};
  figure.sources = {"Cook & Torrance 1982, A Reflectance Model for Computer Graphics",
                    "Torrance & Sparrow 1967, Theory for Off-Specular Reflection from Roughened Surfaces"};
  figure.functions = {"shade::surface_prepare", "shade::surface_eval"};
  figure.columns = 2;
  constexpr double kIncoming = -45.0;
  const vec3 wo = at_degrees(kIncoming);
  PolarPlot metal{.title = "Lobes of a metal over roughness",
                  .label = "f (n·l) over its peak",
                  .incoming = kIncoming,
                  .incoming_label = "light"};
  PolarPlot plastic{.title = "Lobes of a dielectric over roughness",
                    .radius = 0.0,
                    .label = "f (n·l), 1/sr",
                    .incoming = kIncoming,
                    .incoming_label = "light"};
  for (std::size_t i = 0; i < kRoughness.size(); ++i) {
    const Ink ink = sequential_ink(static_cast<int>(i), static_cast<int>(kRoughness.size()));
    const auto lobe = [&](shade::SurfaceParams params) {
      const shade::Surface surface = shade::surface_prepare(params, wo);
      return sampled(-90, 90, 361, [&](double degrees) {
        return static_cast<double>(shade::surface_eval(surface, wo, at_degrees(degrees)).value.x);
      });
    };
    shade::SurfaceParams params = white_metal(kRoughness[i], shade::shading_model_candela());
    std::vector<dvec2> points = lobe(params);
    double peak = 0.0;
    for (const dvec2 p : points) peak = std::max(peak, p.y);
    for (dvec2& p : points) p.y /= peak;
    metal.lobes.push_back({roughness_label(kRoughness[i]), std::move(points), ink});
    if (i == 0) continue;  // its reflection is ten times as long as all else
    params.metallic = 0.0f;
    points = lobe(params);
    for (const dvec2 p : points) plastic.radius = std::max(plastic.radius, p.y);
    plastic.lobes.push_back({roughness_label(kRoughness[i]), std::move(points), ink});
  }
  figure.panels = {{"brdf-lobes-metal.svg", polar_plot_svg(metal), "White metal, each lobe over its peak"},
                   {"brdf-lobes-dielectric.svg", polar_plot_svg(plastic), "White dielectric of index 1.5"}};
  return figure;
}

Figure energy(FigureContext& context) {
  Figure figure;
  figure.text = {
      "A white surface in a white furnace must vanish: what it reflects is 1, whatever its roughness. Single "
      "scattering loses the light that bounces from facet to facet, more than half of it at roughness 1; a diffuse "
      "layer that ignores the reflection above it makes some. Every point is the integral of the compiled material "
      "over the hemisphere."};
  figure.formulas = {"E(v) = ∫_Ω f(l, v) (n·l) \\text{ d}l"};
  figure.sources = {"Kulla & Conty 2017, Revisiting Physically Based Shading at Imageworks",
                    "Heitz 2014, §6 (the white furnace)"};
  figure.functions = {"laws::furnace", "shade::surface_eval"};
  figure.commands = {"candela furnace"};
  figure.columns = 2;
  struct Named {
    const char* label;
    shade::ShadingModel model;
    Stroke stroke;
  };
  const std::array<Named, 5> models{{{"candela", shade::shading_model_candela(), Stroke::solid},
                                     {"gltf", shade::shading_model_gltf(), Stroke::dashed},
                                     {"ue4, learnopengl", shade::shading_model_ue4(), Stroke::dashed},
                                     {"thesis", shade::shading_model_thesis(), Stroke::dotted},
                                     {"blinn-phong", shade::shading_model_blinn_phong(), Stroke::dotted}}};
  constexpr int kSteps = 19;
  const vec3 wo = at_degrees(45.0);
  for (const float metallic : {1.0f, 0.0f}) {
    Plot plot{.title = "White furnace over roughness",
              .x = {.label = "roughness"},
              .y = {.label = "E at 45°", .low = 0.0, .high = 1.2}};
    if (metallic < 0.5f) plot.y = {.label = "E at 45°", .low = 0.9, .high = 1.1};
    for (std::size_t m = 0; m < models.size(); ++m) {
      context.check_stop();
      std::vector<dvec2> points(kSteps);
      parallel_for(0, kSteps, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const double roughness = 0.1 + 0.9 * static_cast<double>(i) / (kSteps - 1);
          shade::SurfaceParams params = white_metal(static_cast<float>(roughness), models[m].model);
          params.metallic = metallic;
          points[i] = {roughness, laws::furnace(laws::real_bsdf(params), wo, 1e-4).x};
        }
      });
      std::string label = models[m].label;
      if (metallic < 0.5f && label == "ue4, learnopengl") label = "ue4";
      plot.curves.push_back({.label = label,
                             .points = std::move(points),
                             .ink = categorical_ink(static_cast<int>(m)),
                             .stroke = models[m].stroke});
    }
    const bool is_metal = metallic > 0.5f;
    figure.panels.push_back({is_metal ? "energy-metal.svg" : "energy-dielectric.svg", plot_svg(plot),
                             is_metal ? "White metal" : "White dielectric of index 1.5 over a diffuse layer"});
  }
  return figure;
}

}  // namespace

void add_facet_figures(std::vector<FigureInfo>& list) {
  const Chapter c = Chapter::facets;
  list.push_back({"ndf-ggx", "Normal distribution over roughness", c, ndf});
  list.push_back({"ndf-models", "GGX against Beckmann and Blinn–Phong", c, ndf_models});
  list.push_back({"geometry", "The geometry term over roughness", c, geometry});
  list.push_back({"geometry-models", "Models of the geometry term", c, geometry_models});
  list.push_back({"brdf-lobes", "What facets make of a ray", c, brdf_lobes});
  list.push_back({"energy", "The white furnace", c, energy});
}

}  // namespace candela::figures
