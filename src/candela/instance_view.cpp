#include "candela/instance_view.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace candela {

std::size_t count(const PixelMask& mask) {
  return static_cast<std::size_t>(std::count(mask.bits.begin(), mask.bits.end(), true));
}

std::optional<std::array<int, 4>> box_of(const PixelMask& mask) {
  ivec2 low = mask.size, high(-1);
  for (int y = 0; y < mask.size.y; ++y) {
    for (int x = 0; x < mask.size.x; ++x) {
      if (mask.at(x, y)) low = glm::min(low, ivec2(x, y)), high = glm::max(high, ivec2(x, y));
    }
  }
  if (high.x < 0) return std::nullopt;
  return std::array{low.x, low.y, high.x - low.x + 1, high.y - low.y + 1};
}

void for_instances(const TakenPicture& picture, const std::vector<Instance>& instances,
                   const std::function<void(const InstanceView&)>& visit) {
  const ivec2 size(picture.film.width(), picture.film.height());
  const Image& numbers = picture.film.layers.at(Layer::instance);
  std::map<int, const InstanceMask*> mask_of;  // by node
  for (const InstanceMask& mask : *picture.film.masks) mask_of[mask.node] = &mask;
  const std::vector<bool> none(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  for (const Instance& instance : instances) {
    InstanceView view{&instance, {size, none}, {size, none}};
    bool is_there = false;
    for (const int node : instance.nodes) {
      const auto found = mask_of.find(node);
      if (found == mask_of.end()) continue;
      is_there = true;
      const InstanceMask& mask = *found->second;
      for (int y = mask.corner.y; y < mask.corner.y + mask.size.y; ++y) {
        for (int x = mask.corner.x; x < mask.corner.x + mask.size.x; ++x) {
          if (!mask.covers({x, y})) continue;
          const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x);
          view.amodal.bits[at] = true;
          if (static_cast<int>(numbers.pixels[at]) == node + 1) view.visible.bits[at] = true;
        }
      }
    }
    if (is_there) visit(view);
  }
}

double InstanceView::visible_fraction() const {
  const double all = static_cast<double>(count(amodal));
  return all > 0.0 ? std::round(static_cast<double>(count(visible)) / all * 1e6) / 1e6 : 0.0;
}

/// cocodataset/cocoapi, common/maskApi.c, rleToString: column by column, of 0 and 1 by turns, 0 first; each but the
/// first three as its difference to the one before the last; five bits a character from the least on, bit 5 where more
/// follow, from '0' on.
std::string run_lengths(const PixelMask& mask) {
  std::vector<long> counts;
  bool value = false;
  long run = 0;
  for (int x = 0; x < mask.size.x; ++x) {
    for (int y = 0; y < mask.size.y; ++y) {
      if (mask.at(x, y) != value) {
        counts.push_back(std::exchange(run, 0));
        value = !value;
      }
      ++run;
    }
  }
  counts.push_back(run);
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    long rest = counts[i] - (i > 2 ? counts[i - 2] : 0);
    for (bool is_more = true; is_more;) {
      long bits = rest & 31;
      rest >>= 5;
      is_more = (bits & 16) != 0 ? rest != -1 : rest != 0;
      if (is_more) bits |= 32;
      text += static_cast<char>(bits + '0');
    }
  }
  return text;
}

}  // namespace candela
