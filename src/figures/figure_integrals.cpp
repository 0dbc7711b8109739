#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "content/demo.h"
#include "figures/figure.h"
#include "figures/plot.h"
#include "ibl/sampling.h"
#include "ibl/source.h"
#include "ibl/verify.h"
#include "laws/laws.h"
#include "math/frame.h"
#include "math/hash.h"
#include "math/sobol.h"
#include "shade/surface.glsl.h"

// The reflectance equation, solved in several ways, and how fast each gets there.

namespace candela::figures {

namespace {

/// A point of a surface under light from far away: the integrand of its reflected radiance.
class Reflection {
 public:
  Reflection(const ibl::Source& source, const shade::SurfaceParams& params, vec3 normal)
      : source_(source), frame_(frame_from_normal(normal)), surface_(shade::surface_prepare(params, wo())) {}

  static vec3 wo() { return laws::direction(0.8f, 0.4f); }

  double incident(vec3 wi) const {
    return luminance(ibl::radiance_at(source_, glm::normalize(dvec3(frame_.to_world(wi)))));
  }
  /// f L cos.
  double integrand(vec3 wi) const {
    return static_cast<double>(shade::surface_eval(surface_, wo(), wi).value.x) * incident(wi);
  }

  /// Midpoints of 4n steps of azimuth by n of the polar angle, with the sine of dω.
  double riemann(int n) const {
    const double step_theta = 0.5 * kPiD / n, step_phi = 2.0 * kPiD / (4.0 * n);
    double sum = 0.0;
    for (int j = 0; j < n; ++j) {
      const double theta = (j + 0.5) * step_theta;
      double ring = 0.0;
      for (int i = 0; i < 4 * n; ++i) {
        ring +=
            integrand(laws::direction(static_cast<float>(std::cos(theta)), static_cast<float>((i + 0.5) * step_phi)));
      }
      sum += ring * std::sin(theta);
    }
    return sum * step_theta * step_phi;
  }

  /// Directions of equal density over the hemisphere, 1 / 2π.
  double uniform(int count, std::uint32_t seed) const {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      const std::uint32_t key = hash_combine(seed, static_cast<std::uint32_t>(i));
      const float u = unit_float(key), v = unit_float(hash(key));
      sum += integrand(laws::direction(u, 2.0f * kPi * v));
    }
    return 2.0 * kPiD * sum / count;
  }

  /// Directions as the surface would send them, by independent numbers or by Sobol' points.
  double importance(int count, std::uint32_t seed, bool is_sobol) const {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      vec3 u;
      if (is_sobol) {
        u = SobolSampler(seed, static_cast<std::uint32_t>(i)).next_3d();
      } else {
        const std::uint32_t key = hash_combine(seed, static_cast<std::uint32_t>(i));
        u = vec3(unit_float(key), unit_float(hash(key)), unit_float(hash(key + 1)));
      }
      const shade::SurfaceSample s = shade::surface_sample(surface_, wo(), u);
      if (s.pdf > 0.0f && s.wi.z > 0.0f) sum += static_cast<double>(s.weight.x) * incident(s.wi);
    }
    return sum / count;
  }

 private:
  static constexpr double kPiD = 3.14159265358979323846;

  const ibl::Source& source_;
  Frame frame_;
  shade::Surface surface_;
};

struct Method {
  const char* name;
  int seeds;  ///< 1 = nothing in it is random
  std::function<double(const Reflection&, int count, std::uint32_t seed)> estimate;
  Stroke stroke;
};

int grid_side(int count) { return std::max(1, static_cast<int>(std::lround(std::sqrt(count / 4.0)))); }

std::array<Method, 4> all_methods() {
  const auto uniform = [](const Reflection& r, int n, std::uint32_t seed) { return r.uniform(n, seed); };
  const auto importance = [](const Reflection& r, int n, std::uint32_t seed) { return r.importance(n, seed, false); };
  const auto riemann = [](const Reflection& r, int n, std::uint32_t) { return r.riemann(grid_side(n)); };
  const auto sobol = [](const Reflection& r, int n, std::uint32_t seed) { return r.importance(n, seed, true); };
  constexpr int kSeeds = 16;
  return {{{"Monte Carlo, uniform", kSeeds, uniform, Stroke::solid},
           {"Monte Carlo, importance", kSeeds, importance, Stroke::solid},
           {"Riemann, N₁ = 4 N₂", 1, riemann, Stroke::dashed},
           {"Sobol’, importance", kSeeds, sobol, Stroke::solid}}};
}

