#include "image/overlap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shade/cube.glsl.h"

namespace candela::overlap {
namespace {

constexpr double kPiD = std::numbers::pi;

/// A great circle as a function of azimuth: y = -sign · h cos ψ / √(n_y² + h² cos² ψ) with ψ = φ - crest.
struct GreatCircle {
  double h = 0.0;      ///< length of the normal's horizontal part, the normal being unit
  double up = 0.0;     ///< |n_y|
  double sign = 1.0;   ///< of n_y
  double crest = 0.0;  ///< azimuth where y is extreme

  explicit GreatCircle(dvec3 normal)
      : h(std::hypot(normal.x, normal.z)),
        up(std::abs(normal.y)),
        sign(normal.y < 0.0 ? -1.0 : 1.0),
        crest(std::atan2(normal.z, normal.x)) {}

  double y(double psi) const {
    const double c = h * std::cos(psi);
    return -sign * c / std::sqrt(up * up + c * c);
  }
  double antiderivative(double psi) const { return -sign * std::asin(std::clamp(h * std::sin(psi), -1.0, 1.0)); }
  /// |ψ| in [0, π] where the polar angle is `polar`.
  double crossing(double polar) const {
    return std::acos(std::clamp(-sign * up * std::cos(polar) / (h * std::sin(polar)), -1.0, 1.0));
  }
};

/// Where an arc is within one column: ψ from `begin` to `end`, both in [-π, 0] or both in [0, π].
struct Span {
  int column = 0;
  double begin = 0.0;
  double end = 0.0;
};

class Walker {
 public:
  Walker(const Lattice& lattice, const GreatCircle& circle, double direction,
         const std::function<void(const Piece&)>& visit)
      : lattice_(lattice), circle_(circle), direction_(direction), visit_(visit) {}

  void span(const Span& span) const {
    const double half = span.begin + span.end < 0.0 ? -1.0 : 1.0;
    const double row_begin = row_at(span.begin), row_end = row_at(span.end);
    int row = row_of(row_begin);
    const int last = row_of(row_end);
    const int step = last > row ? 1 : -1;
    double at = span.begin;
    for (; row != last; row += step) {
      const int edge = step > 0 ? row + 1 : row;
      const double psi = half * circle_.crossing(kPiD * edge / lattice_.height);
      const double next = std::clamp(psi, at, span.end);
      emit(span.column, row, at, next);
      at = next;
    }
    emit(span.column, row, at, span.end);
  }

 private:
  double row_at(double psi) const { return std::acos(std::clamp(circle_.y(psi), -1.0, 1.0)) / kPiD * lattice_.height; }
  int row_of(double v) const { return std::clamp(static_cast<int>(std::floor(v)), 0, lattice_.height - 1); }
  void emit(int column, int row, double begin, double end) const {
    if (!(end > begin)) return;
    visit_({column, row, direction_ * (end - begin),
            direction_ * (circle_.antiderivative(end) - circle_.antiderivative(begin))});
  }

  const Lattice& lattice_;
  const GreatCircle& circle_;
  double direction_;
  const std::function<void(const Piece&)>& visit_;
};

double wrapped(double angle) { return std::remainder(angle, 2.0 * kPiD); }

}  // namespace

void walk_arc(const Lattice& lattice, dvec3 a, dvec3 b, const std::function<void(const Piece&)>& visit) {
  constexpr double kMeridian = 1e-12;
  const dvec3 normal = glm::normalize(glm::cross(a, b));
  if (std::abs(normal.y) < kMeridian) return;
  const GreatCircle circle(normal);

  // ----- from the lesser azimuth to the greater
  double phi = std::atan2(a.z, a.x);
  double turn = wrapped(std::atan2(b.z, b.x) - phi);
  const double direction = turn < 0.0 ? -1.0 : 1.0;
  if (turn < 0.0) phi += turn;
  turn = std::abs(turn);

  const double cell = 2.0 * kPiD / lattice.width;
  const double start = (phi - lattice.azimuth) / cell;
  const double stop = start + turn / cell;
  const Walker walker(lattice, circle, direction, visit);
  for (double column = std::floor(start); column < stop; column += 1.0) {
    const double from = std::max(column, start), to = std::min(column + 1.0, stop);
    if (!(to > from)) continue;
    const double middle = wrapped(lattice.azimuth + 0.5 * (from + to) * cell - circle.crest);
    const double half = 0.5 * (to - from) * cell;
    const auto index = static_cast<int>(std::fmod(column, lattice.width));
    Span span{index < 0 ? index + lattice.width : index, middle - half, middle + half};
    // ----- the crest and the trough divide what rises from what falls
    for (const double extreme : {-kPiD, 0.0, kPiD}) {
      if (span.begin < extreme && extreme < span.end) {
        walker.span({span.column, span.begin, extreme});
        span.begin = extreme;
      }
    }
    walker.span(span);
  }
}

double row_edge(int row, int height) { return std::cos(kPiD * row / height); }

double texel_solid_angle(int row, int width, int height) {
  // cos a - cos b = 2 sin ½(a + b) sin ½(b - a), which does not cancel at the poles.
  return 2.0 * std::sin(kPiD * (row + 0.5) / height) * std::sin(0.5 * kPiD / height) * 2.0 * kPiD / width;
}

FaceAxes::FaceAxes(int face)
    : centre(shade::cube_direction(face, 0.0f, 0.0f)),
      right(dvec3(shade::cube_direction(face, 1.0f, 0.0f)) - centre),
      down(dvec3(shade::cube_direction(face, 0.0f, 1.0f)) - centre) {}

Ends edge_ends(const FaceAxes& axes, const Edge& e, int size) {
  const double s = 2.0 * e.x / size - 1.0, t = 2.0 * e.y / size - 1.0;
  const double step = 2.0 / size;
  return {glm::normalize(axes.at(s, t)), glm::normalize(e.down ? axes.at(s, t + step) : axes.at(s + step, t))};
}

}  // namespace candela::overlap
