#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "content/demo_scenes.h"
#include "figures/figure.h"
#include "figures/plot.h"
#include "figures/shaded_balls.h"
#include "ibl/cube.h"
#include "ibl/irradiance.h"
#include "ibl/prefilter.h"
#include "ibl/sh.h"
#include "ibl/source.h"
#include "ibl/tables.h"
#include "ibl/verify.h"
#include "shade/image_light.glsl.h"

// Light from an image: irradiance, prefiltered levels, and what is lost by each.

namespace candela::figures {
namespace {

const char* const kKaris = "Karis 2013, Real Shading in Unreal Engine 4";

constexpr int kLampBalls = 5;

/// One of kLampBalls balls, alone under four lamps, as the texts have them.
Scene ball_under_lamps(int i) {
  Material material;
  material.base_color = i % 2 == 0 ? vec3(0.5f, 0.03f, 0.02f) : vec3(1.0f, 0.782f, 0.344f);
  material.metallic = i % 2 == 0 ? 0.0f : 1.0f;
  material.roughness = 0.1f + 0.2f * static_cast<float>(i);
  Scene scene = sphere_row({material});
  for (const vec2 at : {vec2(-4, 4), vec2(4, 4), vec2(-4, -4), vec2(4, -4)}) {
    Node node;
    node.name = "lamp";
    node.parent = 0;
    node.parent_from_node = content::translation(vec3(at, 8.0f));
    node.light = static_cast<int>(scene.lights.size());
    scene.nodes.push_back(node);
    scene.lights.push_back({.name = "lamp", .intensity = 40.0f});
  }
  update_world_transforms(scene);
  validate(scene);
  return scene;
}

Figure irradiance_map(FigureContext& context) {
  Figure figure;
  figure.text = {
      "Four lamps light what faces them; the rest of a ball is black, and a metal shows four dots. With the light of "
      "a room, in an irradiance map for what is diffuse and a prefiltered cube for what is not, the balls have a "
      "place to be in. The real-time renderer looks both up; the path tracer asks the room itself."};
  figure.formulas = {
      "L_o = ∑_k f(l_k, v) E_k (n·l_k) + \\frac{ρ}{π} E(n) + ∫_Ω f_{\\op{specular}} L_i (n·l) \\text{ d}l",
      "E(n) = ∫_Ω L_i(l) (n·l) \\text{ d}l"};
  figure.sources = {"de Vries, LearnOpenGL, PBR lighting and Diffuse irradiance",
                    "Ramamoorthi & Hanrahan 2001, An Efficient Representation for Irradiance Environment Maps", kKaris};
  figure.functions = {"raster::Drawer::render", "path::render", "ibl::irradiance_cube"};
  path::Settings tracing;
  tracing.width = tracing.height = context.pixels(160);
  tracing.samples = 2 * context.settings().samples;
  tracing.background = Background::transparent;
  raster::Settings drawing;
  drawing.width = drawing.height = tracing.width;
  drawing.frames = 16;
  drawing.background = Background::transparent;
  const View view = sphere_view(1);
  const auto traced = [&](const char* environment) {
    return beside(kLampBalls, [&](int i) {
      return context.trace(ball_under_lamps(i), context.environment(environment), view, tracing);
    });
  };
  const auto drawn = [&](const char* environment) {
    return beside(kLampBalls, [&](int i) {
      return *context.draw(ball_under_lamps(i), context.environment(environment), view, drawing);
    });
  };
  const Film truth = traced("studio");
  const DevelopSettings shown{.exposure = 1.0f};
  const auto add = [&](const char* file, const Film& film, const char* caption) {
    figure.panels.push_back({file, develop(film, shown), caption,
                             "error " + percent_text(relative_error(film.beauty, truth.beauty)),
                             errors_of_each(film, truth, kLampBalls)});
  };
  add("irradiance-map-lamps.png", traced("none"), "lamps alone, path traced");
  if (context.has_opengl()) {
    add("irradiance-map-lamps-raster.png", drawn("none"), "lamps alone, in real time");
    add("irradiance-map-raster.png", drawn("studio"),
        "lamps and the room by irradiance map and prefiltered cube, in real time");
  } else {
    figure.left_out.emplace_back("the pictures in real time, which need OpenGL");
  }
  figure.panels.push_back({"irradiance-map-truth.png", develop(truth, shown), "lamps and the room, path traced",
                           "the measure of the others"});
  return figure;
}

vec3 lookup_level(const Cubemap& cube, dvec3 direction, float level) {
  const auto last = static_cast<float>(cube.levels.size() - 1);
  const float at = std::clamp(level, 0.0f, last);
  const auto fine = static_cast<std::size_t>(at);
  const std::size_t coarse = std::min(fine + 1, cube.levels.size() - 1);
  return glm::mix(ibl::cube_lookup(cube.levels[fine], direction), ibl::cube_lookup(cube.levels[coarse], direction),
                  at - static_cast<float>(fine));
}

Figure environment_mips(FigureContext& context) {
  Figure figure;
  figure.text = {
      "A rough metal sees the room blurred. The simplest thing is a constant; the next simplest to read a smaller "
      "copy of the environment, chosen by roughness, whose texels are boxes and not lobes. The split sum blurs the "
      "environment by the lobe itself, once and for all directions, as if it were seen from the front, and "
      "multiplies by what the lobe reflects of white light. The path tracer makes no assumption.",
      "What is left of the split sum’s error is that front view: towards the rim a true reflection stretches, and "
      "its middle moves towards the normal. Reading the blurred light there instead of in the mirror direction helps "
      "where the surface is rough, and harms where it is nearly smooth."};
  figure.formulas = {"∫_Ω f L_i (n·l) \\text{ d}l ≈ ( ∫_Ω L_i D (n·l) \\text{ d}l ) ( F_0 A + F_{90} B )",
                     "\\op{level} = \\op{levels} − 1 + \\op{log}_2 \\, α"};
  figure.sources = {kKaris, "Lagarde & de Rousiers 2014, Moving Frostbite to Physically Based Rendering, §4.9",
                    "Ratković 2017, Physically Based Rendering (the simple alternatives)"};
  figure.functions = {"ibl::cube_mips", "ibl::Prefilter", "shade::surface_shares", "shade::image_light_lookup",
                      "path::render"};
  const std::array<float, 6> roughness{0.0f, 0.2f, 0.4f, 0.6f, 0.8f, 1.0f};
  std::vector<Material> materials;
  std::vector<std::string> scale;
  for (const float r : roughness) {
    Material material;
    material.base_color = vec3(1.0f, 0.782f, 0.344f);
    material.roughness = r;
    materials.push_back(material);
    scale.push_back(fmt::format("r = {:.1f}", r));
  }
  const int side = context.pixels(140);
  const Environment& studio = context.environment("studio");
  path::Settings settings;
  settings.width = settings.height = side;
  settings.samples = context.settings().reference / 2;
  settings.background = Background::transparent;
  const Film truth = trace_balls(context, materials, settings);

  const ibl::Source source = ibl::make_source(studio);
  const Cubemap mips = ibl::cube_mips(ibl::cube_from_source(source, 256));
  std::vector<ibl::Kernel> kernels;
  for (std::size_t i = 1; i < roughness.size(); ++i) kernels.emplace_back(ibl::Lobe::ggx, roughness[i]);
  const ibl::Prefilter prefilter(source, kernels, {});
  Cubemap filtered;  // a level for each roughness
  filtered.levels.push_back(mips.levels[0]);
  for (const ibl::Kernel& kernel : kernels) {
    context.check_stop();
    filtered.levels.push_back(prefilter.faces(kernel, 64));
  }
  const vec3 mean(ibl::total_flux(source) / (4.0 * 3.14159265358979));

  const DevelopSettings shown{.exposure = 1.0f};
  const auto add = [&](const char* file, const char* caption, Image image) {
    Film film;
    film.beauty = std::move(image);
    figure.panels.push_back({file, develop(film, shown), caption,
                             "error " + percent_text(relative_error(film.beauty, truth.beauty)),
                             errors_of_each(film, truth, static_cast<int>(materials.size()))});
  };
  figure.panels.push_back({"environment-mips-truth.png", develop(truth, shown),
                           fmt::format("path traced, {} samples per pixel", settings.samples),
                           "the measure of the others", scale});
  add("environment-mips-dominant.png",
      "split sum, read where the lobe has its middle and as wide as it is there; what facets reflect more than once, "
      "by the irradiance",
      shaded_balls(materials, side, [&](const BallPoint& p) {
        const shade::SurfaceShares shares = shade::surface_shares(p.surface, p.wo);
        const shade::ImageLightLookup at =
            shade::image_light_lookup(p.normal, p.mirrored, p.surface.alpha, shares.rise);
        const float level = std::sqrt(at.alpha) * static_cast<float>(filtered.levels.size() - 1);
        return lookup_level(filtered, dvec3(at.direction), level) * shares.specular +
               ibl::cube_lookup(filtered.levels.back(), dvec3(p.normal)) * shares.spread;
      }));
  add("environment-mips-split-sum.png",
      "split sum: prefiltered by the lobe, read in the mirror direction, times the table",
      shaded_balls(materials, side, [&](const BallPoint& p) {
        const shade::SurfaceShares shares = shade::surface_shares(p.surface, p.wo);
        return ibl::cube_lookup(filtered.levels[p.ball], dvec3(p.mirrored)) * (shares.specular + shares.spread);
      }));
  add("environment-mips.png", "environment mips by roughness, times Schlick’s curve",
      shaded_balls(materials, side, [&](const BallPoint& p) {
        const float level = shade::image_light_level(p.surface.alpha, static_cast<float>(mips.levels.size()));
        return lookup_level(mips, dvec3(p.mirrored), level) *
               shade::fresnel_schlick(p.surface.f0_metal, vec3(1.0f), p.wo.z);
      }));
  add("environment-mips-constant.png", "constant ambient light: the mean of the environment",
      shaded_balls(materials, side, [&](const BallPoint& p) { return mean * p.surface.f0_metal; }));
  return figure;
}

Figure split_sum_table(FigureContext&) {
  Figure figure;
  figure.text = {
      "The second factor of the split sum depends on two numbers alone, so it is a small picture: the reflectance of "
      "facets under white light is F₀ times the red channel plus the green one. To the right the viewer is in front, "
      "upwards the surface is smooth."};
  figure.formulas = {"∫_Ω f (n·l) \\text{ d}l = F_0 A(n·v, r) + F_{90} B(n·v, r)"};
  figure.sources = {std::string(kKaris) + ", eq. 8"};
  figure.functions = {"ibl::make_tables", "ibl::split_sum"};
  figure.commands = {"candela bake --tables -o tables"};
  figure.columns = 2;
  constexpr int kSize = 64, kZoom = 5;
  const ibl::Tables tables = ibl::make_tables(kSize);
  DisplayImage picture{kSize * kZoom, kSize * kZoom, {}};
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const vec3 v = tables.dfg.rgb(x / kZoom, y / kZoom);
      for (const float c : {v.x, v.y, 0.0f}) {
        picture.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(c, 0.0f, 1.0f))));
      }
      picture.rgba.push_back(255);
    }
  }
  Plot plot{.title = "A and B",
            .x = {.label = "n·v", .low = 0, .high = 1},
            .y = {.label = "A (solid), B (dashed)"},
            .height = 460};
  const std::array<float, 4> roughness{0.1f, 0.4f, 0.7f, 1.0f};
  for (std::size_t i = 0; i < roughness.size(); ++i) {
    const Ink ink = sequential_ink(static_cast<int>(i), static_cast<int>(roughness.size()));
    for (const bool is_b : {false, true}) {
      plot.curves.push_back({.label = is_b ? "" : fmt::format("r = {:.1f}", roughness[i]),
                             .points = sampled(0.01, 1.0, 100,
                                               [&](double mu) {
                                                 const vec2 ab = ibl::split_sum(static_cast<float>(mu), roughness[i]);
                                                 return static_cast<double>(is_b ? ab.y : ab.x);
                                               }),
                             .ink = ink,
                             .stroke = is_b ? Stroke::dashed : Stroke::solid});
    }
  }
  figure.panels = {{"split-sum-table.png", picture, "A red, B green; n·v to the right, roughness downwards"},
                   {"split-sum-table-curves.svg", plot_svg(plot), "The same as curves"}};
  return figure;
}

