#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "check/check_parts.h"

namespace candela::check {

std::span<const LimitRow> limit_rows() {
  constexpr double kMost = 1e12;
  static constexpr auto kRows = std::to_array<LimitRow>({
      {"albedo-too-bright", &Limits::brightest_albedo, 0.0, 1.0},
      {"albedo-too-dark", &Limits::darkest_albedo, 0.0, 1.0},
      {"metal-too-dark", &Limits::darkest_metal, 0.0, 1.0},
      {"roughness-zero", &Limits::least_roughness, 0.0, 1.0},
      {"too-many-triangles", &Limits::triangles, 0.0, kMost},
      {"too-many-materials", &Limits::materials, 0.0, kMost},
      {"texture-too-large", &Limits::texture_size, 1.0, kMost},
      {"textures-too-heavy", &Limits::texture_megabytes, 0.0, kMost},
  });
  return kRows;
}

std::span<const std::string> finding_codes() {
  static const std::array<std::string, 59> codes{
      "albedo-too-bright",
      "albedo-too-dark",
      "attenuation-out-of-scale",
      "base-color-is-normal-map",
      "blend-but-opaque",
      "data-as-color",
      "degenerate-triangles",
      "dispersion-too-strong",
      "emission-too-bright",
      "emission-too-faint",
      "extension-ignored",
      "extension-missing",
      "extension-uncommon",
      "file-oddity",
      "file-outside",
      "invisible",
      "ior-too-high",
      "irradiance-contradicts",
      "ktx-format",
      "ktx-orientation",
      "ktx-premultiplied",
      "ktx-primaries",
      "ktx-size",
      "ktx-swizzle",
      "ktx-transfer",
      "light-too-bright",
      "light-without-unit",
      "metal-too-dark",
      "metallic-between",
      "no-effect",
      "nodes-hidden",
      "normal-map-as-other",
      "normal-map-flipped-y",
      "normal-map-inward",
      "normal-map-not-unit",
      "normal-map-srgb",
      "normals-against-winding",
      "normals-not-unit",
      "nothing-to-see",
      "occlusion-black",
      "roughness-zero",
      "size-unlikely",
      "specular-too-bright",
      "tangents-missing",
      "texture-too-large",
      "texture-unreadable",
      "texture-without-effect",
      "textures-too-heavy",
      "thickness-mismatch",
      "too-many-materials",
      "too-many-triangles",
      "unreadable",
      "uv-missing",
      "vertex-far-out",
      "volume-inconsistent-winding",
      "volume-inside-out",
      "volume-open",
      "volume-unmeasured",
      "volume-without-transmission",
  };
  return codes;
}

namespace {

void add(const char* code, std::string message, double value, double limit, std::vector<Finding>& findings) {
  Finding f;
  f.severity = Severity::warning;
  f.code = code;
  f.message = std::move(message);
  f.measured = {{"value", value}, {"limit", limit}};
  findings.push_back(std::move(f));
}

void check_images_size(const Scene& scene, const Limits& limits, std::vector<Finding>& findings) {
  double bytes = 0.0;
  std::vector<bool> is_told(scene.images.size());
  for (const auto& image : scene.images) {
    bytes += 4.0 * image->width * image->height * image->bits / 8.0;
  }
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const auto index = static_cast<std::size_t>(scene.textures[i].image);
    if (index >= scene.images.size() || is_told[index]) continue;
    const TextureImage& image = *scene.images[index];
    const int side = std::max(image.width, image.height);
    if (side <= limits.texture_size) continue;
    is_told[index] = true;
    add("texture-too-large",
        fmt::format("{} x {} texels; the limit is {:.0f} a side", image.width, image.height, limits.texture_size), side,
        limits.texture_size, findings);
    findings.back().texture = static_cast<int>(i);
  }
  constexpr double kMega = 1e6;
  if (bytes <= limits.texture_megabytes * kMega) return;
  add("textures-too-heavy",
      fmt::format("decoded images take {:.4g} MB; the limit is {:.4g}", bytes / kMega, limits.texture_megabytes),
      bytes / kMega, limits.texture_megabytes, findings);
}

}  // namespace

void check_size(const CheckInput& input, std::vector<Finding>& findings) {
  const Scene& scene = input.scene;
  const Limits& limits = input.limits;
  double triangles = 0.0;
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) triangles += static_cast<double>(primitive.triangles.size());
  }
  if (triangles > limits.triangles) {
    add("too-many-triangles", fmt::format("{:.0f} triangles; the limit is {:.0f}", triangles, limits.triangles),
        triangles, limits.triangles, findings);
  }
  const auto materials = static_cast<double>(scene.materials.size());
  if (materials > limits.materials) {
    add("too-many-materials", fmt::format("{:.0f} materials; the limit is {:.0f}", materials, limits.materials),
        materials, limits.materials, findings);
  }
  check_images_size(scene, limits, findings);
}

}  // namespace candela::check
