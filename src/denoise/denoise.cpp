#include "denoise/denoise.h"

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

bool denoise(Film& film, Method method, const Job& job) {
  CANDELA_CHECK(film.features.has_value());
  Job here = job;
  if (job.is_stopped()) here.stop = nullptr;
  Image clean;
  try {
    const StopScope scope(here.stop);
    clean = method == Method::oidn ? denoise_by_oidn(film, here) : regress(film, here);
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
  return true;
}

}  // namespace candela::denoise
