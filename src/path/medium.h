#pragma once

#include <array>

#include "math/sobol.h"
#include "math/types.h"
#include "shade/medium.glsl.h"

namespace candela::path {

/// A homogeneous body: KHR_materials_volume with the draft KHR_materials_volume_scatter.
struct Medium {
  vec3 extinction{0.0f};    ///< σt = -ln(colour) / distance, 1/m
  vec3 albedo{0.0f};        ///< σs / σt
  float anisotropy = 0.0f;  ///< g of Henyey & Greenstein 1941
  float ior = 1.5f;         ///< at 587.6 nm
  float dispersion = 0.0f;  ///< 20 / Abbe number
  bool absorbs = false;     ///< extinction above 0 somewhere
  bool scatters = false;

  vec3 transmittance(float distance) const { return shade::medium_transmittance(extinction, distance); }
};

/// Single-scattering albedo of a medium that as a deep layer reflects `multiscatter` of diffuse light. Kulla & Conty
/// 2017, "Revisiting Physically Based Shading at Imageworks", p. 62, as the draft extension prints it; with a phase
/// function of mean cosine g by similarity: the reduced albedo (1 - g) a / (1 - g a) is the isotropic one.
vec3 single_scatter_albedo(vec3 multiscatter, float g);

/// The bodies that a path is inside of, in the order in which it entered; what was entered last is what it is in.
/// Bodies that overlap a little, as liquids do with their glass, need no priorities that way.
class MediumStack {
 public:
  /// nullptr = air.
  const Medium* current() const { return count_ > 0 ? entries_[count_ - 1].medium : nullptr; }
  /// Of single scattering in current().
  vec3 albedo() const { return entries_[count_ - 1].albedo; }
  /// What lies below `body`, were it left.
  const Medium* below_top() const { return count_ > 1 ? entries_[count_ - 2].medium : nullptr; }
  bool holds(int body) const { return find(body) >= 0; }
  bool is_top(int body) const { return count_ > 0 && entries_[count_ - 1].body == body; }
  /// The body entered last; 0 = none.
  int top() const { return count_ > 0 ? entries_[count_ - 1].body : 0; }
  bool empty() const { return count_ == 0; }
  /// The body entered last of those that `condition` holds for; 0 = none.
  template <class Condition>
  int last(const Condition& condition) const {
    for (std::size_t i = count_; i > 0; --i) {
      if (condition(entries_[i - 1].body)) return entries_[i - 1].body;
    }
    return 0;
  }
  void enter(int body, const Medium* medium) { enter(body, medium, medium->albedo); }
  /// Where the place of entry says how the medium scatters.
  void enter(int body, const Medium* medium, vec3 albedo) {
    if (count_ < kMost) entries_[count_++] = {body, medium, albedo};
  }
  void leave(int body) {
    const int i = find(body);
    if (i < 0) return;
    for (std::size_t k = static_cast<std::size_t>(i); k + 1 < count_; ++k) entries_[k] = entries_[k + 1];
    --count_;
  }

 private:
  static constexpr std::size_t kMost = 8;  // a ninth body inside eight others is as good as air
  struct Entry {
    int body;
    const Medium* medium;
    vec3 albedo;
  };
  int find(int body) const {
    for (std::size_t i = count_; i > 0; --i) {
      if (entries_[i - 1].body == body) return static_cast<int>(i - 1);
    }
    return -1;
  }

  std::array<Entry, kMost> entries_;  ///< the first count_ hold something
  std::size_t count_ = 0;
};

}  // namespace candela::path
