#include "ibl/prefilter.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/check.h"
#include "base/parallel.h"
#include "ibl/cube.h"
#include "ibl/sampling.h"
#include "ibl/tree.h"
#include "ibl/zonal.h"

namespace candela::ibl {
namespace {

/// Degrees that the kink of every lobe at its horizon wants, and the most whose tables are affordable.
constexpr int kLeastDegree = 192;
constexpr int kMostDegree = 1024;
/// Below this width a series of kMostDegree terms is cut where it still counts: e^(-2αl) is 1e-6.
constexpr double kLeastAlpha = 0.007;

int degree_for(const Kernel& kernel, double scale) {
  constexpr double kMostRefined = 1536.0;  // 200 MB of grid
  const double wanted = std::min(std::max(kernel.bandwidth(), kLeastDegree), kMostDegree) * scale;
  return static_cast<int>(std::min(wanted, kMostRefined));
}

}  // namespace

struct Prefilter::Parts {
  const Source& source;
  PrefilterSettings settings;
  std::optional<ZonalFilter> zonal;
  std::optional<TexelTree> tree;
  std::optional<FilteredFilter> filtered;
};

Prefilter::Prefilter(const Source& source, const std::vector<Kernel>& kernels, const PrefilterSettings& settings)
    : parts_(new Parts{source, settings, {}, {}, {}}) {
  int degree = 0;
  bool wants_tree = false;
  for (const Kernel& kernel : kernels) {
    const Method method = method_for(kernel);
    if (method == Method::zonal) degree = std::max(degree, degree_for(kernel, settings.bandwidth_scale));
    wants_tree |= method == Method::hierarchical;
  }
  if (degree > 0) parts_->zonal.emplace(source, degree, settings.exact_texels);
  if (wants_tree) parts_->tree.emplace(source);
  if (settings.method == Method::fis) parts_->filtered.emplace(source, settings.fis_size, settings.samples);
}

Prefilter::~Prefilter() = default;

Method Prefilter::method_for(const Kernel& kernel) const {
  if (parts_->settings.method != Method::automatic) return parts_->settings.method;
  const bool is_narrow = kernel.lobe() == Lobe::ggx && kernel.alpha() < kLeastAlpha;
  return is_narrow ? Method::hierarchical : Method::zonal;
}

std::vector<dvec3> Prefilter::at(const Kernel& kernel, const std::vector<dvec3>& directions) const {
  const PrefilterSettings& settings = parts_->settings;
  const Method method = method_for(kernel);
  if (method == Method::zonal) {
    CANDELA_CHECK(parts_->zonal.has_value());
    return parts_->zonal->at(kernel, degree_for(kernel, settings.bandwidth_scale), directions);
  }
  std::vector<dvec3> values(directions.size());
  const MonteCarloFilter monte_carlo(parts_->source, settings.samples, settings.seed);
  parallel_for(0, directions.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (method == Method::hierarchical) {
        values[i] = parts_->tree->sum(kernel, directions[i], settings.tolerance);
      } else if (method == Method::fis) {
        values[i] = parts_->filtered->sum(kernel, directions[i]);
      } else {
        values[i] = monte_carlo.sum(kernel, directions[i], static_cast<std::uint32_t>(i));
      }
    }
  });
  return values;
}

CubeFaces Prefilter::faces(const Kernel& kernel, int size) const {
  return cube_from_values(at(kernel, cube_directions(size)), size);
}

std::vector<double> level_roughness(Mapping mapping, int levels) {
  std::vector<double> roughness;
  for (int level = 0; level < levels; ++level) {
    const double x = levels > 1 ? static_cast<double>(level) / (levels - 1) : 0.0;
    if (mapping == Mapping::balanced) {
      roughness.push_back(level == 0 ? 0.0 : std::exp2(-0.5 * (levels - 1 - level)));
    } else {
      roughness.push_back(mapping == Mapping::linear ? x : 1.0 - std::sqrt(1.0 - x));
    }
  }
  return roughness;
}

}  // namespace candela::ibl
