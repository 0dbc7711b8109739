#include "ibl/verify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "ibl/cube.h"
#include "math/hash.h"

namespace candela::ibl {
namespace {

constexpr double kPiD = std::numbers::pi;

/// Texels of a row taken together: eight vectors of four, and a stretch that lies below the horizon is skipped whole.
constexpr std::size_t kRun = 32;

/// Columns of Gauss points, planar so that the inner loop is plain arithmetic, filled up to whole runs.
struct Columns {
  std::vector<double> cosine, sine;  ///< of the azimuth
  std::size_t stride;                ///< columns of one Gauss point

  Columns(const Source& source, int side) : stride(rounded_up(source.map.width)) {
    const double offset = side == 2 ? 0.5 / std::sqrt(3.0) : 0.0;
    for (int k = 0; k < side; ++k) {
      for (std::size_t x = 0; x < stride; ++x) {
        const int column = std::min(static_cast<int>(x), source.map.width - 1);
        const double place = 0.5 + (k == 0 ? -offset : offset);
        const double azimuth = column_edge(source, column) + place * 2.0 * kPiD / source.map.width;
        cosine.push_back(std::cos(azimuth));
        sine.push_back(std::sin(azimuth));
      }
    }
  }

  static std::size_t rounded_up(int width) { return (static_cast<std::size_t>(width) + kRun - 1) / kRun * kRun; }
};

/// The map as three planes, rows at the Gauss points in polar angle with their share of the solid angle.
class BruteForce {
 public:
  BruteForce(const Source& source, const Kernel& kernel)
      : source_(source), kernel_(kernel), side_(side_for(source, kernel)), columns_(source, side_) {
    for (std::size_t c = 0; c < 3; ++c) {
      // What fills a row up is black.
      planes_[c].resize(columns_.stride * static_cast<std::size_t>(source.map.height));
      for (int y = 0; y < source.map.height; ++y) {
        double* row = planes_[c].data() + columns_.stride * static_cast<std::size_t>(y);
        for (int x = 0; x < source.map.width; ++x) {
          row[x] = static_cast<double>(source.map.rgb(x, y)[static_cast<int>(c)]);
        }
      }
    }
    for (const SunDisc& sun : source.suns) {
      for (const Point& p : disc_points(sun)) points_.push_back(p);
    }
  }

  dvec3 at(dvec3 d) const {
    // cos of the angle to a texel: y part of the row + horizontal part of the column × sine of the row.
    std::vector<double> horizontal(columns_.cosine.size());
    for (std::size_t i = 0; i < horizontal.size(); ++i) {
      horizontal[i] = d.x * columns_.cosine[i] + d.z * columns_.sine[i];
    }
    std::vector<double> highest;  // horizontal part in each run
    for (std::size_t i = 0; i < horizontal.size(); i += kRun) {
      const auto run = horizontal.begin() + static_cast<std::ptrdiff_t>(i);
      highest.push_back(*std::max_element(run, run + kRun));
    }
    dvec3 sum(0.0);
    for (int row = 0; row < source_.map.height; ++row) {
      dvec3 row_sum(0.0);
      for (int k = 0; k < side_; ++k) {
        const double step = kPiD / source_.map.height;
        const double half = side_ == 2 ? 0.5 * step / std::sqrt(3.0) : 0.0;
        const double polar = (row + 0.5) * step + (k == 0 ? -half : half);
        const double share = std::sin(polar) / (side_ == 2 ? 2.0 * std::sin((row + 0.5) * step) * std::cos(half)
                                                           : std::sin((row + 0.5) * step));
        row_sum += share / side_ * row_at(d.y * std::cos(polar), std::sin(polar), horizontal, highest, row);
      }
      sum += row_sum * texel_solid_angle(row, source_.map.width, source_.map.height);
    }
    for (const Point& p : points_) {
      const dvec3 chord = p.direction - d;
      sum += p.flux * kernel_(0.5 * glm::dot(chord, chord));
    }
    return sum;
  }

 private:
  static int side_for(const Source& source, const Kernel& kernel) {
    constexpr double kWide = 32.0;
    return kernel.width() > kWide * kPiD / source.map.height ? 1 : 2;
  }

  /// Σ kernel × radiance over a row whose texels stand at cosines y + sine × horizontal to the direction.
  dvec3 row_at(double y, double sine, const std::vector<double>& horizontal, const std::vector<double>& highest,
               int row) const {
    const std::size_t first = columns_.stride * static_cast<std::size_t>(row);
    double sums[3][kLanes] = {};
    for (std::size_t run = 0; run < highest.size(); ++run) {
      if (y + sine * highest[run] <= 0.0) continue;
      double weights[kRun];
      weigh(y, sine, horizontal.data() + run * kRun, weights);
      const std::size_t column = run * kRun % columns_.stride;
      for (std::size_t c = 0; c < 3; ++c) {
        const double* plane = planes_[c].data() + first + column;
        for (std::size_t x = 0; x < kRun; x += kLanes) {
          for (std::size_t i = 0; i < kLanes; ++i) sums[c][i] += weights[x + i] * plane[x + i];
        }
      }
    }
    dvec3 result(0.0);
    for (std::size_t c = 0; c < 3; ++c) {
      for (const double lane : sums[c]) result[static_cast<int>(c)] += lane;
    }
    return result;
  }

