#include "image/cube_layout.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "shade/cube.glsl.h"

namespace candela {

namespace {

/// Middle of a texel in [-1, 1].
float center(int texel, int size) {
  return (2.0f * static_cast<float>(texel) + 1.0f) / static_cast<float>(size) - 1.0f;
}

int nearest_texel(float coordinate, int size) {
  const int texel = static_cast<int>(std::floor(0.5f * (coordinate + 1.0f) * static_cast<float>(size)));
  return std::clamp(texel, 0, size - 1);
}

/// Every texel of the result is the texel of `from` that lies in the direction `from_direction(direction)`.
template <class Direction>
CubeFaces permuted(const CubeFaces& from, Direction from_direction) {
  const int size = from[0].width;
  CubeFaces to = make_cube_faces(size);
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const vec3 c =
            shade::cube_coordinates(from_direction(shade::cube_direction(face, center(x, size), center(y, size))));
        to[static_cast<std::size_t>(face)].set_rgb(
            x, y, from[static_cast<std::size_t>(c.x)].rgb(nearest_texel(c.y, size), nearest_texel(c.z, size)));
      }
    }
  }
  return to;
}

template <class Turn>
Cubemap each_level(const Cubemap& cube, Turn turn) {
  Cubemap result;
  for (const CubeFaces& level : cube.levels) result.levels.push_back(turn(level));
  return result;
}

/// Where a face lies in a layout, in faces from the top left, and whether it is turned by half a turn.
struct Place {
  int column, row;
  bool is_turned = false;
};
struct LayoutShape {
  std::string_view name;
  int columns, rows;
  std::array<Place, 6> places;
};
constexpr std::array<LayoutShape, 4> kLayouts{{
    {"cross-4x3", 4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}},
    {"cross-3x4", 3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3, true}}}},
    {"strip-6x1", 6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}},
    {"strip-1x6", 1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}},
}};
const LayoutShape& shape_of(CubeLayout layout) { return kLayouts[static_cast<std::size_t>(layout)]; }

/// Calls body(face, x, y, image x, image y) for every texel.
template <class Body>
void for_each_texel(const LayoutShape& shape, int size, Body body) {
  for (std::size_t face = 0; face < 6; ++face) {
    const Place& place = shape.places[face];
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const int dx = place.is_turned ? size - 1 - x : x;
        const int dy = place.is_turned ? size - 1 - y : y;
        body(face, x, y, place.column * size + dx, place.row * size + dy);
      }
    }
  }
}

}  // namespace

vec3 CubeAxes::lookup_from_world(vec3 world) const {
  vec3 lookup;
  for (int i = 0; i < 3; ++i)
    lookup[i] = static_cast<float>(sign[static_cast<std::size_t>(i)]) * world[axis[static_cast<std::size_t>(i)]];
  return lookup;
}

vec3 CubeAxes::world_from_lookup(vec3 lookup) const {
  vec3 world;
  for (int i = 0; i < 3; ++i)
    world[axis[static_cast<std::size_t>(i)]] = static_cast<float>(sign[static_cast<std::size_t>(i)]) * lookup[i];
  return world;
}

bool CubeAxes::is_picture() const {
  const mat3 m(lookup_from_world({1, 0, 0}), lookup_from_world({0, 1, 0}), lookup_from_world({0, 0, 1}));
  return glm::determinant(m) < 0.0f;
}

std::string axes_text(const CubeAxes& axes) {
  std::string text;
  for (std::size_t i = 0; i < 3; ++i) {
    text += axes.sign[i] > 0 ? '+' : '-';
    text += static_cast<char>('x' + axes.axis[i]);
  }
  return text;
}

std::optional<CubeAxes> parse_axes(std::string_view text) {
  if (text.size() != 6) return std::nullopt;
  CubeAxes axes;
  std::array<bool, 3> seen{};
  for (std::size_t i = 0; i < 3; ++i) {
    const char sign = text[2 * i];
    const int axis = text[2 * i + 1] - 'x';
    if ((sign != '+' && sign != '-') || axis < 0 || axis > 2 || seen[static_cast<std::size_t>(axis)])
      return std::nullopt;
    seen[static_cast<std::size_t>(axis)] = true;
    axes.axis[i] = axis;
    axes.sign[i] = sign == '+' ? 1 : -1;
  }
  return axes;
}

CubeFaces file_from_world(const CubeFaces& world, const CubeAxes& axes) {
  return permuted(world, [&](vec3 lookup) { return axes.world_from_lookup(lookup); });
}

CubeFaces world_from_file(const CubeFaces& file, const CubeAxes& axes) {
  return permuted(file, [&](vec3 world) { return axes.lookup_from_world(world); });
}

Cubemap file_from_world(const Cubemap& world, const CubeAxes& axes) {
  return each_level(world, [&](const CubeFaces& level) { return file_from_world(level, axes); });
}

Cubemap world_from_file(const Cubemap& file, const CubeAxes& axes) {
  return each_level(file, [&](const CubeFaces& level) { return world_from_file(level, axes); });
}

std::string_view layout_name(CubeLayout layout) { return shape_of(layout).name; }

CubeLayout parse_layout(std::string_view name) {
  std::string known;
  for (std::size_t i = 0; i < kLayouts.size(); ++i) {
    if (kLayouts[i].name == name) return static_cast<CubeLayout>(i);
    known += (known.empty() ? "" : ", ") + std::string(kLayouts[i].name);
  }
  throw Error("unknown cube layout \"" + std::string(name) + "\"; known are " + known);
}

std::optional<CubeLayout> detect_layout(int width, int height) {
  for (std::size_t i = 0; i < kLayouts.size(); ++i) {
    const LayoutShape& shape = kLayouts[i];
    if (width > 0 && width % shape.columns == 0 && width / shape.columns * shape.rows == height)
      return static_cast<CubeLayout>(i);
  }
  return std::nullopt;
}

CubeFaces faces_from_layout(const Image& image, CubeLayout layout) {
  const LayoutShape& shape = shape_of(layout);
  const int size = image.width / shape.columns;
  CANDELA_CHECK(size * shape.columns == image.width && size * shape.rows == image.height);
  CubeFaces faces = make_cube_faces(size);
  for_each_texel(shape, size, [&](std::size_t face, int x, int y, int column, int row) {
    faces[face].set_rgb(x, y, image.rgb(column, row));
  });
  return faces;
}

Image layout_from_faces(const CubeFaces& faces, CubeLayout layout) {
  const LayoutShape& shape = shape_of(layout);
  const int size = faces[0].width;
  Image image(size * shape.columns, size * shape.rows, 3);
  for_each_texel(shape, size, [&](std::size_t face, int x, int y, int column, int row) {
    image.set_rgb(column, row, faces[face].rgb(x, y));
  });
  return image;
}

double cube_texel_solid_angle(int size, int x, int y) {
  // The part of the sphere behind the rectangle [0, s] × [0, t] of the face is atan(s t / √(s² + t² + 1)).
  const auto corner = [](double s, double t) { return std::atan2(s * t, std::sqrt(s * s + t * t + 1.0)); };
  const double step = 2.0 / size;
  const double s0 = x * step - 1.0, s1 = (x + 1) * step - 1.0;
  const double t0 = y * step - 1.0, t1 = (y + 1) * step - 1.0;
  return corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0);
}

}  // namespace candela
