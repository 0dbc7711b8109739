#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "math/exact_sum.h"
#include "path/integrator.h"
#include "path/render.h"

namespace candela::path {

/// Running sums of every pixel. A pixel is written by one thread at a time and in the order of its samples, so the sums
/// do not depend on how many threads there are.
class Accumulator {
 public:
  /// `has_through`: samples tell what background they let through.
  Accumulator(const Settings& settings, bool has_through);

  static std::uint64_t bytes_per_pixel(const Settings& settings);
  /// What write() makes of each pixel, at least.
  static std::uint64_t least_bytes_per_pixel() { return sizeof(Pixel); }

  /// Adds the pixel's sample of this number; false when it is not finite, and then it is left out.
  bool add(int x, int y, std::uint32_t number, const PathSample& sample);
  /// Adds other samples of the same picture. Of a picture without features the result is that of one accumulator with
  /// all of them, to the last bit; features are as exact as double precision.
  void add(const Accumulator& other);

  /// All sums as bytes, and from there; `read` takes what it needs of what it is given. Throws Error where it is too
  /// little. For one machine's order of bytes.
  void write(std::vector<std::byte>& bytes) const;
  void read(std::span<const std::byte>& bytes);

  std::uint32_t count(int x, int y) const { return pixel(x, y).count; }

  /// Estimated standard error of what is shown of each pixel, row by row: Shown::error(), infinite before the second
  /// sample. A background that shows through glass counts as light of the mean luminance of what is there. The noise of
  /// luminance speaks for that of all channels. Settings::noise was set.
  std::vector<float> shown_errors(const DevelopSettings& develop) const;

  /// Settings::mattes has it: that the pixel's sample meets this node, or material.
  void add_matte(MatteKind kind, int x, int y, std::uint32_t number) {
    mattes_.at(kind).add(index(x, y), number, 1.0f);
  }

  /// Mean radiance and layers so far, and features where they are wanted and were asked for.
  void resolve(Film& film, bool wants_features) const;

 private:
  struct Pixel {
    ExactSum r, g, b;
    float alpha = 0.0f;  ///< of zeros and ones
    std::uint32_t count = 0;

    dvec3 sum() const { return {r.value(), g.value(), b.value()}; }
  };
  /// Calls `visit(vector)` for each vector of sums of numbers.
  template <class Self, class Visit>
  static void for_sums(Self& self, Visit visit) {
    visit(self.pixels_), visit(self.luminance2_), visit(self.half_luminance_), visit(self.features_);
    visit(self.layers_), visit(self.through_);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  struct Light {
    vec3 mean;
    float relative_error;  ///< standard error of the mean luminance over that, of independent samples
  };
  Light light(std::size_t i, float background) const;
  float mean_of_what_is_there() const;
  float exposure(const DevelopSettings& develop) const;
  float gain_of_points(std::size_t i) const;
  float gain_of_block(ivec2 corner, ivec2 end) const;
  void resolve_beauty(Film& film) const;  ///< and what shows through it
  const Pixel& pixel(int x, int y) const { return pixels_[index(x, y)]; }

  int width_;
  int height_;
  std::vector<Pixel> pixels_;
  struct Features {
    dvec3 albedo{0.0}, normal{0.0}, seen{0.0};
    double albedo2 = 0.0, normal2 = 0.0;  ///< sums over samples and channels of squares
    double seen2 = 0.0, seen_half = 0.0;  ///< of the luminance of what is seen, as below
    dvec3 other2{0.0};                    ///< of what is not seen
    dvec3 other_half{0.0};                ///< and its sum over those samples whose number has not the bit kHalf
    std::uint64_t count_half = 0;
  };
  static void add(const Features& from, Features& to);
  /// Either half of sixteen Sobol' points is as even as eight points are.
  static constexpr std::uint32_t kHalf = 8;
  void resolve_features(DenoisingFeatures& features) const;
  void resolve_through_variance(DenoisingFeatures& features) const;

  std::vector<double> luminance2_;                    ///< of every sample the square, for Settings::noise
  std::vector<float> half_luminance_;                 ///< of those samples, likewise
  std::vector<Features> features_;                    ///< empty unless asked for
  std::map<MatteKind, MatteSums> mattes_;             ///< those asked for
  std::vector<Layer> mean_layers_;                    ///< likewise
  std::vector<std::array<ExactSmallSum, 3>> layers_;  ///< of each pixel the sums of these
  struct Through {
    dvec3 sum{0.0};
    double luminance2 = 0.0;
    double half = 0.0;  ///< luminance of those samples whose number has not the bit kHalf
  };
  std::vector<Through> through_;  ///< empty unless samples have it
};

}  // namespace candela::path