  void weigh(double y, double sine, const double* horizontal, double (&weights)[kRun]) const {
    if (kernel_.lobe() == Lobe::charlie) {
      for (std::size_t i = 0; i < kRun; ++i) weights[i] = kernel_(1.0 - (y + sine * horizontal[i]));
      return;
    }
    const double a2 = kernel_.alpha() * kernel_.alpha(), slope = kernel_.slope(), scale = kernel_.scale();
    for (std::size_t i = 0; i < kRun; ++i) {
      const double c = y + sine * horizontal[i];
      const double width = a2 + slope * (1.0 - c);
      weights[i] = scale * std::max(c, 0.0) / (width * width);
    }
  }

  static constexpr std::size_t kLanes = 8;

  const Source& source_;
  const Kernel& kernel_;
  int side_;
  Columns columns_;
  std::array<std::vector<double>, 3> planes_;
  std::vector<Point> points_;
};

}  // namespace

std::vector<dvec3> reference(const Source& source, const Kernel& kernel, const std::vector<dvec3>& directions) {
  // Four points stand for a texel where it is no larger than a quarter of the lobe's width.
  constexpr double kShare = 0.25;
  const Source fine{subdivided(source.map, kShare * kernel.width()), source.rotation, source.suns};
  const BruteForce brute_force(fine, kernel);
  std::vector<dvec3> values(directions.size());
  parallel_for(0, directions.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) values[i] = brute_force.at(directions[i]);
  });
  return values;
}

ErrorBound compare(const std::vector<dvec3>& values, const std::vector<dvec3>& references,
                   const std::vector<dvec3>& directions) {
  ErrorBound bound;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double size = glm::length(references[i]);
    const double difference = glm::length(values[i] - references[i]);
    // Where nothing arrives nothing must be said to arrive.
    const double error = size > 0.0 ? difference / size : (difference > 0.0 ? 1.0 : 0.0);
    squares += error * error;
    if (error > bound.max) bound.max = error, bound.worst = directions[i];
  }
  bound.directions = static_cast<int>(values.size());
  if (values.empty()) return bound;
  bound.rms = std::sqrt(squares / static_cast<double>(values.size()));
  bound.exceeding = 1.0 - std::pow(1.0 - bound.confidence, 1.0 / static_cast<double>(values.size()));
  return bound;
}

std::vector<dvec3> random_directions(int count, std::uint32_t seed) {
  std::vector<dvec3> directions;
  directions.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const std::uint32_t h = hash_combine(seed, static_cast<std::uint32_t>(i));
    const double y = 1.0 - 2.0 * static_cast<double>(unit_float(h));
    const double azimuth = 2.0 * kPiD * static_cast<double>(unit_float(hash_combine(h, 1)));
    const double r = std::sqrt(std::max(1.0 - y * y, 0.0));
    directions.emplace_back(r * std::cos(azimuth), y, r * std::sin(azimuth));
  }
  return directions;
}

LevelProof verify_level(const Source& source, const Kernel& kernel, const CubeFaces& faces, int directions,
                        std::uint32_t seed, double scale) {
  const int size = faces[0].width;
  const auto texels = static_cast<std::uint32_t>(6 * size * size);
  std::vector<dvec3> places = random_directions(directions, seed);
  std::vector<dvec3> values;
  values.reserve(2 * places.size());
  for (const dvec3& d : places) values.emplace_back(cube_lookup(faces, d));
  for (int i = 0; i < directions; ++i) {
    const std::uint32_t texel = hash_combine(seed + 1, static_cast<std::uint32_t>(i)) % texels;
    const auto index = static_cast<int>(texel);
    const int face = index / (size * size), y = index / size % size, x = index % size;
    places.push_back(cube_texel_direction(face, x, y, size));
    values.emplace_back(faces[static_cast<std::size_t>(face)].rgb(x, y));
  }
  std::vector<dvec3> exact = reference(source, kernel, places);
  for (dvec3& v : exact) v *= scale;
  const auto half = [&](const std::vector<dvec3>& all, bool second) {
    const auto middle = all.begin() + directions;
    return second ? std::vector<dvec3>(middle, all.end()) : std::vector<dvec3>(all.begin(), middle);
  };
  return {compare(half(values, true), half(exact, true), half(places, true)),
          compare(half(values, false), half(exact, false), half(places, false))};
}

}  // namespace candela::ibl
