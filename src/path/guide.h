#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"
#include "path/geometry.h"
#include "shade/surface.glsl.h"

namespace candela::path {

/// Surfaces of one region that share what chance a guide has over their own lobes.
enum class GuidedKind : std::uint8_t { diffuse, glossy, sharp };
inline constexpr std::size_t kGuidedKinds = 3;

/// Chances to draw a direction by what was learned, and as if the environment were seen everywhere (through glass, it
/// often is); what is left to 1 is the material's.
struct GuideMix {
  float learned = 0.0f;
  float sky = 0.0f;

  float by_material() const { return 1.0f - learned - sky; }
};
GuidedKind guided_kind(const shade::Surface& surface);

/// Where light comes from that lamps cannot be connected to: a density of directions for each region of the scene,
/// learned from paths. Müller, Gross & Novák 2017, "Practical Path Guiding for Efficient Light-Transport Simulation",
/// §3: a binary tree over space, in each leaf a quadtree over the sphere. Cells are halved across their longest side,
/// so that they stay compact. Constant while paths are traced; GuideLearner makes the next one.
class Guide {
 public:
  /// One region, all directions alike, never asked: where learning begins.
  explicit Guide(const Box3& bounds);

  std::uint32_t find_region(vec3 position) const;
  const GuideMix& mix(std::uint32_t region, GuidedKind kind) const {
    return regions_[region].mixes[static_cast<std::size_t>(kind)];
  }
  /// A direction by two numbers in [0, 1); unit, world space.
  vec3 sample(std::uint32_t region, vec2 u) const;
  /// Its density per solid angle. `direction` is unit, world space.
  float pdf(std::uint32_t region, vec3 direction) const;
  /// The cell that a direction lies in, for GuideRecord::cell.
  std::uint32_t find_cell(std::uint32_t region, vec3 direction) const;

  std::size_t region_count() const { return regions_.size(); }
  std::uint64_t bytes() const;

 private:
  friend class GuideLearner;
  /// The four quarters of a cell of the square that the sphere is unrolled to, x first.
  struct Quad {
    std::array<float, 4> shares{0.25f, 0.25f, 0.25f, 0.25f};  ///< of the cell's light
    std::array<std::uint32_t, 4> children{};                  ///< 0 = not divided further
  };
  struct Cell {
    std::int8_t axis = -1;    ///< that it is halved across; -1 = a region
    std::uint32_t first = 0;  ///< of its two halves, or the region
  };
  struct Region {
    std::uint32_t root = 0;
    std::array<GuideMix, kGuidedKinds> mixes{};
  };

  Box3 bounds_;
  bool is_learned_ = false;
  std::vector<Cell> cells_;
  std::vector<Region> regions_;
  std::vector<Quad> quads_;
};

/// What a path says of one of its vertices, once it has ended.
struct GuideRecord {
  std::uint32_t region = 0;
  std::uint32_t cell = 0;
  GuidedKind kind = GuidedKind::diffuse;
  float light = 0.0f;        ///< luminance from the direction that it took, over the density of that direction
  float reflected = 0.0f;    ///< of that, what the surface reflects: f·|cos θ| times it
  float pdf = 0.0f;          ///< of the direction
  float bsdf_pdf = 0.0f;     ///< by the material alone,
  float learned_pdf = 0.0f;  ///< by what was learned,
  float sky_pdf = 0.0f;      ///< and by the environment
};

/// Collects records of paths that a guide led, and makes the next guide of them. Records are added one after the other,
/// in an order of the caller's: it decides the last bits of the sums.
class GuideLearner {
 public:
  /// `has_sky`: environments can be sampled.
  GuideLearner(const Guide& guide, bool has_sky);

  void add(std::span<const GuideRecord> records);
  Guide next() const;

 private:
  /// Of which each kind of surface in each region takes the best; those without sky first.
  static constexpr std::array<GuideMix, 15> kMixes{{{0.0f, 0.0f},
                                                    {0.2f, 0.0f},
                                                    {0.4f, 0.0f},
                                                    {0.6f, 0.0f},
                                                    {0.75f, 0.0f},
                                                    {0.9f, 0.0f},
                                                    {0.0f, 0.2f},
                                                    {0.3f, 0.2f},
                                                    {0.6f, 0.2f},
                                                    {0.0f, 0.4f},
                                                    {0.2f, 0.4f},
                                                    {0.45f, 0.4f},
                                                    {0.0f, 0.6f},
                                                    {0.2f, 0.6f},
                                                    {0.0f, 0.8f}}};
  static constexpr std::size_t kMixesWithoutSky = 6;
  struct Tally {
    std::uint32_t found = 0;                            ///< records with light
    std::array<double, kMixes.size()> second_moment{};  ///< of what is reflected, were directions drawn by each mix
  };
  struct RegionTally {
    std::uint32_t count = 0;
    std::array<Tally, kGuidedKinds> kinds{};
  };
  struct Growth;

  void divide_space(Growth& growth, std::uint32_t cell, const Box3& box, std::uint32_t region, double count) const;
  struct Found {
    double light = 0.0;
    double paths = 0.0;  ///< that found it
  };
  static constexpr std::uint32_t kNoQuad = ~0U;
  std::uint32_t grow_quads(Growth& growth, std::uint32_t quad, const std::array<Found, 4>& found, double total,
                           int depth) const;
  void add_region(Growth& growth, std::uint32_t cell, std::uint32_t region) const;
  Found found_in(std::uint32_t quad, std::size_t quarter) const;
  GuideMix best_mix(const Tally& tally, const Tally& everywhere) const;

  const Guide& guide_;
  bool has_sky_;
  std::vector<RegionTally> tallies_;
  std::array<Tally, kGuidedKinds> everywhere_{};
  std::vector<std::array<Found, 4>> found_;  ///< in each quarter of each quad
};

}  // namespace candela::path
