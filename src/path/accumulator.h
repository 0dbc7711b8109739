#pragma once

#include <map>
#include <vector>

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

  /// Adds a sample; false when it is not finite, and then it is left out.
  bool add(int x, int y, const PathSample& sample);

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
    double r = 0.0, g = 0.0, b = 0.0;
    double luminance2 = 0.0;
    float alpha = 0.0f;
    std::uint32_t count = 0;
  };
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
    vec3 albedo{0.0f}, normal{0.0f}, seen{0.0f};
    float albedo2 = 0.0f, normal2 = 0.0f;  ///< sums over samples and channels of squares
    float seen2 = 0.0f, seen_half = 0.0f;  ///< of the luminance of what is seen, as below
    vec3 other2{0.0f};                     ///< of what is not seen
    vec3 other_half{0.0f};                 ///< and its sum over those samples whose number has not the bit kHalf
    std::uint32_t count_half = 0;
  };
  /// Either half of sixteen Sobol' points is as even as eight points are.
  static constexpr std::uint32_t kHalf = 8;
  void resolve_features(DenoisingFeatures& features) const;
  void resolve_through_variance(DenoisingFeatures& features) const;

  std::vector<float> half_luminance_;      ///< of those samples, for Settings::noise
  std::vector<Features> features_;         ///< empty unless asked for
  std::map<MatteKind, MatteSums> mattes_;  ///< those asked for
  std::vector<Layer> mean_layers_;         ///< likewise
  std::vector<vec3> layers_;               ///< of each pixel the sums of these
  struct Through {
    dvec3 sum{0.0};
    double luminance2 = 0.0;
    double half = 0.0;  ///< luminance of those samples whose number has not the bit kHalf
  };
  std::vector<Through> through_;  ///< empty unless samples have it
};

}  // namespace candela::path
