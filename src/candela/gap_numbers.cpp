#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "candela/gap_parts.h"
#include "scene/surface_layers.h"

namespace candela {

Film trace_half(const path::Tracer& tracer, const View& view, path::Settings settings, const Job& job) {
  settings.layers = {Layer::material};
  path::Statistics statistics;
  Film film = tracer.render(view, settings, job, &statistics);
  if (statistics.interrupted) throw Interrupted("the comparison is not complete");
  return film;
}

std::vector<int> materials_seen(const Scene& scene, const Film& film) {
  std::map<int, int> by_number;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    by_number.emplace(number_of(scene.materials, i), static_cast<int>(i));
  }
  const Image& layer = film.layers.at(Layer::material);
  std::vector<int> seen(layer.pixels.size(), -1);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto found = by_number.find(static_cast<int>(layer.pixels[i]) - 1);
    if (found != by_number.end()) seen[i] = found->second;
  }
  return seen;
}

std::vector<GapPixel> weighted_pixels(const Image& truth, float exposure) {
  const double grey = 0.18 / static_cast<double>(exposure);
  std::vector<GapPixel> pixels(static_cast<std::size_t>(truth.width) * static_cast<std::size_t>(truth.height));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto l = static_cast<double>(luminance(pixel_of(truth, i)));
    pixels[i].weight = 1.0 / (3.0 * (l * l + grey * grey));
  }
  return pixels;
}

void find_numbers(const Scene& scene, const std::vector<GapPixel>& pixels, const std::vector<int>& materials,
                  const GapErrors& errors, const GapParts& parts, ViewGap& gap) {
  struct Sums {
    std::size_t pixels = 0;
    double flip = 0.0, squares = 0.0, noise = 0.0;
    dvec3 frame{0.0}, truth{0.0};
    std::array<double, kCauses> shares{};
  };
  std::map<int, Sums> all;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (const int key : {materials[i], -2}) {  // the latter of the whole
      Sums& s = all[key];
      const double w = pixels[i].weight;
      ++s.pixels;
      s.flip += static_cast<double>(gap.difference.error.pixels[i]);
      s.squares += w * dot(errors[0][i], errors[1][i]);
      const vec3 between = errors[0][i] - errors[1][i];
      s.noise += 0.25 * w * dot(between, between);
      s.frame += dvec3(pixel_of(gap.frame.beauty, i));
      s.truth += dvec3(pixel_of(gap.truth.beauty, i));
      for (std::size_t k = 0; k < kCauses && !parts[0].empty(); ++k) {
        s.shares[k] += 0.5 * w * (dot(parts[0][i][k], errors[1][i]) + dot(parts[1][i][k], errors[0][i]));
      }
    }
  }
  const auto numbers = [](const Sums& s) {
    const auto count = static_cast<double>(s.pixels);
    return GapNumbers{.pixels = s.pixels,
                      .flip = s.flip / count,
                      .relative_l2 = std::sqrt(std::max(s.squares, 0.0) / count),
                      .bias = vec3((s.frame - s.truth) / glm::max(s.truth, dvec3(1e-30)))};
  };
  gap.numbers = numbers(all.at(-2));
  const std::map<std::uint32_t, std::string> names = matte_names(scene, MatteKind::material);
  for (const auto& [material, sums] : all) {
    if (material == -2) continue;
    MaterialGap one{.name = {}, .numbers = numbers(sums), .largest = {}};
    if (material >= 0) {
      const auto found = names.find(static_cast<std::uint32_t>(material));
      one.name = found != names.end() ? found->second : fmt::format("material {}", material);
    }
    const auto largest = std::max_element(sums.shares.begin(), sums.shares.end());
    if (*largest != 0.0 && sums.squares > 0.2 * sums.noise && sums.squares > 0.0) {
      one.largest = kGapCauses[static_cast<std::size_t>(largest - sums.shares.begin())].cause;
      one.largest_share = *largest / sums.squares;
    }
    gap.materials.push_back(std::move(one));
  }
  std::stable_sort(gap.materials.begin(), gap.materials.end(),
                   [](const MaterialGap& a, const MaterialGap& b) { return a.numbers.pixels > b.numbers.pixels; });
}

}  // namespace candela
