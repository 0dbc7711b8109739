#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "content/demo_scenes.h"
#include "figures/figure.h"
#include "figures/shaded_balls.h"
#include "math/frame.h"
#include "scene/shading_model.h"
#include "shade/diffuse.glsl.h"
#include "shade/fresnel.glsl.h"

// Terms and models on balls: what each looks like.

namespace candela::figures {
namespace {

Film film_of(Image image) {
  Film film;
  film.beauty = std::move(image);
  return film;
}

std::vector<Material> balls_of(int count, float metallic) {
  std::vector<Material> materials(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Material& m = materials[static_cast<std::size_t>(i)];
    m.base_color = vec3(1.0f);
    m.metallic = metallic;
    m.roughness = 0.1f + 0.8f * static_cast<float>(i) / static_cast<float>(std::max(count - 1, 1));
  }
  return materials;
}

std::vector<std::string> roughness_scale(const std::vector<Material>& materials) {
  std::vector<std::string> scale;
  for (const Material& m : materials) scale.push_back(fmt::format("r = {:.1f}", m.roughness));
  return scale;
}

// ----- D, G and F

Figure facet_terms(FigureContext& context) {
  Figure figure;
  figure.text = {
      "A ball under one lamp from the upper right, term by term. D is where facets look half way between the lamp and "
      "the eye: a small bright spot of a smooth surface, a wide faint one of a rough one (each ball is scaled to its "
      "own "
      "brightest point). G darkens where the lamp or the eye grazes the surface, the more the rougher it is. F, here "
      "of "
      "light that is mirrored to the eye, rises towards the rim, whatever the roughness. Their product over "
      "4 (n·l) (n·v), times n·l, is what the lamp’s reflection looks like."};
  figure.formulas = {"f(l, v) = \\frac{D(h) F(v·h) G(l, v)}{4 (n·l) (n·v)}"};
  figure.sources = {"Cook & Torrance 1982, A Reflectance Model for Computer Graphics",
                    "Karis 2013, Real Shading in Unreal Engine 4"};
  figure.functions = {"shade::ggx_d", "shade::ggx_v_smith", "shade::fresnel_schlick", "shade::surface_eval"};
  const std::vector<Material> materials = balls_of(6, 1.0f);
  const std::vector<std::string> scale = roughness_scale(materials);
  const int side = context.pixels(140);
  const vec3 l = ball_direction({0.5f, 0.6f, 0.7f});
  struct Angles {
    vec3 wo, wi, half;
  };
  const auto angles_at = [&](const BallPoint& p) {
    const Frame frame = frame_from_normal(p.normal);
    return Angles{frame.to_local(p.to_eye), frame.to_local(l), frame.to_local(glm::normalize(l + p.to_eye))};
  };
  const auto add = [&](const char* file, const char* caption, const ShadePoint& value) {
    figure.panels.push_back(
        {file,
         develop(film_of(shaded_balls(materials, side, value)), {.exposure = 1.0f, .tone_curve = ToneCurve::linear}),
         caption,
         {},
         scale});
  };
  add("facet-terms-d.png", "D, over its largest value", [&](const BallPoint& p) {
    const Angles at = angles_at(p);
    const float most = shade::ggx_d(vec3(0, 0, 1), p.surface.alpha);
    return vec3(at.half.z > 0.0f ? shade::ggx_d(at.half, p.surface.alpha) / most : 0.0f);
  });
  add("facet-terms-g.png", "G", [&](const BallPoint& p) {
    const Angles at = angles_at(p);
    if (at.wi.z <= 0.0f) return vec3(0.0f);
    return vec3(shade::ggx_v_smith(at.wo, at.wi, p.surface.alpha) * 4.0f * at.wo.z * at.wi.z);
  });
  add("facet-terms-f.png", "F of a dielectric, F₀ = 0.04",
      [&](const BallPoint& p) { return shade::fresnel_schlick(vec3(0.04f), vec3(1.0f), p.wo.z); });
  add("facet-terms.png", "all three: f (n·l), of a white metal, with the light that bounces between facets",
      [&](const BallPoint& p) {
        const Angles at = angles_at(p);
        if (at.wi.z <= 0.0f) return vec3(0.0f);
        // The surface was prepared for a frame of its own, which is round about the normal as the lobe is.
        return shade::surface_eval(p.surface, at.wo, at.wi).value;
      });
  return figure;
}

// ----- metallic by roughness

Figure metallic_roughness(FigureContext& context) {
  Figure figure;
  figure.text = {
      "The two numbers of the metallic workflow against each other: one base colour, from plastic at the top to metal "
      "at "
      "the bottom, from a mirror at the left to a satin at the right."};
  figure.formulas = {"f = (1 − m) f_{\\op{dielectric}} + m f_{\\op{metal}} ; α = r^2"};
  figure.sources = {"Burley 2012, Physically-Based Shading at Disney", "de Vries, LearnOpenGL, PBR lighting"};
  figure.functions = {"path::render"};
  path::Settings settings;
  settings.width = settings.height = context.pixels(120);
  settings.samples = context.settings().samples;
  settings.background = Background::transparent;
  constexpr int kColumns = 7, kRows = 5;
  for (int row = 0; row < kRows; ++row) {
    const float metallic = static_cast<float>(row) / (kRows - 1);
    std::vector<Material> materials;
    std::vector<std::string> scale;
    for (int i = 0; i < kColumns; ++i) {
      Material material;
      material.base_color = vec3(0.6f, 0.08f, 0.05f);
      material.metallic = metallic;
      material.roughness = static_cast<float>(i) / (kColumns - 1);
      materials.push_back(material);
      scale.push_back(fmt::format("r = {:.2f}", material.roughness));
    }
    figure.panels.push_back({fmt::format("metallic-roughness-{}.png", row),
                             develop(trace_balls(context, materials, settings), {.exposure = 1.0f}),
                             fmt::format("metallic {:.2f}", metallic),
                             {},
                             scale});
  }
  return figure;
}

// ----- diffuse models

Figure diffuse_models(FigureContext& context) {
  Figure figure;
  figure.text = {
      "Four ways in which light leaves a matt surface, each of albedo 0.8, under a lamp beside the eye and under one "
      "from "
      "the side. Lambert’s is the same from everywhere. Rough matter, as clay or the moon, sends more light back to "
      "where "
      "it came from: under the lamp beside the eye its ball looks flat as a disc. Burley’s fit rises or falls towards "
      "the "
      "rim by roughness; Oren and Nayar’s facets lose what bounces between them; EON keeps it."};
  figure.formulas = {"f_{\\op{Lambert}} = \\frac{ρ}{π}",
                     "f_{\\op{Burley}} = \\frac{ρ}{π} (1 + (F_{D90} − 1) (1 − n·l)^5) (1 + (F_{D90} − 1) (1 − n·v)^5)"};
  figure.sources = {"Lambert 1760, Photometria", "Burley 2012, Physically-Based Shading at Disney",
                    "Oren & Nayar 1994, Generalization of Lambert’s Reflectance Model",
                    "Portsmouth, Kutz & Hill 2025, EON: A Practical Energy-Preserving Rough Diffuse BRDF"};
  figure.functions = {"shade::lambert_f", "shade::burley_renormalised_f", "shade::oren_nayar_f", "shade::eon_f"};
  const std::vector<Material> materials = balls_of(4, 0.0f);
  const std::vector<std::string> scale{"Lambert", "Burley, r = 1", "Oren–Nayar, σ = π/2", "EON, r = 1"};
  const vec3 albedo(0.8f);
  const auto model = [&](std::size_t ball, vec3 wo, vec3 wi) {
    const float cos_m = glm::dot(wo, glm::normalize(wo + wi));
    if (ball == 1) return shade::burley_renormalised_f(albedo, 1.0f, wi.z, wo.z, cos_m);
    if (ball == 2) return shade::oren_nayar_f(albedo, 0.5f * kPi, wo, wi);
    if (ball == 3) return shade::eon_f(albedo, 1.0f, wo, wi);
    return shade::lambert_f(albedo);
  };
  const auto add = [&](const char* file, const char* caption, vec3 lamp) {
    const vec3 l = ball_direction(lamp);
    const Image image = shaded_balls(materials, context.pixels(200), [&](const BallPoint& p) {
      const Frame frame = frame_from_normal(p.normal);
      const vec3 wi = frame.to_local(l), wo = frame.to_local(p.to_eye);
      return wi.z <= 0.0f ? vec3(0.0f) : kPi * wi.z * model(p.ball, wo, wi);
    });
    figure.panels.push_back(
        {file, develop(film_of(image), {.exposure = 1.0f, .tone_curve = ToneCurve::linear}), caption, {}, scale});
  };
  add("diffuse-models-front.png", "a lamp beside the eye", {0.02f, 0.02f, 1.0f});
  add("diffuse-models-side.png", "a lamp from the side", {0.9f, 0.3f, 0.3f});
  return figure;
}

// ----- furnaces

Figure furnace_pictures(FigureContext& context) {
  Figure figure;
  figure.text = {
      "White balls of metal in white light from everywhere. What neither takes nor makes light cannot be told from its "
      "surroundings: a model that keeps energy shows nothing. A dark ball has lost what bounces between its facets. "
      "Below each ball is what it sends to the eye of what arrives, in the mean over its disc; backgrounds show 1."};
  figure.formulas = {"E(v) = ∫_Ω f(l, v) (n·l) \\text{ d}l"};
  figure.sources = {"Heitz 2014, Understanding the Masking-Shadowing Function, §6",
                    "Kulla & Conty 2017, Revisiting Physically Based Shading at Imageworks"};
  figure.functions = {"path::Tracer with parse_shading_model"};
  figure.commands = {"candela furnace -o furnace.png"};
  Environment white;
  white.name = "white";
  white.constant = vec3(1.0f);
  path::Settings settings;
  settings.width = settings.height = context.pixels(120);
  settings.samples = std::max(1, context.settings().samples / 2);
  settings.bounces = 1;
  const std::vector<Material> materials = balls_of(6, 1.0f);
  for (const char* model : {"candela", "gltf", "ue4", "thesis", "blinn-phong"}) {
    const Film film = beside(static_cast<int>(materials.size()), [&](int i) {
      return context.trace(sphere_row({materials[static_cast<std::size_t>(i)]}), white, sphere_view(1), settings,
                           parse_shading_model(model));
    });
    std::vector<std::string> scale;
    const int side = settings.width;
    for (std::size_t i = 0; i < materials.size(); ++i) {
      double sum = 0.0;
      int count = 0;
      const double radius = side / static_cast<double>(kSphereSpacing) - 1.0;
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          if (std::hypot(x + 0.5 - 0.5 * side, y + 0.5 - 0.5 * side) > radius) continue;
          sum += static_cast<double>(film.beauty.rgb(static_cast<int>(i) * side + x, y).y);
          ++count;
        }
      }
      scale.push_back(fmt::format("r {:.1f}: {:.3f}", materials[i].roughness, sum / std::max(count, 1)));
    }
    figure.panels.push_back({fmt::format("furnace-pictures-{}.png", model),
                             develop(film, {.exposure = 0.5f, .tone_curve = ToneCurve::linear}),
                             model,
                             {},
                             scale});
  }
  return figure;
}

