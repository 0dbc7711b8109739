#pragma once

#include <vector>

#include "ibl/kernel.h"
#include "ibl/source.h"

namespace candela::ibl {

/// The texels of a panorama and ever larger groups of them, each with its light, the centre of its light and its
/// spread. A sum over all texels descends to those groups alone whose spread the lobe can feel (Barnes & Hut 1986, "A
/// Hierarchical O(N log N) Force-Calculation Algorithm", with second moments instead of an opening angle).
class TexelTree {
 public:
  /// The source must outlive the tree.
  explicit TexelTree(const Source& source);

  /// ∫ radiance × lobe about `direction`. `tolerance` is about the relative error; each group may err by its part.
  dvec3 sum(const Kernel& kernel, dvec3 direction, double tolerance) const;

 private:
  struct Node {
    vec3 flux{0.0f};
    vec3 centre{0.0f};    ///< mean direction of the light, not normalised: its length² is 1 - spread
    float spread = 0.0f;  ///< mean squared chord from the centre
    float weight = 0.0f;  ///< sum of the flux's channels
  };
  struct Level {
    int width = 0;
    int height = 0;
    std::vector<Node> nodes;
  };

  const Node& node(int level, int x, int y) const {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    return l.nodes[static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width) + static_cast<std::size_t>(x)];
  }
  Level texels(const Source& source) const;
  Level halved(const Level& fine) const;
  /// Greatest distance within a group of row `y`.
  double extent(int level, int y) const;
  dvec3 sum_texel(const Kernel& kernel, int x, int y, dvec3 direction) const;
  dvec3 descend(const Kernel& kernel, dvec3 direction, double allowance) const;

  const Source& source_;
  std::vector<Level> levels_;  ///< 0: the texels
  std::vector<Point> points_;  ///< of the discs
};

}  // namespace candela::ibl
