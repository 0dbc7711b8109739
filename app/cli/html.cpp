#include "cli/html.h"

#include <fmt/format.h>

#include <cstddef>
#include <span>

#include "figures/markup.h"
#include "image/image_file.h"

namespace candela::cli {

namespace {

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return k < bytes.size() ? static_cast<unsigned>(bytes[k]) : 0U; };
    const unsigned word = byte(i) << 16U | byte(i + 1) << 8U | byte(i + 2);
    for (unsigned k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[word >> (18U - 6U * k) & 63U];
    }
  }
  return text;
}

std::string data_element(const char* type, std::span<const std::byte> bytes, const std::string& what) {
  return fmt::format("<img alt=\"{}\" src=\"data:{};base64,{}\">\n", figures::escaped(what), type, base64(bytes));
}

}  // namespace

std::string image_element(const DisplayImage& image, const std::string& what) {
  const TextureImage texture{image.width, image.height, 8, true, image.rgba};
  return data_element("image/png", encode_png(texture), what);
}

std::string svg_element(const std::string& svg, const std::string& what) {
  return data_element("image/svg+xml", std::as_bytes(std::span(svg)), what);
}

}  // namespace candela::cli