// ----- area lights

/// Balls of gold from smooth to rough, each alone before a glowing panel.
Scene ball_under_panel(int i) {
  Material material;
  material.base_color = vec3(1.0f, 0.782f, 0.344f);
  material.roughness = 0.1f + 0.2f * static_cast<float>(i);
  if (i == 4) {
    material.metallic = 0.0f;
    material.base_color = vec3(0.5f, 0.03f, 0.02f);
  }
  Scene scene = sphere_row({material});
  Material glow;
  glow.name = "panel";
  glow.base_color = vec3(0.0f);
  glow.metallic = 0.0f;
  glow.specular = 0.0f;
  glow.emission = vec3(8.0f);
  glow.double_sided = true;
  Mesh mesh;
  mesh.name = "panel";
  mesh.primitives.push_back(content::quad(vec3(-1.2f, 1.6f, 3.4f), vec3(0.0f, 0.9f, -1.0f), vec3(2.4f, 0, 0)));
  mesh.primitives.back().material = static_cast<int>(scene.materials.size());
  Node node;
  node.name = "panel";
  node.parent = 0;
  node.mesh = static_cast<int>(scene.meshes.size());
  scene.materials.push_back(glow);
  scene.meshes.push_back(std::move(mesh));
  scene.nodes.push_back(node);
  update_world_transforms(scene);
  validate(scene);
  return scene;
}

