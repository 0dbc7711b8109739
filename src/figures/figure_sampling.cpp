#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "figures/figure.h"
#include "figures/plot.h"
#include "math/hash.h"
#include "math/sobol.h"
#include "shade/diffuse.glsl.h"

// Where samples fall: independent numbers against points of low discrepancy.

namespace candela::figures {
namespace {

constexpr int kPoints = 256;

std::vector<dvec2> random_points() {
  std::vector<dvec2> points;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const std::uint32_t key = hash_combine(7, i);
    points.emplace_back(unit_float(key), unit_float(hash(key)));
  }
  return points;
}

std::vector<dvec2> sobol_points() {
  std::vector<dvec2> points;
  for (std::uint32_t i = 0; i < kPoints; ++i) points.emplace_back(SobolSampler(7, i).next_2d());
  return points;
}

/// Hammersley’s: i/N and i with its bits behind the point.
std::vector<dvec2> hammersley_points() {
  std::vector<dvec2> points;
  for (int i = 0; i < kPoints; ++i) {
    double inverse = 0.0, digit = 0.5;
    for (int rest = i; rest > 0; rest /= 2, digit *= 0.5) inverse += (rest % 2) * digit;
    points.emplace_back((i + 0.5) / kPoints, inverse);
  }
  return points;
}

/// The largest difference, over boxes from the corner (0, 0), between the share of the points that is inside and the
/// area: the star discrepancy. Its largest value is at corners that points make.
double star_discrepancy(const std::vector<dvec2>& points) {
  const auto n = static_cast<double>(points.size());
  double most = 0.0;
  for (const dvec2 a : points) {
    for (const dvec2 b : points) {
      const dvec2 corner(a.x, b.y);
      int open = 0, closed = 0;
      for (const dvec2 p : points) {
        open += p.x < corner.x && p.y < corner.y ? 1 : 0;
        closed += p.x <= corner.x && p.y <= corner.y ? 1 : 0;
      }
      const double area = corner.x * corner.y;
      most = std::max({most, area - open / n, closed / n - area});
    }
  }
  return most;
}

/// Dots alone: a gap after each.
Curve dots(const std::vector<dvec2>& points, Ink ink) {
  Curve curve;
  curve.ink = ink;
  curve.has_markers = true;
  for (const dvec2 point : points) {
    curve.points.push_back(point);
    curve.points.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0.0);
  }
  return curve;
}

Figure points_figure(FigureContext&) {
  Figure figure;
  figure.text = {
      fmt::format(
          "{} points in the unit square, and the directions of cosine density that they become, seen from above "
          "the hemisphere. Independent numbers leave holes and clumps; points of low discrepancy have one in "
          "each small box, whatever its shape. Sobol’s, scrambled as Candela has them, are as even as "
          "Hammersley’s and as unpredictable as random ones, so that no pattern shows and every pixel can have "
          "its own.",
          kPoints),
      "The number below a square is its star discrepancy: the largest difference, over all boxes from the lower left "
      "corner, between the share of the points in it and its area. The error of a mean over such points is bounded by "
      "it times the function’s variation (Koksma and Hlawka)."};
  figure.formulas = {
      "L_o ≈ \\frac{1}{N} ∑_k \\frac{f L_i \\, \\op{cos} \\, θ_k}{p(l_k)} ; p(l) = \\frac{\\op{cos} \\, θ}{π}"};
  figure.sources = {"Niederreiter 1992, Random Number Generation and Quasi-Monte Carlo Methods",
                    "Owen 1995, Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences",
                    "Burley 2020, Practical Hash-based Owen Scrambling"};
  figure.functions = {"SobolSampler", "shade::cosine_sample"};
  figure.columns = 3;
  struct Named {
    const char* file;
    const char* caption;
    std::vector<dvec2> points;
  };
  const std::array<Named, 3> sets{{{"random", "independent numbers", random_points()},
                                   {"hammersley", "Hammersley", hammersley_points()},
                                   {"sobol", "Sobol’, Owen-scrambled", sobol_points()}}};
  constexpr int kSquare = 560;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const Plot plot{.title = sets[i].caption,
                    .x = {.label = "u₁"},
                    .y = {.label = "u₂"},
                    .curves = {dots(sets[i].points, categorical_ink(static_cast<int>(i)))},
                    .height = kSquare};
    figure.panels.push_back({fmt::format("points-{}.svg", sets[i].file), plot_svg(plot), sets[i].caption,
                             fmt::format("star discrepancy {:.3f}", star_discrepancy(sets[i].points))});
  }
  for (std::size_t i = 0; i < sets.size(); ++i) {
    std::vector<dvec2> seen;
    for (const dvec2 u : sets[i].points) seen.emplace_back(shade::cosine_sample(vec2(u)));
    const Plot plot{.title = std::string(sets[i].caption) + ", on the hemisphere",
                    .x = {.label = "x", .low = -1, .high = 1},
                    .y = {.label = "y", .low = -1, .high = 1},
                    .curves = {dots(seen, categorical_ink(static_cast<int>(i)))},
                    .height = kSquare};
    figure.panels.push_back(
        {fmt::format("points-{}-hemisphere.svg", sets[i].file), plot_svg(plot), "on the hemisphere, seen from above"});
  }
  return figure;
}

}  // namespace

void add_sampling_figures(std::vector<FigureInfo>& list) {
  list.push_back({"points", "Random and low-discrepancy points", Chapter::integrals, points_figure});
}

}  // namespace candela::figures
