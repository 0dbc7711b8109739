#include "ibl/cube.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "image/overlap.h"
#include "shade/cube.glsl.h"

namespace candela::ibl {
namespace {

using overlap::Edge;
using overlap::edge_ends;
using overlap::edges_of_row;
using overlap::Ends;
using overlap::FaceAxes;
using overlap::Lattice;
using overlap::Piece;
using overlap::walk_arc;

constexpr double kPiD = std::numbers::pi;
constexpr int kFaces = 6;
constexpr int kBottom = 3;  ///< the face around the lower pole

Lattice lattice_of(const Source& source) { return {source.map.width, source.map.height, column_edge(source, 0)}; }

/// ∫ L dy from a pole to the edges of rows, by column.
class Cumulative {
 public:
  explicit Cumulative(const Source& source)
      : width_(static_cast<std::size_t>(source.map.width)), map_(source.map), sums_(width_ * rows_of(source)) {
    for (int y = 0; y < map_.height; ++y) {
      edges_.push_back(row_edge(y, map_.height));
      for (int x = 0; x < map_.width; ++x) {
        sums_[index(x, y + 1)] = sums_[index(x, y)] + dvec3(map_.rgb(x, y)) * row_height(y);
      }
    }
    edges_.push_back(row_edge(map_.height, map_.height));
  }

  /// ∫ C dφ over a piece, C counted from the upper pole.
  dvec3 from_top(const Piece& p) const {
    return sums_[index(p.column, p.row)] * p.turn + dvec3(map_.rgb(p.column, p.row)) * (top(p.row) * p.turn - p.area);
  }
  /// The same from the lower pole.
  dvec3 from_bottom(const Piece& p) const {
    const dvec3 below = sums_[index(p.column, map_.height)] - sums_[index(p.column, p.row + 1)];
    return below * p.turn + dvec3(map_.rgb(p.column, p.row)) * (p.area - top(p.row + 1) * p.turn);
  }

 private:
  static std::size_t rows_of(const Source& source) { return static_cast<std::size_t>(source.map.height) + 1; }
  double row_height(int y) const { return texel_solid_angle(y, map_.width, map_.height) * map_.width / (2.0 * kPiD); }
  double top(int row) const { return edges_[static_cast<std::size_t>(row)]; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x); }

  std::size_t width_;
  const Image& map_;
  std::vector<dvec3> sums_;
  std::vector<double> edges_;
};

/// Flux of every texel of a face: the circulation of C around it.
std::vector<dvec3> face_flux(const Cumulative& cumulative, const Lattice& lattice, int face, int size) {
  const FaceAxes axes(face);
  const auto n = static_cast<std::size_t>(size);
  std::vector<dvec3> right(n * (n + 1)), down((n + 1) * n);
  parallel_for(0, n + 1, 8, [&](std::size_t begin, std::size_t end) {
    dvec3 sum(0.0);
    const std::function<void(const Piece&)> visit = [&](const Piece& piece) {
      // From below the same circulation has the other sign.
      sum += face == kBottom ? -cumulative.from_bottom(piece) : cumulative.from_top(piece);
    };
    for (std::size_t y = begin; y < end; ++y) {
      edges_of_row(static_cast<int>(y), size, [&](const Edge& e) {
        const Ends ends = edge_ends(axes, e, size);
        sum = dvec3(0.0);
        walk_arc(lattice, ends.a, ends.b, visit);
        const auto x = static_cast<std::size_t>(e.x);
        (e.down ? down[y * (n + 1) + x] : right[y * n + x]) = sum;
      });
    }
  });
  std::vector<dvec3> flux(n * n);
  for (std::size_t y = 0; y < n; ++y) {
    for (std::size_t x = 0; x < n; ++x) {
      flux[y * n + x] = right[y * n + x] - right[(y + 1) * n + x] + down[y * (n + 1) + x + 1] - down[y * (n + 1) + x];
    }
  }
  return flux;
}

/// The disc in equal parts, each given to the texel it falls in.
void add_disc(const SunDisc& sun, std::array<std::vector<dvec3>, kFaces>& flux, int size) {
  constexpr int kRings = 64;
  constexpr int kAround = 128;
  const dvec3 n = glm::normalize(dvec3(sun.direction));
  const dvec3 t = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)));
  const dvec3 b = glm::cross(n, t);
  const dvec3 part = dvec3(sun.radiance) * (disc_solid_angle(sun) / (kRings * kAround));
  for (int i = 0; i < kRings; ++i) {
    const double angle = static_cast<double>(sun.angular_radius) * std::sqrt((i + 0.5) / kRings);
    for (int j = 0; j < kAround; ++j) {
      const double a = 2.0 * kPiD * (j + 0.5) / kAround;
      const dvec3 d = n * std::cos(angle) + (t * std::cos(a) + b * std::sin(a)) * std::sin(angle);
      const vec3 at = shade::cube_coordinates(vec3(d));
      const auto cell = [&](float s) {
        return std::clamp(static_cast<int>((static_cast<double>(s) + 1.0) * 0.5 * size), 0, size - 1);
      };
      const auto index =
          static_cast<std::size_t>(cell(at.z)) * static_cast<std::size_t>(size) + static_cast<std::size_t>(cell(at.y));
      flux[static_cast<std::size_t>(at.x)][index] += part;
    }
  }
}

}  // namespace

