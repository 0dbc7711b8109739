#include "ibl/zonal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace candela::ibl {

void PointSum::add(const Point& point) {
  const std::size_t lane = count_++ % kLanes;
  if (lane == 0) blocks_.emplace_back();
  Block& block = blocks_.back();
  block.x[lane] = point.direction.x, block.y[lane] = point.direction.y, block.z[lane] = point.direction.z;
  for (int c = 0; c < 3; ++c) block.flux[c][lane] = point.flux[c];
}

dvec3 PointSum::sum(const Kernel& kernel, dvec3 d) const {
  const double a2 = kernel.alpha() * kernel.alpha(), slope = kernel.slope(), scale = kernel.scale();
  const bool is_charlie = kernel.lobe() == Lobe::charlie;
  Lanes sums[3] = {};
  for (const Block& block : blocks_) {
    const Lanes x = block.x - d.x, y = block.y - d.y, z = block.z - d.z;
    Lanes k = 0.5 * (x * x + y * y + z * z);
    if (is_charlie) {
      for (std::size_t i = 0; i < kLanes; ++i) k[i] = kernel(k[i]);
    } else {
      const Lanes c = 1.0 - k, width = a2 + slope * k;
      k = scale * (c > 0.0 ? c : c - c) / (width * width);
    }
    for (std::size_t i = 0; i < 3; ++i) sums[i] += k * block.flux[i];
  }
  dvec3 total(0.0);
  for (int i = 0; i < 3; ++i) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) total[i] += sums[i][lane];
  }
  return total;
}

BrightSplit split_bright(const Source& source, int most) {
  // A texel with less than this share of all light, or hardly brighter than the mean, is told well by a series.
  constexpr double kLeastShare = 1e-5;
  constexpr double kContrast = 8.0;
  const int width = source.map.width, height = source.map.height;
  std::vector<double> flux;
  flux.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  double total = 0.0;
  for (int y = 0; y < height; ++y) {
    const double solid_angle = texel_solid_angle(y, width, height);
    for (int x = 0; x < width; ++x) {
      const vec3 v = source.map.rgb(x, y);
      flux.push_back((static_cast<double>(v.x) + static_cast<double>(v.y) + static_cast<double>(v.z)) * solid_angle);
      total += flux.back();
    }
  }
  std::vector<double> order = flux;
  const std::size_t rank = std::min(static_cast<std::size_t>(most), order.size() - 1);
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(rank), order.end(), std::greater<>());
  const double limit =
      std::max(order[rank], std::max(kLeastShare, kContrast / static_cast<double>(order.size())) * total);

  BrightSplit split{source.map, {}, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double f =
          flux[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      if (f <= limit) continue;
      const vec3 all = source.map.rgb(x, y);
      const vec3 left = all * static_cast<float>(limit / f);
      split.rest.set_rgb(x, y, left);
      split.texels.emplace_back(x, y);
      split.flux.push_back((dvec3(all) - dvec3(left)) * texel_solid_angle(y, width, height));
    }
  }
  return split;
}

namespace {

/// Degrees × row above which two Gauss points per row no longer do.
constexpr double kMostPhase = 2.0;

}  // namespace

ZonalFilter::ZonalFilter(const Source& source, int lmax, int exact_texels)
    : ZonalFilter(source, split_bright(source, exact_texels), lmax) {}

ZonalFilter::ZonalFilter(const Source& source, const BrightSplit& split, int lmax)
    : harmonics_(analyse(subdivided(split.rest, kMostPhase / lmax), column_edge(source, 0), lmax)),
      texel_(std::numbers::pi / source.map.height) {
  for (std::size_t i = 0; i < split.texels.size(); ++i) {
    for (const Point& p : texel_points(source, split.texels[i].x, split.texels[i].y, split.flux[i], 1)) middles_.add(p);
    for (const Point& p : texel_points(source, split.texels[i].x, split.texels[i].y, split.flux[i], 2)) {
      quarters_.add(p);
    }
  }
  for (const SunDisc& sun : source.suns) {
    for (const Point& p : disc_points(sun)) middles_.add(p), quarters_.add(p);
  }
}

const PointSum& ZonalFilter::points_for(const Kernel& kernel) const {
  constexpr double kWide = 24.0;  // texels per lobe width above which a texel is a point: errs by 1 / (6 · 24²)
  return kernel.width() > kWide * texel_ ? middles_ : quarters_;
}

std::vector<dvec3> ZonalFilter::at(const Kernel& kernel, int lmax, const std::vector<dvec3>& directions) const {
  const SphereGrid grid(harmonics_, kernel.coefficients(std::min(lmax, harmonics_.lmax())));
  const PointSum& points = points_for(kernel);
  std::vector<dvec3> values(directions.size());
  parallel_for(0, directions.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // A series may undershoot where there is no light.
      values[i] = glm::max(grid.at(directions[i]), dvec3(0.0)) + points.sum(kernel, directions[i]);
    }
  });
  return values;
}

}  // namespace candela::ibl
