#include "ibl/bake.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "base/error.h"
#include "base/parallel.h"
#include "ibl/cube.h"

namespace candela::ibl {
namespace {

constexpr int kMostRefinements = 4;

void check(const BakeSettings& s) {
  if (s.levels < 1 || s.size < 1 || (s.size >> (s.levels - 1)) < 1 || s.size % (1 << (s.levels - 1)) != 0) {
    throw Error(std::to_string(s.levels) + " levels do not halve a face of " + std::to_string(s.size) +
                " texels without rest");
  }
  if (!s.roughness.empty() && s.roughness.size() != static_cast<std::size_t>(s.levels)) {
    throw Error("each level needs one roughness");
  }
}

/// More of what makes each method better.
PrefilterSettings refined(PrefilterSettings s) {
  s.bandwidth_scale *= 1.5;
  constexpr int kMostExact = 1 << 14;
  s.exact_texels = std::min(s.exact_texels * 4, kMostExact);
  s.tolerance *= 0.25;
  s.samples *= 4;
  return s;
}

std::string number(double v) {
  std::ostringstream text;
  text.precision(3);
  text << v;
  return text.str();
}

class Baker {
 public:
  Baker(const Source& source, const BakeSettings& settings, const Job& job)
      : source_(source), settings_(settings), job_(job), steps_((settings.sheen ? 2 : 1) * settings.levels + 2) {}

  /// One cube of levels. The roughness-0 level is the environment itself, which a mirror shows.
  void levels(Lobe lobe, const std::vector<double>& roughness, Cubemap& cube, std::vector<Level>& levels) const {
    std::vector<Kernel> kernels;
    for (const double r : roughness) {
      if (r > 0.0) kernels.emplace_back(lobe, r);
    }
    const Prefilter prefilter(source_, kernels, settings_.specular);
    std::size_t next = 0;
    for (std::size_t i = 0; i < roughness.size(); ++i) {
      Level level;
      level.roughness = roughness[i];
      const int size = settings_.size >> i;
      if (!(roughness[i] > 0.0)) {
        tell("converting");
        cube.levels.push_back(cube_from_source(source_, size));
        levels.push_back(level);
        continue;
      }
      const Kernel& kernel = kernels[next++];
      tell("prefiltering roughness " + number(roughness[i]));
      level.method = prefilter.method_for(kernel);
      CubeFaces faces = prefilter.faces(kernel, size);
      prove(kernel, faces, level, static_cast<std::uint32_t>(i),
            [&](const PrefilterSettings& better) { return Prefilter(source_, {kernel}, better).faces(kernel, size); });
      cube.levels.push_back(std::move(faces));
      levels.push_back(level);
    }
  }

  void irradiance(Bake& bake) const {
    tell("irradiance");
    const BakeSettings& s = settings_;
    bake.irradiance =
        irradiance_cube(source_, s.irradiance_size, s.irradiance_method, s.irradiance_samples, s.specular.seed);
    Level& level = bake.irradiance_level;
    level.roughness = 1.0;
    constexpr std::uint32_t kSeed = 100;
    const Kernel cosine(Lobe::cosine, 1.0);
    level.proof = verify_level(source_, cosine, bake.irradiance, s.proof_directions, kSeed, std::numbers::pi);
    int samples = s.irradiance_samples;
    while (is_too_wrong(level) && s.irradiance_method != IrradianceMethod::exact &&
           level.refinements < kMostRefinements) {
      samples *= 4;
      ++level.refinements;
      bake.irradiance = irradiance_cube(source_, s.irradiance_size, s.irradiance_method, samples, s.specular.seed);
      level.proof = verify_level(source_, cosine, bake.irradiance, s.proof_directions, kSeed, std::numbers::pi);
    }
    level.holds = !is_too_wrong(level);
  }

  void harmonics(Bake& bake) const {
    tell("spherical harmonics");
    bake.sh_radiance = sh_project(source_, settings_.sh_order);
    const Sh irradiance = sh_irradiance(bake.sh_radiance);
    bake.sh = sh_window(irradiance, settings_.window, &bake.sh_window_width);
    if (bake.sh_window_width > 0.0) {
      const Window window = settings_.window == Window::hann ? Window::hann : Window::lanczos;
      bake.sh_radiance = sh_damped(bake.sh_radiance, window, bake.sh_window_width);
    }
    constexpr std::uint32_t kSeed = 200;
    const std::vector<dvec3> directions = random_directions(settings_.proof_directions, kSeed);
    std::vector<dvec3> values, exact = reference(source_, Kernel(Lobe::cosine, 1.0), directions);
    for (dvec3& v : exact) v *= std::numbers::pi;
    for (const dvec3& d : directions) values.push_back(sh_evaluate(bake.sh, d));
    bake.sh_error = compare(values, exact, directions);
  }

 private:
  bool is_too_wrong(const Level& level) const {
    return settings_.error > 0.0 && level.proof.at_texels.max > settings_.error;
  }

  template <class Again>
  void prove(const Kernel& kernel, CubeFaces& faces, Level& level, std::uint32_t seed, const Again& again) const {
    if (settings_.proof_directions == 0) return;
    level.proof = verify_level(source_, kernel, faces, settings_.proof_directions, seed);
    PrefilterSettings better = settings_.specular;
    while (is_too_wrong(level) && level.refinements < kMostRefinements) {
      better = refined(better);
      ++level.refinements;
      tell("refining roughness " + number(level.roughness), false);
      faces = again(better);
      level.proof = verify_level(source_, kernel, faces, settings_.proof_directions, seed);
    }
    level.holds = !is_too_wrong(level);
  }

  /// What begins, a step unless it is one more attempt at the last.
  void tell(const std::string& what, bool is_step = true) const {
    StopScope::check();
    if (is_step) ++step_;
    job_.report({.fraction = static_cast<double>(step_ - 1) / steps_, .seconds = watch_.seconds(), .what = what});
  }

  const Source& source_;
  const BakeSettings& settings_;
  const Job& job_;
  Stopwatch watch_;
  int steps_;
  mutable int step_ = 0;
};

}  // namespace

Bake bake(const Source& source, const BakeSettings& settings, const Job& job) {
  check(settings);
  const StopScope scope(job.stop);
  const std::vector<double> roughness =
      settings.roughness.empty() ? level_roughness(settings.mapping, settings.levels) : settings.roughness;
  Bake bake;
  bake.flux_in = total_flux(source);
  const Baker baker(source, settings, job);
  baker.levels(Lobe::ggx, roughness, bake.specular, bake.levels);
  if (settings.sheen) baker.levels(Lobe::charlie, roughness, bake.sheen, bake.sheen_levels);
  bake.flux_out = total_flux(roughness[0] > 0.0 ? cube_from_source(source, settings.size) : bake.specular.levels[0]);
  baker.irradiance(bake);
  baker.harmonics(bake);
  return bake;
}

}  // namespace candela::ibl
