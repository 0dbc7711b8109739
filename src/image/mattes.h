#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "math/types.h"

namespace candela {

/// What mattes tell apart.
enum class MatteKind { object, material };
struct MatteInfo {
  MatteKind kind;
  std::string_view name;   ///< on the command line
  std::string_view layer;  ///< in OpenEXR files, by Cryptomatte's custom
};
inline constexpr auto kMatteKinds = std::to_array<MatteInfo>({
    {MatteKind::object, "object", "CryptoObject"},
    {MatteKind::material, "material", "CryptoMaterial"},
});
MatteKind parse_matte_kind(std::string_view name);  ///< throws Error that lists what there is

/// How much of a pixel something covers.
struct Matte {
  std::uint32_t number = 0;  ///< index in the scene
  float coverage = 0.0f;     ///< 0: nothing, and `number` means none
};

/// Of every pixel the objects, or materials, that cover it, the one that covers most first: soft masks, as Cryptomatte
/// has them. Friedman & Jones 2015, "Fully automatic ID mattes with support for motion blur and transparency".
struct Mattes {
  static constexpr std::size_t kRanks = 6;  ///< of a pixel at most; what covers less is left out
  int width = 0;
  int height = 0;
  std::vector<Matte> ranks;                    ///< width * height * kRanks, row 0 at the top
  std::map<std::uint32_t, std::string> names;  ///< of all numbers, each once

  const Matte* at(std::size_t pixel) const { return ranks.data() + pixel * kRanks; }
};

/// Sums of shares, of which mattes are made. A pixel is added to by one thread at a time.
class MatteSums {
 public:
  MatteSums(int width, int height)
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

  void add(std::size_t pixel, std::uint32_t number, float share);
  void add(const Mattes& mattes, float share);
  void add(const MatteSums& other);
  /// As bytes, and from there; `read` takes what it needs of what it is given. Throws Error where it is too little.
  void write(std::vector<std::byte>& bytes) const;
  void read(std::span<const std::byte>& bytes);
  /// Those of a pixel are multiplied by `scale(pixel)`.
  template <class Scale>
  Mattes mattes(Scale scale) const {
    Mattes result;
    result.width = width_;
    result.height = height_;
    result.ranks.resize(pixels_.size() * Mattes::kRanks);
    for (std::size_t i = 0; i < pixels_.size(); ++i) rank(i, scale(i), result);
    return result;
  }

 private:
  void rank(std::size_t pixel, float scale, Mattes& result) const;

  int width_, height_;
  std::vector<std::vector<Matte>> pixels_;
};

/// Which pixels something covers, whatever is before it: amodal. Bits of a rectangle, by rows from the top left.
struct InstanceMask {
  int node = -1;  ///< of the scene
  ivec2 corner{0};
  ivec2 size{0};
  std::vector<bool> bits;

  bool covers(ivec2 pixel) const {
    const ivec2 p = pixel - corner;
    if (p.x < 0 || p.y < 0 || p.x >= size.x || p.y >= size.y) return false;
    return bits[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(p.x)];
  }
};

/// Collects them pixel by pixel.
class MaskBuilder {
 public:
  /// May say the same again.
  void add(int node, ivec2 pixel) { pixels_[node].push_back(pixel); }
  std::vector<InstanceMask> build() const;  ///< by ascending node

 private:
  std::map<int, std::vector<ivec2>> pixels_;
};

}  // namespace candela
