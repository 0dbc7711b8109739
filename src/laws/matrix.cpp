#include "laws/matrix.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <string>

#include "base/parallel.h"

namespace candela::laws {

namespace {

using shade::SurfaceParams;
using shade::SurfaceSample;

class Counter {
 public:
  Counter(std::size_t total, const Job& job, std::string what) : total_(total), job_(job), what_(std::move(what)) {}
  void one_more() {
    const std::lock_guard lock(mutex_);
    ++done_;
    const double share = static_cast<double>(done_) / static_cast<double>(total_);
    job_.report({.fraction = share, .seconds = watch_.seconds(), .what = what_});
  }

 private:
  std::mutex mutex_;
  std::size_t total_;
  std::size_t done_ = 0;
  const Job& job_;
  std::string what_;
  Stopwatch watch_;
};

bool is_bent(const SurfaceParams& p) { return (p.lobes & shade::kLobeTransmission) != 0 && !p.is_thin; }

}  // namespace

bool keeps(const Measurement& m, const Promise& promise, bool is_bent) {
  constexpr double kPdf = 4e-3;
  if (promise.is_reciprocal && m.reciprocity > reciprocity_slack(is_bent)) return false;
  if (m.furnace.most > 1.0 + promise.gain) return false;
  if (promise.is_white && m.furnace.least < 1.0 - promise.loss) return false;
  return m.pdf <= kPdf && m.flaws.count == 0;
}

std::vector<MatrixRow> law_matrix(bool all, const Job& job) {
  constexpr double kTolerance = 5e-5;
  std::vector<NamedSurface> table = law_surfaces();
  if (!all) std::erase_if(table, [](const NamedSurface& row) { return !row.is_core; });
  std::vector<Measurement> measured(table.size());
  std::vector<char> is_measured(table.size(), 0);
  Counter counter(table.size(), job, "measuring");
  parallel_for(0, table.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !job.is_stopped(); ++i) {
      is_measured[i] = 1;
      measured[i] = measure(real_bsdf(table[i].params), kTolerance);
      counter.one_more();
    }
  });

  // The worst of a group is known when all of it is measured.
  std::set<std::string> incomplete;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (is_measured[i] == 0) incomplete.insert(table[i].group);
  }
  std::vector<MatrixRow> matrix;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (incomplete.contains(table[i].group)) continue;
    const Measurement& m = measured[i];
    if (matrix.empty() || matrix.back().group != table[i].group) {
      matrix.push_back({table[i].group, 0, m, table[i].promise, true});
      matrix.back().worst.flaws = {};
    }
    MatrixRow& row = matrix.back();
    ++row.surfaces;
    row.worst.reciprocity = std::max(row.worst.reciprocity, m.reciprocity);
    row.worst.furnace.least = std::min(row.worst.furnace.least, m.furnace.least);
    row.worst.furnace.most = std::max(row.worst.furnace.most, m.furnace.most);
    row.worst.pdf = std::max(row.worst.pdf, m.pdf);
    if (row.worst.flaws.count == 0) row.worst.flaws.first = m.flaws.first;
    row.worst.flaws.count += m.flaws.count;
    row.worst.flaws.looked_at += m.flaws.looked_at;
    row.holds = row.holds && keeps(m, table[i].promise, is_bent(table[i].params));
  }
  return matrix;
}

namespace {

constexpr int kColumns = 8;
constexpr int kCell = 96;  // pixels
constexpr int kStrip = 24;
constexpr int kCosines = 24;
constexpr int kAzimuths = 7;  // over a quarter of the circle, of what is not round

std::vector<NamedSurface> sheet_materials() {
  const char* const names[] = {"plain white, metallic 0",
                               "plain white, metallic 1",
                               "coat of roughness 0.2 on dielectric",
                               "coat of roughness 0.2 on metal",
                               "sheen of roughness 0.5 on dielectric",
                               "sheen of roughness 0.5 on metal",
                               "thin glass of index 1.5",
                               "glass from outside of index 1.5",
                               "glass from inside of index 1.5",
                               "diffuse transmission 0.5",
                               "anisotropic metal, strength 1",
                               "film of 400 nm on dielectric",
                               "film of 400 nm on metal",
                               "model gltf, metallic 0",
                               "model gltf, metallic 1"};
  std::vector<NamedSurface> materials;
  const std::vector<NamedSurface> table = law_surfaces();
  for (const char* name : names) {
    const auto row = std::find_if(table.begin(), table.end(), [&](const NamedSurface& r) { return r.group == name; });
    if (row != table.end()) materials.push_back(*row);
  }
  return materials;
}

/// Albedo by the mean of sampled weights, with a lattice for random numbers.
double mean_weight(const SurfaceParams& params, vec3 wo) {
  constexpr int kSamples = 2048;
  const Bsdf bsdf = real_bsdf(params);
  const Closure closure = bsdf.seen_from(wo);
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const SurfaceSample s = closure.draw(lattice_point(i));
    const auto brightness = static_cast<double>(s.weight.x + s.weight.y + s.weight.z) / 3.0;
    sum += brightness * (s.wi.z < 0.0f ? bsdf.eta * bsdf.eta : 1.0);
  }
  return sum / kSamples;
}

