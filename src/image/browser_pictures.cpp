#include "image/browser_pictures.h"

#include <map>
#include <utility>

#include "base/file.h"
#include "image/image_file.h"

namespace candela {

namespace {

/// A page has one thread that reads scenes.
struct Given {
  TextureImage picture;
  bool is_needed = false;  ///< there is no other decoder
};
std::map<std::pair<std::uint64_t, std::size_t>, Given>& pictures() {
  static std::map<std::pair<std::uint64_t, std::size_t>, Given> all;
  return all;
}

std::pair<std::uint64_t, std::size_t> key_of(std::span<const std::byte> bytes) {
  return {fingerprint(bytes), bytes.size()};
}

}  // namespace

void give_browser_picture(std::span<const std::byte> bytes, TextureImage picture) {
  pictures()[key_of(bytes)] = {std::move(picture), sniff_image_format(bytes) == ImageFormat::avif};
}

const TextureImage* find_browser_picture(std::span<const std::byte> bytes) {
  const auto found = pictures().find(key_of(bytes));
  return found == pictures().end() ? nullptr : &found->second.picture;
}

void forget_other_browser_pictures() {
  std::erase_if(pictures(), [](const auto& entry) { return !entry.second.is_needed; });
}

void forget_browser_pictures() { pictures().clear(); }

}  // namespace candela
