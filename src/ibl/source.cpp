#include "ibl/source.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "base/error.h"
#include "ibl/cube.h"
#include "scene/environment.h"

namespace candela::ibl {
namespace {

constexpr double kPiD = std::numbers::pi;

}  // namespace

Source make_source(const Environment& environment) {
  constexpr int kPlainWidth = 64;  // of a map that is the same everywhere
  Source source;
  source.rotation = static_cast<double>(environment.rotation);
  source.map = environment.map ? Image(environment.map->width, environment.map->height, 3)
                               : Image(kPlainWidth, kPlainWidth / 2, 3);
  float most = 0.0f;
  for (int y = 0; y < source.map.height; ++y) {
    for (int x = 0; x < source.map.width; ++x) {
      vec3 radiance = environment.constant;
      if (environment.map) radiance += environment.map->rgb(x, y);
      radiance *= environment.intensity;
      most = std::max(most, max_component(radiance));
      source.map.set_rgb(x, y, radiance);
    }
  }
  source.suns = world_suns(environment);
  for (const SunDisc& sun : source.suns) most = std::max(most, max_component(sun.radiance));
  if (!(most > 0.0f)) throw Error("is black everywhere: there is no light to bake", environment.name);
  return source;
}

Source make_source(const CubeFaces& faces) {
  Source source;
  source.map = equirect_from_cube(faces, 4 * faces[0].width);
  return source;
}

dvec3 total_flux(const Source& source) {
  dvec3 sum(0.0);
  for (int y = 0; y < source.map.height; ++y) {
    dvec3 row(0.0);
    for (int x = 0; x < source.map.width; ++x) row += dvec3(source.map.rgb(x, y));
    sum += row * texel_solid_angle(y, source.map.width, source.map.height);
  }
  for (const SunDisc& sun : source.suns) sum += dvec3(sun.radiance) * disc_solid_angle(sun);
  return sum;
}

double column_edge(const Source& source, int column) {
  return (static_cast<double>(column) / source.map.width - 0.5) * 2.0 * kPiD - source.rotation;
}

dvec3 texel_direction(const Source& source, int column, int row) {
  const double azimuth = (column_edge(source, column) + column_edge(source, column + 1)) * 0.5;
  const double polar = kPiD * (row + 0.5) / source.map.height;
  return {std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)};
}

Image subdivided(const Image& map, double step) {
  const int times = std::max(1, static_cast<int>(std::ceil(kPiD / map.height / step)));
  if (times == 1) return map;
  Image fine(map.width * times, map.height * times, 3);
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) fine.set_rgb(x, y, map.rgb(x / times, y / times));
  }
  return fine;
}

std::vector<Point> texel_points(const Source& source, int column, int row, dvec3 flux, int side) {
  if (side == 1) return {{texel_direction(source, column, row), flux}};
  const double step = kPiD / source.map.height;
  const double azimuth = (column_edge(source, column) + column_edge(source, column + 1)) * 0.5;
  const double polar = kPiD * (row + 0.5) / source.map.height;
  const double half_u = kPiD / source.map.width / std::sqrt(3.0), half_v = 0.5 * step / std::sqrt(3.0);
  const double sines = std::sin(polar - half_v) + std::sin(polar + half_v);
  std::vector<Point> points;
  for (const double v : {polar - half_v, polar + half_v}) {
    for (const double u : {azimuth - half_u, azimuth + half_u}) {
      points.push_back(
          {{std::sin(v) * std::cos(u), std::cos(v), std::sin(v) * std::sin(u)}, flux * (0.5 * std::sin(v) / sines)});
    }
  }
  return points;
}

double disc_solid_angle(const SunDisc& sun) {
  const double s = std::sin(0.5 * static_cast<double>(sun.angular_radius));
  return 4.0 * kPiD * s * s;
}

std::vector<Point> disc_points(const SunDisc& sun) {
  // Stroud 1971, "Approximate Calculation of Multiple Integrals", S2: 5-1: the centre and a hexagon.
  constexpr int kRim = 6;
  constexpr double kCentre = 0.25, kEach = 0.125;
  const double rim = std::sqrt(2.0 / 3.0) * static_cast<double>(sun.angular_radius);
  const dvec3 n = glm::normalize(dvec3(sun.direction));
  const dvec3 t = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)));
  const dvec3 b = glm::cross(n, t);
  const dvec3 flux = dvec3(sun.radiance) * disc_solid_angle(sun);
  std::vector<Point> points = {{n, kCentre * flux}};
  for (int k = 0; k < kRim; ++k) {
    const double a = 2.0 * kPiD * k / kRim;
    points.push_back({n * std::cos(rim) + (t * std::cos(a) + b * std::sin(a)) * std::sin(rim), kEach * flux});
  }
  return points;
}

}  // namespace candela::ibl
