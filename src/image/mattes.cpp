#include "image/mattes.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/named_row.h"

namespace candela {

MatteKind parse_matte_kind(std::string_view name) { return row_named(kMatteKinds, name, "unknown matte").kind; }

void MatteSums::add(std::size_t pixel, std::uint32_t number, float share) {
  std::vector<Matte>& list = pixels_[pixel];
  const auto found = std::find_if(list.begin(), list.end(), [&](const Matte& m) { return m.number == number; });
  if (found != list.end()) {
    found->coverage += share;
  } else {
    list.push_back({number, share});
  }
}

void MatteSums::add(const Mattes& mattes, float share) {
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    for (std::size_t r = 0; r < Mattes::kRanks && mattes.at(i)[r].coverage > 0.0f; ++r) {
      add(i, mattes.at(i)[r].number, share * mattes.at(i)[r].coverage);
    }
  }
}

void MatteSums::add(const MatteSums& other) {
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    for (const Matte& m : other.pixels_[i]) add(i, m.number, m.coverage);
  }
}

void MatteSums::write(std::vector<std::byte>& bytes) const {
  const auto append = [&](const auto& values) {
    const auto raw = std::as_bytes(std::span(values));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  for (const std::vector<Matte>& list : pixels_) {
    append(std::array{static_cast<std::uint32_t>(list.size())});
    append(list);
  }
}

void MatteSums::read(std::span<const std::byte>& bytes) {
  const auto take = [&](std::span<std::byte> into) {
    if (bytes.size() < into.size()) throw Error("the mattes end before their pixels do");
    std::copy_n(bytes.begin(), into.size(), into.begin());
    bytes = bytes.subspan(into.size());
  };
  for (std::vector<Matte>& list : pixels_) {
    std::array<std::uint32_t, 1> count{};
    take(std::as_writable_bytes(std::span(count)));
    if (count[0] > bytes.size() / sizeof(Matte)) throw Error("the mattes end before their pixels do");
    list.resize(count[0]);
    take(std::as_writable_bytes(std::span(list)));
    const auto is_possible = [](const Matte& m) { return m.coverage > 0.0f && std::isfinite(m.coverage); };
    if (!std::all_of(list.begin(), list.end(), is_possible)) throw Error("a matte is impossible");
  }
}

void MatteSums::rank(std::size_t pixel, float scale, Mattes& result) const {
  std::vector<Matte> list = pixels_[pixel];
  std::sort(list.begin(), list.end(), [](const Matte& a, const Matte& b) {
    return a.coverage != b.coverage ? a.coverage > b.coverage : a.number < b.number;
  });
  for (std::size_t r = 0; r < std::min(list.size(), Mattes::kRanks); ++r) {
    result.ranks[pixel * Mattes::kRanks + r] = {list[r].number, scale * list[r].coverage};
  }
}

std::vector<InstanceMask> MaskBuilder::build() const {
  std::vector<InstanceMask> masks;
  for (const auto& [node, pixels] : pixels_) {
    InstanceMask& mask = masks.emplace_back();
    ivec2 low = pixels.front(), high = pixels.front();
    for (const ivec2& p : pixels) low = glm::min(low, p), high = glm::max(high, p);
    mask.node = node;
    mask.corner = low;
    mask.size = high - low + 1;
    mask.bits.resize(static_cast<std::size_t>(mask.size.x) * static_cast<std::size_t>(mask.size.y));
    for (const ivec2& p : pixels) {
      const ivec2 at = p - low;
      mask.bits[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(mask.size.x) +
                static_cast<std::size_t>(at.x)] = true;
    }
  }
  return masks;
}

}  // namespace candela