dvec3 cube_texel_direction(int face, int x, int y, int size) {
  return glm::normalize(FaceAxes(face).at((2.0 * x + 1.0) / size - 1.0, (2.0 * y + 1.0) / size - 1.0));
}

std::vector<dvec3> cube_directions(int size) {
  std::vector<dvec3> directions;
  directions.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * kFaces);
  for (int face = 0; face < kFaces; ++face) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) directions.push_back(cube_texel_direction(face, x, y, size));
    }
  }
  return directions;
}

CubeFaces cube_from_values(const std::vector<dvec3>& values, int size) {
  CubeFaces faces = make_cube_faces(size);
  std::size_t i = 0;
  for (Image& face : faces) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) face.set_rgb(x, y, vec3(values[i++]));
    }
  }
  return faces;
}

CubeFaces cube_from_source(const Source& source, int size) {
  const Cumulative cumulative(source);
  const Lattice lattice = lattice_of(source);
  std::array<std::vector<dvec3>, kFaces> flux;
  for (int face = 0; face < kFaces; ++face) {
    flux[static_cast<std::size_t>(face)] = face_flux(cumulative, lattice, face, size);
  }
  for (const SunDisc& sun : source.suns) add_disc(sun, flux, size);

  CubeFaces faces = make_cube_faces(size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double solid_angle = cube_texel_solid_angle(size, x, y);
      for (std::size_t face = 0; face < kFaces; ++face) {
        const dvec3 f =
            flux[face][static_cast<std::size_t>(y) * static_cast<std::size_t>(size) + static_cast<std::size_t>(x)];
        // What rounding leaves of a black texel may be below 0.
        faces[face].set_rgb(x, y, vec3(glm::max(f / solid_angle, dvec3(0.0))));
      }
    }
  }
  return faces;
}

Cubemap cube_mips(CubeFaces faces) {
  Cubemap cube;
  cube.levels.push_back(std::move(faces));
  while (cube.levels.back()[0].width > 1) {
    const CubeFaces& fine = cube.levels.back();
    const int size = fine[0].width / 2;
    if (size * 2 != fine[0].width) throw Error("the size of a face with mips is a power of two");
    CubeFaces coarse = make_cube_faces(size);
    for (std::size_t face = 0; face < kFaces; ++face) {
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          dvec3 flux(0.0);
          for (int k = 0; k < 4; ++k) {
            const int i = 2 * x + k % 2, j = 2 * y + k / 2;
            flux += dvec3(fine[face].rgb(i, j)) * cube_texel_solid_angle(2 * size, i, j);
          }
          coarse[face].set_rgb(x, y, vec3(flux / cube_texel_solid_angle(size, x, y)));
        }
      }
    }
    cube.levels.push_back(std::move(coarse));
  }
  return cube;
}

dvec3 total_flux(const CubeFaces& faces) {
  dvec3 sum(0.0);
  const int size = faces[0].width;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      dvec3 radiance(0.0);
      for (const Image& face : faces) radiance += dvec3(face.rgb(x, y));
      sum += radiance * cube_texel_solid_angle(size, x, y);
    }
  }
  return sum;
}

CubeTexel cube_neighbour(int face, int x, int y, int size) {
  // The middle of the texel's edge, a hair beyond it: there the other face begins.
  const double beyond = 1.0 + 1e-3 / size;
  const auto coordinate = [&](int i) {
    if (i < 0) return -beyond;
    return i >= size ? beyond : (2.0 * i + 1.0) / size - 1.0;
  };
  const vec3 at = shade::cube_coordinates(vec3(FaceAxes(face).at(coordinate(x), coordinate(y))));
  const auto cell = [&](float s) {
    return std::clamp(static_cast<int>((static_cast<double>(s) + 1.0) * 0.5 * size), 0, size - 1);
  };
  return {static_cast<int>(at.x), cell(at.y), cell(at.z)};
}

vec3 cube_lookup(const CubeFaces& faces, dvec3 direction) {
  const int size = faces[0].width;
  const vec3 at = shade::cube_coordinates(vec3(direction));
  const auto face = static_cast<int>(at.x);
  const float x = (at.y + 1.0f) * 0.5f * static_cast<float>(size) - 0.5f;
  const float y = (at.z + 1.0f) * 0.5f * static_cast<float>(size) - 0.5f;
  const auto left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  const float u = x - static_cast<float>(left), v = y - static_cast<float>(top);

  std::array<vec3, 4> taps{};
  int missing = -1;
  vec3 sum(0.0f);
  for (int k = 0; k < 4; ++k) {
    const int i = left + k % 2, j = top + k / 2;
    const bool off_x = i < 0 || i >= size, off_y = j < 0 || j >= size;
    if (off_x && off_y) {
      missing = k;
      continue;
    }
    const CubeTexel texel = off_x || off_y ? cube_neighbour(face, i, j, size) : CubeTexel{face, i, j};
    taps[static_cast<std::size_t>(k)] = faces[static_cast<std::size_t>(texel.face)].rgb(texel.x, texel.y);
    sum += taps[static_cast<std::size_t>(k)];
  }
  if (missing >= 0) taps[static_cast<std::size_t>(missing)] = sum / 3.0f;
  return glm::mix(glm::mix(taps[0], taps[1], u), glm::mix(taps[2], taps[3], u), v);
}

}  // namespace candela::ibl
