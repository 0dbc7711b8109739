#include "image/cube_panorama.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "base/check.h"
#include "base/parallel.h"
#include "image/overlap.h"
#include "shade/cube.glsl.h"

namespace candela {

namespace {

using overlap::Edge;
using overlap::Ends;
using overlap::FaceAxes;
using overlap::Lattice;
using overlap::Piece;

constexpr int kFaces = 6;
constexpr int kBottom = 3;  ///< the face around the lower pole

struct Tap {
  int index;
  float weight;
};
using Taps = std::vector<Tap>;

/// ∫ of a tent of height 1 over [-1, 1], from its left foot to `x`.
double tent_integral(double x) {
  x = std::clamp(x, -1.0, 1.0);
  return x < 0.0 ? 0.5 * (x + 1.0) * (x + 1.0) : 1.0 - 0.5 * (1.0 - x) * (1.0 - x);
}

/// The integral over [begin, end] of [0, 1], times `scale`, of the line through `count` values at equal distances from
/// 0 to 1: how much of each.
void add_taps(double begin, double end, int count, double scale, Taps& taps) {
  if (count == 1) {
    taps.push_back({0, static_cast<float>((end - begin) * scale)});
    return;
  }
  const double a = begin * (count - 1), b = end * (count - 1);
  const int first = std::max(static_cast<int>(std::floor(a)), 0);
  const int last = std::min(static_cast<int>(std::ceil(b)), count - 1);
  for (int i = first; i <= last; ++i) {
    const double weight = (tent_integral(b - i) - tent_integral(a - i)) * scale / (count - 1);
    if (weight > 0.0) taps.push_back({i, static_cast<float>(weight)});
  }
}

/// Those of each of `count` equal parts of [0, 1], turned by `turn` of the whole.
std::vector<Taps> taps_of_parts(int count, double turn) {
  std::vector<Taps> parts(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    double begin = static_cast<double>(i) / count - turn;
    begin -= std::floor(begin);
    const double end = begin + 1.0 / count;
    Taps& taps = parts[static_cast<std::size_t>(i)];
    add_taps(begin, std::min(end, 1.0), count, count, taps);
    if (turn != 0.0 && end > 1.0 + 1e-9) add_taps(0.0, end - 1.0, count, count, taps);
  }
  return parts;
}

/// image(left + x taps, top + y taps), each product of two weights.
vec3 gather(const Image& image, int top, const Taps& x, const Taps& y) {
  vec3 sum(0.0f);
  for (const Tap& row : y)
    for (const Tap& column : x) sum += row.weight * column.weight * image.rgb(column.index, top + row.index);
  return sum;
}

}  // namespace

Image equirect_from_cube(const CubeFaces& faces, int width) {
  CANDELA_CHECK(width >= 2 && width % 2 == 0);
  Image map(width, width / 2, 3);
  const Lattice lattice{map.width, map.height, -std::numbers::pi};
  const auto columns = static_cast<std::size_t>(width);
  const auto rows = static_cast<std::size_t>(width / 2);
  const int size = faces[0].width;
  // Flux of cells that an edge crosses, and per cell what every row above it, or below it, has in full.
  std::vector<dvec3> partial(columns * rows), above(columns * rows), below(columns * rows);
  for (int face = 0; face < kFaces; ++face) {
    const FaceAxes axes(face);
    const Image& image = faces[static_cast<std::size_t>(face)];
    dvec3 step(0.0);  // of radiance across the edge
    const std::function<void(const Piece&)> visit = [&](const Piece& p) {
      const std::size_t i = static_cast<std::size_t>(p.row) * columns + static_cast<std::size_t>(p.column);
      if (face == kBottom) {
        partial[i] -= step * (p.area - overlap::row_edge(p.row + 1, map.height) * p.turn);
        below[i] -= step * p.turn;
      } else {
        partial[i] += step * (overlap::row_edge(p.row, map.height) * p.turn - p.area);
        above[i] += step * p.turn;
      }
    };
    const auto texel = [&](int x, int y) {
      return x < 0 || y < 0 || x >= size || y >= size ? dvec3(0.0) : dvec3(image.rgb(x, y));
    };
    for (int y = 0; y <= size; ++y) {
      overlap::edges_of_row(y, size, [&](const Edge& e) {
        step = e.down ? texel(e.x - 1, e.y) - texel(e.x, e.y) : texel(e.x, e.y) - texel(e.x, e.y - 1);
        if (step == dvec3(0.0)) return;
        const Ends ends = overlap::edge_ends(axes, e, size);
        overlap::walk_arc(lattice, ends.a, ends.b, visit);
      });
    }
  }
  for (std::size_t x = 0; x < columns; ++x) {
    for (std::size_t y = rows - 1; y > 0; --y) above[(y - 1) * columns + x] += above[y * columns + x];
    for (std::size_t y = 1; y < rows; ++y) below[y * columns + x] += below[(y - 1) * columns + x];
  }
  for (std::size_t y = 0; y < rows; ++y) {
    const double solid_angle = overlap::texel_solid_angle(static_cast<int>(y), width, width / 2);
    const double height = solid_angle * width / (2.0 * std::numbers::pi);
    for (std::size_t x = 0; x < columns; ++x) {
      dvec3 flux = partial[y * columns + x];
      if (y + 1 < rows) flux += above[(y + 1) * columns + x] * height;
      if (y > 0) flux += below[(y - 1) * columns + x] * height;
      map.set_rgb(static_cast<int>(x), static_cast<int>(y), vec3(glm::max(flux / solid_angle, dvec3(0.0))));
    }
  }
  return map;
}

Image panorama_from_openexr(const Image& latlong) {
  constexpr double kQuarter = 0.25;  // our middle is +x, a quarter turn to the left of +z
  const std::vector<Taps> columns = taps_of_parts(latlong.width, kQuarter), rows = taps_of_parts(latlong.height, 0.0);
  Image map(latlong.width, latlong.height, 3);
  parallel_for(0, rows.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < columns.size(); ++x)
        map.set_rgb(static_cast<int>(x), static_cast<int>(y), gather(latlong, 0, columns[x], rows[y]));
  });
  return map;
}

CubeFaces cube_from_openexr(const Image& image) {
  const int size = image.width;
  CANDELA_CHECK(size > 0 && image.height == kFaces * size);
  const std::vector<Taps> parts = taps_of_parts(size, 0.0);
  CubeFaces faces = make_cube_faces(size);
  for (int face = 0; face < kFaces; ++face) {
    // Pictures as someone inside sees them are the mirror images of ours: sides from left to right, the others upside
    // down.
    const bool is_side = face != 2 && face != kBottom;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const int column = is_side ? size - 1 - x : x, row = is_side ? y : size - 1 - y;
        faces[static_cast<std::size_t>(face)].set_rgb(
            x, y,
            gather(image, face * size, parts[static_cast<std::size_t>(column)], parts[static_cast<std::size_t>(row)]));
      }
    }
  }
  return faces;
}

}  // namespace candela