Figure area_lights(FigureContext& context) {
  Figure figure;
  figure.text = {
      "A lamp with a size: a panel above the eye. Its mirror image has its shape, which roughness melts; a point could "
      "not show it. In real time each lobe is turned into a cosine by a linear map, under which the panel stays a "
      "panel "
      "whose irradiance has a formula; the path tracer samples the panel. Below each ball is its relative RMS error."};
  figure.formulas = {"L_o = ∫_{\\op{panel}} f L_e \\frac{(n·l) (n_p·−l)}{d^2} \\text{ d}A"};
  figure.sources = {
      "Heitz, Dupuy, Hill & Neubelt 2016, Real-Time Polygonal-Light Shading with Linearly Transformed Cosines",
      "Lambert 1760, Photometria (the irradiance of a polygon)"};
  figure.functions = {"raster::Drawer::render", "path::render", "shade::area_share"};
  constexpr int kBalls = 5;
  const std::vector<std::string> scale{"r = 0.1", "r = 0.3", "r = 0.5", "r = 0.7", "r = 0.9, paint"};
  path::Settings tracing;
  tracing.width = tracing.height = context.pixels(160);
  tracing.samples = 2 * context.settings().samples;
  tracing.background = Background::transparent;
  raster::Settings drawing;
  drawing.width = drawing.height = tracing.width;
  drawing.frames = 16;
  drawing.background = Background::transparent;
  const Environment& none = context.environment("none");
  const View view = sphere_view(1);
  const DevelopSettings shown{.exposure = 1.0f};
  const Film truth = beside(kBalls, [&](int i) { return context.trace(ball_under_panel(i), none, view, tracing); });
  figure.panels.push_back({"area-lights.png", develop(truth, shown), "path traced", {}, scale});
  if (!context.has_opengl()) {
    figure.left_out.emplace_back("the row in real time, which needs OpenGL");
    return figure;
  }
  const Film drawn = beside(kBalls, [&](int i) { return *context.draw(ball_under_panel(i), none, view, drawing); });
  figure.panels.push_back({"area-lights-raster.png",
                           develop(drawn, shown),
                           "in real time, by linearly transformed cosines",
                           {},
                           errors_of_each(drawn, truth, kBalls)});
  return figure;
}

}  // namespace

void add_surface_figures(std::vector<FigureInfo>& list) {
  list.push_back({"facet-terms", "D, G and F on balls", Chapter::facets, facet_terms});
  list.push_back({"metallic-roughness", "Metallic by roughness", Chapter::spheres, metallic_roughness});
  list.push_back({"area-lights", "A lamp with a size", Chapter::light, area_lights});
  list.push_back({"diffuse-models", "Four diffuse models", Chapter::models, diffuse_models});
  list.push_back({"furnace-pictures", "White furnaces", Chapter::models, furnace_pictures});
}

}  // namespace candela::figures