/// Relative error for each count, root mean square over points and seeds.
std::vector<dvec2> method_errors(FigureContext& context, const Method& method, const std::vector<Reflection>& points,
                                 const std::vector<double>& truth, const std::vector<int>& counts) {
  std::vector<dvec2> errors;
  for (const int n : counts) {
    context.check_stop();
    std::vector<double> squares(points.size());
    parallel_for(0, points.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        for (int s = 0; s < method.seeds; ++s) {
          const std::uint32_t seed = hash_combine(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(s));
          const double e = method.estimate(points[i], n, seed) / truth[i] - 1.0;
          squares[i] += e * e / method.seeds;
        }
      }
    });
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
    errors.emplace_back(n, std::sqrt(sum / static_cast<double>(points.size())));
  }
  return errors;
}

Figure riemann_monte_carlo(FigureContext& context) {
  Figure figure;
  figure.text = {
      "The light that a surface point sends to the eye is an integral over all that falls onto it. A Riemann sum "
      "walks a grid of azimuth and polar angle and must weigh each cell by the sine of the latter; a Monte Carlo sum "
      "asks at random directions and divides by their density. Both converge to the same number.",
      "The plot is the relative error of the radiance of a metal of roughness 0.4 in the studio, root mean square "
      "over normals and seeds. Random points halve their error with four times the work, slope −½, whatever the "
      "dimension. Drawing directions as the surface reflects them lowers the whole curve; Sobol’ points, which fill "
      "the square evenly, make it steeper. The grid beats them once its cells are finer than the lobe and the "
      "softboxes, in two dimensions: with each bounce it would need the square of its points again, and the random "
      "sum does not."};
  figure.formulas = {
      "L_o(v) = ∫_Ω f(l, v) L_i(l) (n·l) \\text{ d}l",
      "L_o ≈ \\frac{2 π}{N_1} \\frac{π}{2 N_2} ∑_i ∑_j f L_i \\, \\op{cos} \\, θ_j \\, \\op{sin} \\, θ_j",
      "L_o ≈ \\frac{1}{N} ∑_k \\frac{f L_i \\, \\op{cos} \\, θ_k}{p(l_k)}"};
  figure.sources = {"de Vries, LearnOpenGL, Diffuse irradiance", "Kajiya 1986, The Rendering Equation",
                    "Burley 2020, Practical Hash-based Owen Scrambling"};
  figure.functions = {"shade::surface_eval", "shade::surface_sample", "ibl::radiance_at", "SobolSampler"};
  const ibl::Source source = ibl::make_source(context.environment("studio"));
  shade::SurfaceParams params = shade::surface_params_default();
  params.base_color = vec3(0.9f);
  params.roughness = 0.4f;

  const bool is_draft = context.settings().samples < 32;
  const std::vector<dvec3> normals = ibl::random_directions(is_draft ? 6 : 16, 7);
  std::vector<Reflection> points;
  points.reserve(normals.size());
  for (const dvec3 n : normals) points.emplace_back(source, params, glm::normalize(vec3(n)));

  std::vector<double> truth(points.size());
  parallel_for(0, points.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) truth[i] = points[i].riemann(is_draft ? 256 : 512);
  });
  context.check_stop();

  const std::array<Method, 4> methods = all_methods();
  std::vector<int> counts;
  for (int n = 4; n <= (is_draft ? 4096 : 16384); n *= 4) counts.push_back(n);
  Plot plot{
      .title = "Convergence of Riemann and Monte Carlo sums",
      .x = {.label = "directions N", .low = 4, .high = static_cast<double>(counts.back()), .scale = Scale::logarithmic},
      .y = {.label = "relative error, root mean square", .low = 1e-4, .high = 2, .scale = Scale::logarithmic},
      .height = 460};
  figure.table.head = {"", "slope"};
  for (const int n : counts) figure.table.head.push_back(fmt::format("N = {}", n));
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const Method& method = methods[m];
    std::vector<dvec2> errors = method_errors(context, method, points, truth, counts);
    const double slope = logarithmic_slope({errors.begin() + 1, errors.end()});
    std::vector<std::string> row{method.name, fmt::format("−{:.2f}", -slope)};
    for (const dvec2 e : errors) row.push_back(percent_text(e.y));
    figure.table.rows.push_back(std::move(row));
    plot.curves.push_back({.label = fmt::format("{}", method.name),
                           .points = std::move(errors),
                           .ink = categorical_ink(static_cast<int>(m)),
                           .stroke = method.stroke,
                           .has_markers = true});
  }
  figure.panels = {
      {"riemann-monte-carlo.svg", plot_svg(plot), "Relative error over the number of directions, both logarithmic"}};
  return figure;
}

