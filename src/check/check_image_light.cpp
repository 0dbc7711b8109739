#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "check/check_parts.h"
#include "ibl/sh.h"

// EXT_lights_image_based says its light twice: as pictures of a cube, and as harmonics of irradiance. Viewers choose.
namespace candela::check {

namespace {

// RGBD in 8 bits and a cube of a few texels are off by less than 0.05; the sun of a clear sky, whose light no such
// picture holds, by 0.5.
constexpr double kMostDifference = 0.2;

/// Middles of a cube's faces, its corners and its edges, unit.
std::vector<dvec3> directions() {
  std::vector<dvec3> result;
  for (int i = 0; i < 27; ++i) {
    const dvec3 d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (d != dvec3(0.0)) result.push_back(glm::normalize(d));
  }
  return result;
}

/// Two sets of irradiance: how far they are apart, over the root mean square of the second, and what the first times
/// `scale`, which fits best, leaves of that.
struct Disagreement {
  double difference = 0.0;
  double scale = 1.0;
  double rest = 0.0;
};

Disagreement compare(const std::vector<dvec3>& said, const std::vector<dvec3>& shown) {
  double ss = 0.0, st = 0.0, tt = 0.0;
  for (std::size_t i = 0; i < said.size(); ++i) {
    ss += glm::dot(said[i], said[i]), st += glm::dot(said[i], shown[i]), tt += glm::dot(shown[i], shown[i]);
  }
  Disagreement result;
  if (!(tt > 0.0)) return result;
  result.difference = std::sqrt(std::max(0.0, (ss - 2.0 * st + tt) / tt));
  result.rest = result.difference;
  if (st > 0.0) {
    result.scale = st / ss;
    result.rest = std::sqrt(std::max(0.0, 1.0 - st * st / (ss * tt)));
  }
  return result;
}

std::vector<dvec3> evaluated(const ibl::Sh& sh, const std::vector<dvec3>& at) {
  std::vector<dvec3> result;
  result.reserve(at.size());
  for (const dvec3& direction : at) result.push_back(ibl::sh_evaluate(sh, direction));
  return result;
}

/// As near as it comes: writers damp the harmonics, or do not.
Disagreement least_disagreement(const FileSurvey::Irradiance& irradiance, const Environment& light) {
  ibl::Source source;
  source.map = *light.map;
  source.rotation = static_cast<double>(light.rotation);
  const ibl::Sh exact = ibl::sh_irradiance(ibl::sh_project(source, 2));
  const std::vector<dvec3> of_light = directions();
  std::vector<dvec3> of_world;
  of_world.reserve(of_light.size());
  for (const dvec3& direction : of_light) of_world.push_back(glm::dquat(irradiance.world_from_light) * direction);
  const std::vector<dvec3> said = evaluated({2, irradiance.coefficients}, of_light);
  Disagreement least = compare(said, evaluated(exact, of_world));
  for (const ibl::Window window : {ibl::Window::hann, ibl::Window::lanczos, ibl::Window::automatic}) {
    const Disagreement damped = compare(said, evaluated(ibl::sh_window(exact, window), of_world));
    if (damped.rest < least.rest) least = damped;
  }
  return least;
}

}  // namespace

void check_image_light(const CheckInput& input, std::vector<Finding>& findings) {
  if (input.survey == nullptr || !input.scene.image_light) return;
  const FileSurvey::Irradiance& irradiance = input.survey->irradiance;
  const ImageLight& light = *input.scene.image_light;
  if (irradiance.coefficients.empty() || light.environment.map == nullptr) return;
  const Disagreement found = least_disagreement(irradiance, light.environment);
  if (!(found.difference > kMostDifference)) return;
  Finding f;
  f.severity = Severity::warning;
  f.code = "irradiance-contradicts";
  f.subject = fmt::format("image-based light {}", light.file_index);
  f.measured = {{"difference", found.difference}, {"scale", found.scale}, {"difference_scaled", found.rest}};
  f.message = fmt::format(
      "irradianceCoefficients are off by {:.3g} of the light of the cube's pictures, which Candela draws by; others "
      "draw "
      "by the coefficients",
      found.difference);
  if (found.rest < kMostDifference) {
    f.message += fmt::format(". Times {:.3g} they are off by {:.2g}", found.scale, found.rest);
    f.fix = fmt::format("multiply them by {:.3g}", found.scale);
  }
  findings.push_back(std::move(f));
}

}  // namespace candela::check
