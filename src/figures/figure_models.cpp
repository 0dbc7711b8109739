#include <fmt/format.h>

#include <array>

#include "content/demo.h"
#include "figures/figure.h"
#include "image/metrics.h"
#include "scene/shading_model.h"
#include "shade/workflow.glsl.h"

namespace candela::figures {
namespace {

Figure blinn_phong(FigureContext& context) {
  Figure figure;
  figure.text = {
      "One scene, one light, six sets of formulas. Blinn–Phong without a microfacet denominator knows neither the "
      "horizon nor the energy of its lobe: metals go black but for the perfect mirror. The engines’ models differ "
      "from each other in the shade of a rough ball; what all of them lose is the light that bounces from facet to "
      "facet.",
      "Rows from the top: ivory, cobalt, gold, iron; roughness 0 to 1 from left to right. The error is the relative "
      "RMS difference from the energy-conserving model."};
  figure.formulas = {"f_{\\op{Blinn–Phong}} = \\frac{k_d}{π} + k_s (n·h)^m",
                     "f_{\\op{Cook–Torrance}} = k_d \\frac{ρ}{π} + \\frac{D F G}{4 (n·l) (n·v)}"};
  figure.sources = {"Blinn 1977, Models of Light Reflection for Computer Synthesized Pictures",
                    "Cook & Torrance 1982, A Reflectance Model for Computer Graphics",
                    "Karis 2013, Real Shading in Unreal Engine 4", "de Vries, LearnOpenGL, PBR",
                    "Ratković 2017, Physically Based Rendering (thesis, Zagreb)"};
  figure.functions = {"path::Tracer with parse_shading_model"};
  figure.columns = 2;
  const Scene scene = content::make_demo("spheres");
  path::Settings settings;
  settings.width = context.pixels(448);
  settings.height = context.pixels(252);
  settings.samples = context.settings().samples;
  const View view = scene_camera(scene, "0", 16.0f / 9.0f);
  Film truth;
  struct Named {
    const char* model;
    const char* caption;
  };
  const std::array<Named, 6> models{{{"candela", "candela: GGX, correlated Smith, multiple scattering"},
                                     {"blinn-phong", "blinn-phong: a cosine power, no denominator"},
                                     {"learnopengl", "learnopengl: GGX, Schlick’s G, no multiple scattering"},
                                     {"ue4", "ue4: the same with a diffuse layer that is not dimmed"},
                                     {"gltf", "gltf: as the specification prints it"},
                                     {"thesis", "thesis: Beckmann"}}};
  for (const Named& named : models) {
    Film film = context.trace(scene, context.environment("studio"), view, settings, parse_shading_model(named.model));
    const bool is_truth = truth.beauty.empty();
    figure.panels.push_back(
        {fmt::format("blinn-phong-{}.png", named.model), develop(film, {.exposure = scene.preferred_exposure}),
         named.caption,
         is_truth ? "the measure of the others" : "error " + percent_text(relative_error(film.beauty, truth.beauty))});
    figure.commands.push_back(
        fmt::format("candela render demo:spheres -o {0}.png --size {1}x{2} --spp {3} --shading {0}", named.model,
                    settings.width, settings.height, settings.samples));
    if (is_truth) truth = std::move(film);
  }
  return figure;
}

// ----- workflows

Material material_of(const shade::MetallicRoughness& m) {
  Material material;
  material.base_color = m.base_color;
  material.metallic = m.metallic;
  material.roughness = m.roughness;
  return material;
}

Material material_of(const shade::SpecularGlossiness& s) {
  Material material;
  material.specular_glossiness = true;
  material.ior = 0.0f;
  material.metallic = 0.0f;
  material.base_color = s.diffuse;
  material.specular_color = s.specular;
  material.roughness = 1.0f - s.glossiness;
  return material;
}

shade::MetallicRoughness metallic_roughness(vec3 base, float metallic, float roughness) {
  shade::MetallicRoughness m;
  m.base_color = base;
  m.metallic = metallic;
  m.roughness = roughness;
  return m;
}

shade::SpecularGlossiness specular_glossiness(vec3 diffuse, vec3 specular, float glossiness) {
  shade::SpecularGlossiness s;
  s.diffuse = diffuse;
  s.specular = specular;
  s.glossiness = glossiness;
  return s;
}

std::string color_text(vec3 c) { return fmt::format("{:.2f} {:.2f} {:.2f}", c.x, c.y, c.z); }

/// Two rows of the same balls in both vocabularies, and how far each ball of the second is from the first.
void add_pair(FigureContext& context, Figure& figure, const std::string& name, const std::vector<Material>& first,
              const std::vector<Material>& second, const std::array<const char*, 2>& captions,
              const std::vector<std::string>& scale) {
  const int count = static_cast<int>(first.size());
  const int side = context.pixels(130);
  path::Settings settings;
  settings.width = settings.height = side;
  settings.samples = context.settings().samples;
  settings.background = Background::transparent;
  const Film a = trace_balls(context, first, settings);
  const Film b = trace_balls(context, second, settings);
  figure.panels.push_back({name + "-a.png", develop(a, {.exposure = 1.0f}), captions[0], {}, scale});
  figure.panels.push_back(
      {name + "-b.png", develop(b, {.exposure = 1.0f}), captions[1], {}, errors_of_each(b, a, count)});
}

Figure workflows(FigureContext& context) {
  Figure figure;
  figure.text = {
      "Both workflows say the same two things: the reflectance at normal incidence and the albedo below it. What the "
      "metallic one names can always be said in the other, and at the ends of its slider the pictures agree. Between "
      "them they do not quite: a half metal is a mixture of two surfaces, and the converted one is one surface with "
      "the F₀ of the mixture.",
      "The other way not everything can be said: a coloured reflection over a diffuse layer of another hue has no "
      "base colour. The nearest is taken, and the residual is what is lost of either colour at most."};
  figure.formulas = {
      "F_0 = \\op{mix}(0.04, \\op{base}, m) = \\op{specular}",
      "c_{\\op{diffuse}} = \\op{base} (1 − m) (1 − 0.04) = \\op{diffuse} (1 − \\op{max} \\, \\op{specular})",
      "0.04 m^2 + (d + F_0 − 0.08) m + 0.04 − F_0 = 0"};
  figure.sources = {"Khronos Group 2017, KHR_materials_pbrSpecularGlossiness, with its conversion",
                    "Khronos Group 2021, glTF 2.0 Specification, Appendix B"};
  figure.functions = {"shade::specular_glossiness_from_metallic", "shade::metallic_from_specular_glossiness",
                      "shade::workflow_residual"};
  figure.commands = {"candela render demo:row-specular-glossiness -o row-specular-glossiness.png --size 840x140"};
  const vec3 gold(1.0f, 0.782f, 0.344f), blue(0.023f, 0.107f, 0.434f);

  std::vector<Material> first, second;
  std::vector<std::string> scale;
  for (int i = 0; i < 7; ++i) {
    const float t = static_cast<float>(i) / 6.0f;
    const shade::MetallicRoughness m = metallic_roughness(gold, t, 0.3f);
    first.push_back(material_of(m));
    second.push_back(material_of(shade::specular_glossiness_from_metallic(m)));
    scale.push_back(fmt::format("m = {:.2f}", t));
  }
  add_pair(context, figure, "workflows-metallic", first, second,
           {"metallic–roughness, metallic 0 to 1",
            "converted to specular–glossiness; below each its relative RMS difference"},
           scale);

  first.clear(), second.clear(), scale.clear();
  figure.table.head = {"diffuse", "specular", "→ base colour", "metallic", "residual"};
  for (int i = 0; i < 7; ++i) {
    const float t = static_cast<float>(i) / 6.0f;
    const shade::SpecularGlossiness s = specular_glossiness(blue, glm::mix(vec3(0.04f), gold, t), 0.7f);
    const shade::MetallicRoughness m = shade::metallic_from_specular_glossiness(s);
    const float residual = shade::workflow_residual(s);
    first.push_back(material_of(s));
    second.push_back(material_of(m));
    scale.push_back(fmt::format("residual {:.2f}", residual));
    figure.table.rows.push_back({color_text(s.diffuse), color_text(s.specular), color_text(m.base_color),
                                 fmt::format("{:.3f}", m.metallic), fmt::format("{:.3f}", residual)});
  }
  add_pair(context, figure, "workflows-specular", first, second,
           {"specular–glossiness: blue diffuse, specular from 0.04 to gold",
            "converted to metallic–roughness; below each its relative RMS difference"},
           scale);
  return figure;
}

Figure global_illumination(FigureContext& context) {
  Figure figure;
  figure.text = {
      "With one bounce the lamp lights what it sees and everything else is black, the ceiling too. The second brings "
      "the colours of the walls onto the blocks; each further one adds about half of what the one before it did. The "
      "share is of the mean luminance of the picture, the lamp in it included, with 32 bounces."};
  figure.formulas = {"L_o = L_e + ∫_Ω f L_i (n·l) \\text{ d}l", "L = L_e + T L_e + T^2 L_e + …"};
  figure.sources = {
      "Kajiya 1986, The Rendering Equation",
      "Goral, Torrance, Greenberg & Battaile 1984, Modeling the Interaction of Light Between Diffuse Surfaces"};
  figure.functions = {"path::render with Settings::bounces"};
  figure.columns = 3;
  const Scene scene = content::make_demo("cornell");
  const Environment none = context.environment("none");
  path::Settings settings;
  settings.width = settings.height = context.pixels(280);
  settings.samples = context.settings().samples;
  const View view = scene_camera(scene, "0", 1.0f);
  constexpr int kMany = 32;
  const std::array<int, 6> bounces{1, 2, 3, 4, 8, kMany};
  std::vector<Film> films;
  for (const int count : bounces) {
    settings.bounces = count;
    films.push_back(context.trace(scene, none, view, settings));
    figure.commands.push_back(
        fmt::format("candela render demo:cornell -o bounces-{0}.png --size {1}x{1} --spp {2} --bounces {0}", count,
                    settings.width, settings.samples));
  }
  const double all = luminance(image_mean(films.back().beauty));
  for (std::size_t i = 0; i < films.size(); ++i) {
    figure.panels.push_back({fmt::format("global-illumination-{}.png", bounces[i]),
                             develop(films[i], {.exposure = scene.preferred_exposure}),
                             bounces[i] == 1 ? "1 bounce: direct light" : fmt::format("{} bounces", bounces[i]),
                             percent_text(luminance(image_mean(films[i].beauty)) / all) + " of the light"});
  }
  return figure;
}

}  // namespace

void add_model_figures(std::vector<FigureInfo>& list) {
  const Chapter c = Chapter::models;
  list.push_back({"blinn-phong", "Blinn–Phong against physically based shading", c, blinn_phong});
  list.push_back({"workflows", "Metallic against specular–glossiness", c, workflows});
  list.push_back({"global-illumination", "Direct and indirect light", c, global_illumination});
}

}  // namespace candela::figures
