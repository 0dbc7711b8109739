#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "base/file.h"
#include "cli/info.h"
#include "cli/values.h"
#include "image/cube_layout.h"
#include "image/image_file.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

ImageFormat format_of(const fs::path& path) { return sniff_image_format(read_head(path, 16)); }

/// "albedo" of "albedo.R"; channels without a dot are the picture itself.
std::set<std::string> layer_names(const std::vector<std::string>& channels) {
  std::set<std::string> layers;
  for (const std::string& channel : channels) {
    const std::size_t dot = channel.rfind('.');
    if (dot != std::string::npos) layers.insert(channel.substr(0, dot));
  }
  return layers;
}

bool is_black(const Image& image, int x0, int y0, int width, int height) {
  for (int y = y0; y < y0 + height; ++y)
    for (int x = x0; x < x0 + width; ++x)
      if (image.rgb(x, y) != vec3(0.0f)) return false;
  return true;
}

/// What cube map a picture may be. Crosses have the shape of many a photograph, so their empty corner counts.
std::optional<CubeLayout> cube_layout_of(const Image& image) {
  const std::optional<CubeLayout> layout = detect_layout(image.width, image.height);
  if (layout == CubeLayout::cross_4x3 && !is_black(image, 0, 0, image.width / 4, image.height / 3)) return std::nullopt;
  if (layout == CubeLayout::cross_3x4 && !is_black(image, 0, 0, image.width / 3, image.height / 4)) return std::nullopt;
  return layout;
}

}  // namespace

Luminance measure(const Image& image) {
  Luminance result;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float value = luminance(image.rgb(x, y));
      if (!std::isfinite(value)) {
        ++result.non_finite;
        continue;
      }
      result.least = std::min(result.least, value);
      result.most = std::max(result.most, value);
      result.sum += static_cast<double>(value);
      ++result.count;
    }
  }
  return result;
}

bool is_image_file(const fs::path& path) { return format_of(path) != ImageFormat::unknown; }

Report image_report(const fs::path& path) {
  const ImageFormat format = format_of(path);
  const Image image = read_image(path);
  const Luminance light = measure(image);
  ExrHeader header;
  if (format == ImageFormat::exr) header = read_exr_header(path);

  nlohmann::ordered_json json{{"file", path.string()},         {"kind", "image"},
                              {"format", format_name(format)}, {"width", image.width},
                              {"height", image.height},        {"channels", image.channels},
                              {"luminance", nullptr},          {"non_finite_pixels", light.non_finite},
                              {"cube_layout", nullptr}};
  Table table;
  table.row("file", path.string());
  table.row("format", format_name(format));
  table.row("size", fmt::format("{} x {}", image.width, image.height));
  table.row("channels", format == ImageFormat::exr ? fmt::format("{}", fmt::join(header.channels, " "))
                                                   : fmt::format("{}", image.channels));
  if (light.count > 0) {
    json["luminance"] = {{"min", light.least}, {"max", light.most}, {"mean", light.mean()}};
    table.row("luminance", fmt::format("min {:.6g}, max {:.6g}, mean {:.6g}", light.least, light.most, light.mean()));
  }
  if (const std::optional<CubeLayout> layout = cube_layout_of(image)) {
    json["cube_layout"] = layout_name(*layout);
    table.row("cube map", fmt::format("perhaps: it has the shape of a {}", layout_name(*layout)));
  }
  if (light.non_finite > 0) table.row("not finite", fmt::format("{} pixels", light.non_finite));
  if (format == ImageFormat::exr) {
    const auto layers = layer_names(header.channels);
    json["exr_channels"] = header.channels;
    json["layers"] = layers;
    json["metadata"] = header.metadata;
    if (!layers.empty()) table.row("layers", fmt::format("{}", fmt::join(layers, " ")));
    for (const auto& [name, value] : header.metadata) table.row(name, value);
  }
  return {table.text(), json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n"};
}

}  // namespace candela::cli