/// Blue, grey, red.
vec3 deviation_color(double deviation) {
  constexpr double kAmplified = 10.0;
  const auto t = static_cast<float>(std::clamp(kAmplified * deviation, -1.0, 1.0));
  const float up = 0.5f + 0.5f * std::abs(t);
  const float down = 0.5f - 0.5f * std::abs(t);
  return t < 0.0f ? vec3(down, down, up) : vec3(up, down, down);
}

/// Grey would say that nothing is lost.
void blacken(Image& sheet, int left, int top) {
  for (int y = 0; y < kCell; ++y) {
    for (int x = 0; x < kCell; ++x) sheet.set_rgb(left + x, top + y, vec3(0.0f));
  }
}

/// One sphere from its albedo by cosine (rows) and azimuth.
void draw_sphere(Image& sheet, int left, int top, const std::vector<double>& albedo, int azimuths) {
  const double radius = 0.46 * kCell;
  for (int y = 0; y < kCell; ++y) {
    for (int x = 0; x < kCell; ++x) {
      const double u = (x + 0.5 - 0.5 * kCell) / radius;
      const double v = (y + 0.5 - 0.5 * kCell) / radius;
      const double r2 = u * u + v * v;
      if (r2 >= 1.0) continue;
      const double mu = std::sqrt(1.0 - r2);
      const double turn = std::atan2(std::abs(v), std::abs(u)) * 2.0 / 3.14159265358979;
      const double c = mu * (kCosines - 1);
      const int c0 = std::min(static_cast<int>(c), kCosines - 2);
      const int a = static_cast<int>(std::lround(turn * (azimuths - 1)));
      const auto at = [&](int i) { return albedo[static_cast<std::size_t>(i * azimuths + a)]; };
      const double value = at(c0) + (c - c0) * (at(c0 + 1) - at(c0));
      sheet.set_rgb(left + x, top + y, deviation_color(value - 1.0));
    }
  }
}

}  // namespace

std::vector<std::string> furnace_sheet_rows() {
  std::vector<std::string> rows;
  for (const NamedSurface& row : sheet_materials()) rows.push_back(row.group);
  return rows;
}

Image furnace_sheet(const Job& job) {
  const std::vector<NamedSurface> materials = sheet_materials();
  const int rows = static_cast<int>(materials.size());
  Image sheet(kColumns * kCell, rows * kCell + kStrip, 3);
  std::fill(sheet.pixels.begin(), sheet.pixels.end(), 0.5f);
  for (int x = 0; x < sheet.width; ++x) {
    const double deviation = 0.2 * (x + 0.5) / sheet.width - 0.1;
    for (int y = rows * kCell; y < sheet.height; ++y) sheet.set_rgb(x, y, deviation_color(deviation));
  }

  const auto cells = static_cast<std::size_t>(rows * kColumns);
  Counter counter(cells, job, "drawing");
  parallel_for(0, cells, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      const int row = static_cast<int>(cell) / kColumns;
      const int column = static_cast<int>(cell) % kColumns;
      if (job.is_stopped()) {
        blacken(sheet, column * kCell, row * kCell);
        continue;
      }
      SurfaceParams params = materials[static_cast<std::size_t>(row)].params;
      params.roughness = static_cast<float>(column) / (kColumns - 1);
      const int azimuths = (params.lobes & shade::kLobeAnisotropy) != 0 ? kAzimuths : 1;
      std::vector<double> albedo;
      for (int c = 0; c < kCosines; ++c) {
        for (int a = 0; a < azimuths; ++a) {
          const float mu = std::max(static_cast<float>(c) / (kCosines - 1), 0.01f);
          const float turn = azimuths > 1 ? static_cast<float>(a) / static_cast<float>(azimuths - 1) : 0.5f;
          albedo.push_back(mean_weight(params, direction(mu, 0.5f * shade::kShadePi * turn)));
        }
      }
      draw_sphere(sheet, column * kCell, row * kCell, albedo, azimuths);
      counter.one_more();
    }
  });
  return sheet;
}

}  // namespace candela::laws