Figure samples(FigureContext& context) {
  Figure figure;
  figure.text = {
      "One sample per pixel is right on average and wrong everywhere. Sixteen times as many quarter the error: the "
      "grain fades and nothing else changes. Looking for lights (next-event estimation, weighted against the "
      "material’s own samples) starts much lower than following the material alone, which finds a softbox by luck on "
      "rough balls."};
  figure.formulas = {"σ_N = \\frac{σ_1}{\\sqrt{N}}",
                     "L_o ≈ \\frac{1}{N} ∑_k \\frac{f L_i \\, \\op{cos} \\, θ_k}{p(l_k)}"};
  figure.sources = {"Veach & Guibas 1995, Optimally Combining Sampling Techniques for Monte Carlo Rendering",
                    "Kajiya 1986, The Rendering Equation"};
  figure.functions = {"path::render with path::Integrator"};
  figure.columns = 2;
  const Scene scene = content::make_demo("spheres");
  const Environment& studio = context.environment("studio");
  const View view = scene_camera(scene, "0", 16.0f / 9.0f);
  const DevelopSettings shown{.exposure = scene.preferred_exposure};
  path::Settings settings;
  settings.width = context.pixels(352);
  settings.height = context.pixels(198);
  settings.seed = 1;  // the samples of the others are not among those of the truth
  settings.samples = context.settings().reference;
  const Film truth = context.trace(scene, studio, view, settings);
  settings.seed = 0;

  Plot plot{.title = "Error over samples",
            .x = {.label = "samples per pixel N", .low = 1, .high = 64, .scale = Scale::logarithmic},
            .y = {.label = "relative RMS error", .low = 1e-2, .high = 2, .scale = Scale::logarithmic}};
  std::vector<Panel> pictures;
  for (const bool is_full : {false, true}) {
    settings.integrator = is_full ? path::Integrator::full : path::Integrator::minimal;
    std::vector<dvec2> errors;
    for (int n = 1; n <= 64; n *= 4) {
      settings.samples = n;
      const Film film = context.trace(scene, studio, view, settings);
      const double error = relative_error(film.beauty, truth.beauty);
      errors.emplace_back(n, error);
      if (!is_full && n != 4) continue;
      const char* name = is_full ? "full" : "minimal";
      pictures.push_back({fmt::format("samples-{}-{}.png", name, n), develop(film, shown),
                          fmt::format("N = {}, {}", n, is_full ? "looking for lights" : "following the material alone"),
                          "error " + percent_text(error)});
      figure.commands.push_back(
          fmt::format("candela render demo:spheres -o {0}-{1}.png --size {2}x{3} --spp {1} --integrator {0}", name, n,
                      settings.width, settings.height));
    }
    const double slope = logarithmic_slope(errors);
    plot.curves.push_back({.label = fmt::format("{}, −{:.2f}", is_full ? "full" : "minimal", -slope),
                           .points = std::move(errors),
                           .ink = categorical_ink(is_full ? 2 : 1),
                           .has_markers = true});
  }
  std::rotate(pictures.begin(), pictures.begin() + 1, pictures.end());
  pictures.push_back({"samples-reference.png", develop(truth, shown),
                      fmt::format("N = {}", context.settings().reference), "the measure of the others"});
  figure.panels = std::move(pictures);
  figure.panels.push_back(
      {"samples-error.svg", plot_svg(plot), "Error over samples, with the slope of each line", {}, {}, true});
  return figure;
}

}  // namespace

void add_integral_figures(std::vector<FigureInfo>& list) {
  list.push_back({"riemann-monte-carlo", "Riemann sum against Monte Carlo", Chapter::integrals, riemann_monte_carlo});
  list.push_back({"samples", "N samples against the converged answer", Chapter::integrals, samples});
}

}  // namespace candela::figures