Figure irradiance_convergence(FigureContext& context) {
  Figure figure;
  figure.text = {
      "Three ways to the irradiance map of the studio, against the exact sum over all of its texels. The grid in "
      "polar coordinates, as texts print it, needs the sine of the polar angle or its pole is far too bright; "
      "directions of cosine density, here Hammersley’s points, need no weight. Nine numbers of spherical harmonics, "
      "degree 2, hold almost all of it, for a cosine is a wide lobe."};
  figure.formulas = {
      "E(n) = ∫_Ω L_i (n·l) \\text{ d}l ≈ \\frac{2 π}{N_1} \\frac{π}{2 N_2} ∑_i ∑_j L_i \\, \\op{cos} \\, θ_j \\, "
      "\\op{sin} \\, θ_j",
      "E(n) = ∑_{l m} A_l L_{l m} Y_{l m}(n) ; A_0 = π ; A_1 = \\frac{2 π}{3} ; A_2 = \\frac{π}{4}"};
  figure.sources = {"Ramamoorthi & Hanrahan 2001, An Efficient Representation for Irradiance Environment Maps",
                    "de Vries, LearnOpenGL, Diffuse irradiance"};
  figure.functions = {"ibl::irradiance", "ibl::sh_project", "ibl::sh_irradiance"};
  figure.commands = {"candela bake studio -o studio --irradiance riemann --samples 1024 --sh-order 2"};
  figure.columns = 2;
  const ibl::Source source = ibl::make_source(context.environment("studio"));
  const std::vector<dvec3> directions = ibl::random_directions(64, 3);
  const std::vector<dvec3> exact = ibl::irradiance(source, directions, ibl::IrradianceMethod::exact, 0);
  context.check_stop();
  Plot plot{.title = "Irradiance over directions",
            .x = {.label = "directions N", .low = 4, .high = 16384, .scale = Scale::logarithmic},
            .y = {.label = "relative error, root mean square", .low = 1e-4, .high = 2, .scale = Scale::logarithmic}};
  for (const bool is_grid : {true, false}) {
    std::vector<dvec2> errors;
    for (int n = 4; n <= 16384; n *= 4) {
      const std::vector<dvec3> values = ibl::irradiance(
          source, directions, is_grid ? ibl::IrradianceMethod::riemann : ibl::IrradianceMethod::montecarlo, n, 1);
      errors.emplace_back(n, ibl::compare(values, exact, directions).rms);
    }
    plot.curves.push_back({.label = is_grid ? "Riemann" : "Hammersley",
                           .points = std::move(errors),
                           .ink = categorical_ink(is_grid ? 2 : 0),
                           .stroke = is_grid ? Stroke::dashed : Stroke::solid,
                           .has_markers = true});
  }
  std::vector<dvec2> by_order;
  for (int order = 0; order <= ibl::kMostShOrder; ++order) {
    const ibl::Sh sh = ibl::sh_irradiance(ibl::sh_project(source, order));
    std::vector<dvec3> values;
    values.reserve(directions.size());
    for (const dvec3 d : directions) values.push_back(ibl::sh_evaluate(sh, d));
    by_order.emplace_back(order, ibl::compare(values, exact, directions).rms);
  }
  figure.table.head = {"degree of harmonics"};
  std::vector<std::string> row{"error"};
  for (const dvec2 p : by_order) {
    figure.table.head.push_back(fmt::format("{:.0f}", p.x));
    row.push_back(percent_text(p.y));
  }
  figure.table.rows = {row};
  Plot harmonics{
      .title = "Irradiance over the degree of harmonics",
      .x = {.label = "degree of harmonics", .low = 0, .high = ibl::kMostShOrder, .step = 1},
      .y = {.label = "relative error, root mean square", .low = 1e-3, .high = 1, .scale = Scale::logarithmic},
      .curves = {{.label = "", .points = by_order, .ink = categorical_ink(1), .has_markers = true}}};
  figure.panels = {{"irradiance-convergence.svg", plot_svg(plot), "Sums over directions"},
                   {"irradiance-convergence-harmonics.svg", plot_svg(harmonics),
                    "Spherical harmonics; odd degrees beyond 1 add nothing to a cosine"}};
  return figure;
}

}  // namespace

void add_image_light_figures(std::vector<FigureInfo>& list) {
  const Chapter c = Chapter::image_light;
  list.push_back({"irradiance-map", "Lamps alone against an irradiance map", c, irradiance_map});
  list.push_back({"environment-mips", "Environment mips, split sum and the truth", c, environment_mips});
  list.push_back({"split-sum-table", "The table of the split sum", c, split_sum_table});
  list.push_back({"irradiance-convergence", "Ways to an irradiance map", c, irradiance_convergence});
}

}  // namespace candela::figures
