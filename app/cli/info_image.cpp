#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/file.h"
#include "base/text.h"
#include "cli/info.h"
#include "cli/json_text.h"
#include "cli/values.h"
#include "image/cube_layout.h"
#include "image/image_file.h"

namespace candela::cli {

namespace {

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

bool is_image_file(const std::string& name) {
  return sniff_image_format(read_head(parse_image_name(name).path, kSniffedBytes)) != ImageFormat::unknown;
}

Report image_report(const std::string& text) {
  const ImageName name = parse_image_name(text);
  const ImageFile file = read_image_file(name);
  const Image& image = file.image;
  const Luminance light = measure(image);
  ExrHeader header;
  if (file.format == ImageFormat::exr) header = read_exr_header(name.path);

  nlohmann::ordered_json json{{"file", text},
                              {"kind", "image"},
                              {"format", format_name(file.format)},
                              {"width", image.width},
                              {"height", image.height},
                              {"channels", image.channels},
                              {"luminance", nullptr},
                              {"non_finite_pixels", light.non_finite},
                              {"cube_layout", nullptr}};
  Table table;
  table.row("file", text);
  table.row("format", format_name(file.format));
  table.row("size", fmt::format("{} x {}", image.width, image.height));
  table.row("channels", file.format == ImageFormat::exr ? fmt::format("{}", fmt::join(header.channels, " "))
                                                        : fmt::format("{}", image.channels));
  if (light.count > 0) {
    json["luminance"] = {{"min", light.least}, {"max", light.most}, {"mean", light.mean()}};
    table.row("luminance", fmt::format("min {:.6g}, max {:.6g}, mean {:.6g}", light.least, light.most, light.mean()));
  }
  const std::optional<CubeLayout> layout = cube_layout_of(image);
  if (layout && file.projection == Projection::unsaid) {
    json["cube_layout"] = layout_name(*layout);
    table.row("cube map", fmt::format("perhaps: it has the shape of a {}", layout_name(*layout)));
  }
  if (light.non_finite > 0) table.row("not finite", counted(light.non_finite, "pixel"));
  json["attributes"] = nlohmann::ordered_json::array();
  for (const ImageFact& fact : file.facts) {
    json["attributes"].push_back(
        {{"name", fact.name}, {"value", fact.value}, {"done", fact.done}, {"warning", fact.is_odd}});
    table.row(fact.name, fact.value + ": " + fact.done);
  }
  if (file.format == ImageFormat::exr) {
    json["exr_channels"] = header.channels;
    json["layers"] = header.layers;
    json["metadata"] = header.metadata;
    if (!header.layers.empty()) table.row("layers", fmt::format("{}", fmt::join(header.layers, " ")));
    for (const auto& [key, value] : header.metadata) table.row(key, value);
  }
  return {table.text(), json_text(json)};
}

}  // namespace candela::cli
