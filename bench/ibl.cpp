// ibl_error [PANORAMA…]: error and processor time of prefiltering, ours beside filtered importance sampling of 1024
// samples, over panoramas and a synthetic sky with a sun of one texel. A table in Markdown on standard output.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "content/make_environment.h"
#include "ibl/bake.h"
#include "ibl/cube.h"
#include "ibl/tables.h"
#include "scene/environment.h"

namespace {

using candela::dvec3;
using candela::ibl::ErrorBound;
using candela::ibl::Kernel;
using candela::ibl::Lobe;
using candela::ibl::Source;

constexpr int kDirections = 256;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A sky of radiance 1 whose one bright texel gives an irradiance of 3.4.
Source one_texel_sun() {
  constexpr int kWidth = 1024, kColumn = 300, kRow = 170;
  Source source;
  source.map = candela::Image(kWidth, kWidth / 2, 3);
  std::fill(source.map.pixels.begin(), source.map.pixels.end(), 1.0f);
  const double solid_angle = candela::ibl::texel_solid_angle(kRow, kWidth, kWidth / 2);
  source.map.set_rgb(kColumn, kRow, candela::vec3(static_cast<float>(3.4 / solid_angle)));
  return source;
}

/// Half of the directions about the brightest light, where errors are, the others anywhere.
std::vector<dvec3> directions_for(const Source& source) {
  std::vector<dvec3> directions = candela::ibl::random_directions(kDirections, 17);
  const auto suns = candela::ibl::extract_suns(source, {.contrast = 1.0, .least_share = 0.0, .widest = 4.0}).suns;
  for (std::size_t i = 0; i < directions.size() / 2 && !suns.empty(); ++i) {
    directions[i] = glm::normalize(directions[i] + 1.2 * suns[0].direction);
  }
  return directions;
}

void print_row(const std::string& name, const Source& source) {
  const std::vector<dvec3> directions = directions_for(source);
  for (const double roughness : {0.2, 0.25, 0.35355, 0.5, 0.70711, 1.0}) {
    const Kernel kernel(Lobe::ggx, roughness);
    const std::vector<dvec3> exact = candela::ibl::reference(source, kernel, directions);
    const auto error = [&](candela::ibl::Method method) {
      candela::ibl::PrefilterSettings settings;
      settings.method = method;
      return candela::ibl::compare(candela::ibl::Prefilter(source, {kernel}, settings).at(kernel, directions), exact,
                                   directions);
    };
    const ErrorBound ours = error(candela::ibl::Method::automatic);
    const ErrorBound fis = error(candela::ibl::Method::fis);
    std::printf("| %s | %.2f | %.1e %% | %.1e %% | %.2g %% | %.2g %% |\n", name.c_str(), roughness, 100.0 * ours.max,
                100.0 * ours.rms, 100.0 * fis.max, 100.0 * fis.rms);
  }
}

/// Processor seconds of a bake without its proof, of the proof, and of the same levels by the other method.
void print_times(const std::string& name, const Source& source) {
  candela::ibl::BakeSettings settings;
  const auto time = [&](int proof, candela::ibl::Method method) {
    settings.proof_directions = proof;
    settings.specular.method = method;
    const double start = cpu_seconds();
    candela::ibl::bake(source, settings);
    return cpu_seconds() - start;
  };
  const double bare = time(0, candela::ibl::Method::automatic), proved = time(32, candela::ibl::Method::automatic);
  const double start = cpu_seconds();
  candela::ibl::make_tables(128);
  const double tables = cpu_seconds() - start;
  const double fis = time(0, candela::ibl::Method::fis);
  std::printf("| %s | %dx%d | %.2f s | %.2f s | %.2f s | %.1f s |\n", name.c_str(), source.map.width, source.map.height,
              bare, proved, tables, fis);
}

int run(int argc, char** argv) {
  std::vector<std::pair<std::string, Source>> sources;
  for (int i = 1; i < argc; ++i) {
    sources.emplace_back(std::filesystem::path(argv[i]).stem().string(),
                         candela::ibl::make_source(candela::make_environment(argv[i])));
  }
  sources.emplace_back("one-texel sun", one_texel_sun());
  std::printf("| environment | roughness | ours: max | rms | fis 1024: max | rms |\n|---|---|---|---|---|---|\n");
  for (const auto& [name, source] : sources) print_row(name, source);
  std::printf("\n| environment | size | bake | bake + proof | tables | bake by fis |\n|---|---|---|---|---|---|\n");
  for (const auto& [name, source] : sources) print_times(name, source);
  // ----- twice the width, four times the texels
  Source large = sources.back().second;
  large.map = candela::ibl::subdivided(large.map, 0.004);
  print_times("the same, repeated", large);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ibl_error: %s\n", error.what());
    return 1;
  }
}
