#include "denoise/denoise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "denoise/oidn.h"
#include "denoise/regression.h"

namespace candela::denoise {

Method parse_method(std::string_view name) {
  for (const Method method : {Method::regression, Method::oidn}) {
    if (name == method_name(method)) return method;
  }
  throw Error("unknown way to denoise \"" + std::string(name) + "\" (known: regression, oidn)");
}

std::string_view method_name(Method method) { return method == Method::oidn ? "oidn" : "regression"; }

std::string why_not(Method method) { return method == Method::oidn ? why_no_oidn() : std::string(); }

namespace {

Image without_noise(const Film& film, Method method, const Job& job) {
  return method == Method::oidn ? denoise_by_oidn(film, job) : regress(film, job);
}

/// What shows through a film, as light of a white world of the same shapes.
Film film_of_through(const Film& film) {
  Film result;
  result.beauty = film.through;
  for (std::size_t i = 3; i < result.beauty.pixels.size(); i += 4) result.beauty.pixels[i] = 1.0f;
  DenoisingFeatures& features = result.features.emplace(*film.features);
  std::fill(features.albedo.pixels.begin(), features.albedo.pixels.end(), 1.0f);
  std::fill(features.albedo_variance.pixels.begin(), features.albedo_variance.pixels.end(), 0.0f);
  std::fill(features.seen.pixels.begin(), features.seen.pixels.end(), 0.0f);
  features.variance = std::exchange(features.through_variance, Image());
  return result;
}

/// Puts `clean` in place of what shows through, where that has noise.
void replace_through(const Image& clean, Film& film) {
  Image through = std::move(film.through);
  const Image& variance = film.features->through_variance;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      const vec3 color = clean.rgb(x, y);
      if (is_finite(color) && variance.at(x, y)[0] > 0.0f) through.set_rgb(x, y, glm::max(color, vec3(0.0f)));
    }
  }
  set_through(std::move(through), film);
}

}  // namespace

bool denoise(Film& film, Method method, const Job& job) {
  CANDELA_CHECK(film.features.has_value());
  Job here = job;
  if (job.is_stopped()) here.stop = nullptr;
  const bool has_through = !film.features->through_variance.empty() && !film.through.empty();
  Image clean, clean_through;
  try {
    const StopScope scope(here.stop);
    const JobParts parts(here, has_through ? 2 : 1);
    clean = without_noise(film, method, parts.part(0));
    if (has_through) clean_through = without_noise(film_of_through(film), method, parts.part(1));
  } catch (const Interrupted&) {
    return false;
  }
  film.noisy = film.beauty;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      const vec3 color = clean.rgb(x, y);
      // Where nothing is but a transparent background, no light may spread to.
      const bool is_empty = film.beauty.at(x, y)[3] == 0.0f && max_component(film.beauty.rgb(x, y)) <= 0.0f;
      if (is_finite(color) && !is_empty) film.beauty.set_rgb(x, y, color);
    }
  }
  if (has_through) replace_through(clean_through, film);
  return true;
}

}  // namespace candela::denoise
