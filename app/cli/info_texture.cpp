#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "cli/info.h"
#include "cli/json_text.h"
#include "cli/values.h"
#include "image/cube_metrics.h"
#include "image/texture_file.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

/// Levels are measured where their pixels take less than this; more would keep a question waiting.
constexpr std::uint64_t kMostMeasuredBytes = std::uint64_t{1} << 29;

std::uint64_t pixel_bytes(const TextureInfo& info) {
  return static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height) *
         static_cast<std::uint64_t>(info.faces) * 3 * sizeof(float);
}

struct LevelLight {
  double least, most, mean;
  std::uint64_t non_finite;
};

/// Luminance of a level, of a cube by solid angle.
LevelLight measure_level(const std::vector<Image>& faces) {
  if (faces.size() == 6) {
    CubeFaces cube;
    std::copy(faces.begin(), faces.end(), cube.begin());
    const CubeLevelLight light = measure_light(cube);
    return {light.least, light.most, light.mean, light.non_finite};
  }
  const Luminance light = measure(faces[0]);
  if (light.count == 0) return {0.0, 0.0, 0.0, light.non_finite};
  return {static_cast<double>(light.least), static_cast<double>(light.most), light.mean(), light.non_finite};
}

std::string kind_of(const TextureInfo& info) {
  if (info.depth > 1) return "volume";
  if (info.layers > 1) return info.faces == 6 ? "array of cube maps" : "array";
  return info.faces == 6 ? "cube map" : "2-D";
}

void describe_levels(const TextureInfo& info, const std::vector<std::vector<Image>>& levels, Json& json, Table& table) {
  json["levels"] = Json::array();
  table.row("levels", fmt::format("{}", info.level_bytes.size()));
  for (std::size_t i = 0; i < info.level_bytes.size(); ++i) {
    const int width = std::max(info.width >> i, 1), height = std::max(info.height >> i, 1);
    Json entry{{"width", width}, {"height", height}, {"bytes", info.level_bytes[i]}, {"luminance", nullptr}};
    std::string line = fmt::format("{} {} x {}", i, width, height);
    if (info.level_bytes[i] > 0) line += fmt::format(", {}", bytes_text(info.level_bytes[i]));
    if (!levels.empty()) {
      const LevelLight light = measure_level(levels[i]);
      entry["luminance"] = {{"min", light.least}, {"max", light.most}, {"mean", light.mean}};
      entry["non_finite_texels"] = light.non_finite;
      line += fmt::format(", luminance min {:.6g}, max {:.6g}, mean {:.6g}", light.least, light.most, light.mean);
      if (light.non_finite > 0) line += fmt::format(", {} not finite", counted(light.non_finite, "texel"));
    }
    json["levels"].push_back(std::move(entry));
    table.item(line);
  }
}

}  // namespace

bool is_texture_file(const fs::path& path) { return sniff_texture(read_head(path, 16)).has_value(); }

Report texture_report(const fs::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  const TextureInfo info = parse_texture_info(bytes, path.string());
  std::vector<std::vector<Image>> levels;
  if (info.is_read && pixel_bytes(info) <= kMostMeasuredBytes)
    levels = decode_texture_file(bytes, path.string()).levels;

  Json json{{"file", path.string()},
            {"kind", "texture"},
            {"container", container_name(info.container)},
            {"type", kind_of(info)},
            {"format", info.format},
            {"width", info.width},
            {"height", info.height},
            {"depth", info.depth},
            {"layers", info.layers},
            {"faces", info.faces},
            {"supercompression", info.supercompression},
            {"bytes", bytes.size()}};
  Table table;
  table.row("file", path.string());
  table.row("format", fmt::format("{}, {}", container_name(info.container), info.format));
  table.row("type", kind_of(info));
  table.row("size", fmt::format("{} x {}", info.width, info.height));
  table.row("file size", bytes_text(bytes.size()));
  if (info.supercompression != "none") table.row("packed by", info.supercompression);
  if (!info.is_read) table.row("pixels", "not read");
  describe_levels(info, levels, json, table);
  json["key_values"] = Json::object();
  for (const auto& [key, value] : info.key_values) {
    json["key_values"][key] = value;
    table.row(key, value);
  }
  return {table.text(), json_text(json)};
}

}  // namespace candela::cli
