#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "candela/objects.h"
#include "candela/shot.h"

/// What a picture shows of the objects in it.
namespace candela {

/// A set of pixels, by rows from the top.
struct PixelMask {
  ivec2 size{0};
  std::vector<bool> bits;

  bool at(int x, int y) const {
    return bits[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x)];
  }
};
std::size_t count(const PixelMask& mask);
/// x, y, width, height; nothing of an empty one.
std::optional<std::array<int, 4>> box_of(const PixelMask& mask);
/// COCO's compressed run lengths: `counts` of a segmentation.
std::string run_lengths(const PixelMask& mask);

/// What a picture has of an instance.
struct InstanceView {
  const Instance* instance = nullptr;
  PixelMask visible;
  PixelMask amodal;  ///< where it would be, were nothing before it

  /// Share of its pixels in the frame that are seen, to a millionth.
  double visible_fraction() const;
};
/// Visits those that are in the frame, hidden or not, one after the other: there may be thousands. The picture has
/// Film::masks and Layer::instance.
void for_instances(const TakenPicture& picture, const std::vector<Instance>& instances,
                   const std::function<void(const InstanceView&)>& visit);

}  // namespace candela
