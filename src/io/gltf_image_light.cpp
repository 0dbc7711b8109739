#include "io/gltf_image_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/memory.h"
#include "image/image_file.h"
#include "image/repair.h"
#include "image/rgbd.h"
#include "image/texture_file.h"
#include "io/gltf_material.h"
#include "io/gltf_nodes.h"
#include "scene/environment.h"

namespace candela::io {

namespace {

constexpr const char* kName = "EXT_lights_image_based";
constexpr std::size_t kHarmonics = 9;
constexpr float kBrightest = 1e12f;  // products with it are finite

using FaceIndices = std::array<std::size_t, 6>;

/// Which images the levels of the cube are made of.
std::vector<FaceIndices> read_levels(const JsonView& root, const JsonView& light) {
  const JsonView list = light.at("specularImages");
  if (list.size() == 0) throw list.error("the cube has no images");
  std::vector<FaceIndices> levels(list.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const JsonView faces = list[i];
    if (faces.size() != 6) throw faces.error(fmt::format("a level of a cube has 6 faces, this one {}", faces.size()));
    for (std::size_t k = 0; k < 6; ++k) levels[i][k] = faces[k].index(count_of(root, "images"), "image");
  }
  return levels;
}

/// The light that lights a scene, and its number; none where the scene names none.
std::optional<std::pair<JsonView, std::size_t>> find_light(const JsonView& root, std::size_t scene) {
  if (scene >= count_of(root, "scenes")) return std::nullopt;
  const auto use = root.at("scenes")[scene].extension(kName);
  if (!use) return std::nullopt;
  const auto lights = root.extension(kName);
  const std::size_t index = use->at("light").index(lights ? count_of(*lights, "lights") : 0, "image-based light");
  return std::pair(lights->at("lights")[index], index);
}

/// The irradiance that the file has beside the cube. Both engines integrate the cube itself, so that it is not used.
void check_harmonics(const JsonView& light, Warnings& warnings) {
  const auto list = light.find("irradianceCoefficients");
  if (!list) {
    warnings.warn("the light has no irradianceCoefficients, which other viewers need", light);
    return;
  }
  if (list->size() != kHarmonics) {
    throw list->error(fmt::format("there are {} coefficients, not {}", list->size(), kHarmonics));
  }
  for (std::size_t i = 0; i < kHarmonics; ++i) (*list)[i].reals(3);
}

class FaceReader {
 public:
  FaceReader(const UriReader& uris, int size, Warnings& warnings) : uris_(uris), size_(size), warnings_(warnings) {}

  /// The face as the file has it; empty without `decode`.
  Image read(const ImageSource& source, bool decode) {
    if (source.failure) throw Error(*source.failure);
    std::vector<std::byte> storage;
    if (source.uri) storage = uris_.read(*source.uri);
    const std::span<const std::byte> bytes = source.uri ? std::span<const std::byte>(storage) : source.bytes;
    const bool is_texture = sniff_texture(bytes).has_value();
    if (is_texture) {
      const TextureInfo info = parse_texture_info(bytes, source.label);
      check_size({info.width, info.height}, source.label);
      if (info.faces != 1) throw Error("a face is one picture, this is a cube map", source.label);
    } else {
      const ImageHeader header = read_image_header(bytes, source.label);
      check_size(header.size, source.label);
      if (const std::string oddity = image_oddity(header); !oddity.empty()) warnings_.warn(oddity, source.label);
    }
    if (!decode) return {};
    Image image = is_texture ? decode_texture_file(bytes, source.label).levels.at(0).at(0)
                             : image_from_rgbd(decode_texture(bytes, source.label));
    std::vector<Diagnostic> repairs;
    tell_repairs(repair(image), source.label, repairs);
    for (const Diagnostic& told : repairs) warnings_.warn(told.message, told.where);
    return image;
  }

 private:
  void check_size(ivec2 size, const std::string& label) const {
    if (size == ivec2(size_)) return;
    throw Error(fmt::format("a face of {0} x {1}, but specularImageSize is {2}", size.x, size.y, size_), label);
  }

  const UriReader& uris_;
  int size_;
  Warnings& warnings_;
};

/// Level 0 as the world's panorama, not turned; null without `decode`.
std::shared_ptr<const Image> read_panorama(const JsonView& root, const JsonView& light, const FaceIndices& images,
                                           int size, GltfBuffers& buffers, const UriReader& uris, bool decode,
                                           Warnings& warnings) {
  if (decode) {
    constexpr std::uint64_t kPerTexel = 40;  // of a face: as stored, as light, mirrored
    const auto side = static_cast<std::uint64_t>(size);
    require_memory(6 * side * side * kPerTexel, available_memory(),
                   fmt::format("an image-based light of {0} x {0} texels", size), light.where());
  }
  FaceReader reader(uris, size, warnings);
  CubeFaces faces;
  for (std::size_t k = 0; k < 6; ++k) {
    const Image face = reader.read(image_source(root.at("images")[images[k]], images[k], buffers), decode);
    if (decode) faces[k] = mirrored(face);
  }
  if (!decode) return nullptr;
  return std::make_shared<const Image>(panorama_of_cube(faces, light.where()));
}

/// Environment::rotation turns about +y and the panorama itself every other way.
void turn(Environment& environment, const quat& world_from_light) {
  constexpr float kUpright = 1e-6f;
  if (std::fabs(world_from_light.x) < kUpright && std::fabs(world_from_light.z) < kUpright) {
    environment.rotation = 2.0f * std::atan2(world_from_light.y, world_from_light.w);
  } else if (environment.map != nullptr) {
    environment.map = std::make_shared<const Image>(turned_panorama(*environment.map, world_from_light));
  }
}

}  // namespace

std::optional<ImageLight> read_image_light(const JsonView& root, std::size_t scene, GltfBuffers& buffers,
                                           const UriReader& uris, bool decode, KeptPanoramas* kept,
                                           Warnings& warnings) {
  const auto found = find_light(root, scene);
  if (!found) return std::nullopt;
  const auto& [light, index] = *found;

  ImageLight result;
  result.file_index = static_cast<int>(index);
  const std::vector<FaceIndices> levels = read_levels(root, light);
  result.levels = static_cast<int>(levels.size());
  const JsonView size = light.at("specularImageSize");
  constexpr std::uint64_t kMostSize = 16384;
  if (size.whole() < 1 || size.whole() > kMostSize) throw size.error(fmt::format("must be 1 to {}", kMostSize));
  result.size = static_cast<int>(size.whole());
  check_harmonics(light, warnings);

  Environment& environment = result.environment;
  environment.name = light.string_or("name");
  if (environment.name.empty()) environment.name = "the file's light";
  environment.intensity = light.real_or("intensity", 1.0f);
  if (environment.intensity < 0.0f || environment.intensity > kBrightest) {
    warnings.warn("an image-based light's intensity is out of range and clamped", light);
    environment.intensity = std::clamp(environment.intensity, 0.0f, kBrightest);
  }
  if (kept != nullptr && decode && kept->contains(index)) environment.map = kept->at(index);
  if (environment.map == nullptr) {
    environment.map = read_panorama(root, light, levels[0], result.size, buffers, uris, decode, warnings);
    if (kept != nullptr && decode) kept->emplace(index, environment.map);
  }
  if (const auto rotation = light.find("rotation")) turn(environment, read_rotation(*rotation, warnings));
  return result;
}

FileSurvey::Irradiance read_irradiance(const JsonView& root, std::size_t scene) {
  FileSurvey::Irradiance result;
  const auto found = find_light(root, scene);
  if (!found) return result;
  const JsonView& light = found->first;
  const auto list = light.find("irradianceCoefficients");
  if (!list || list->size() != kHarmonics) return result;
  for (std::size_t i = 0; i < kHarmonics; ++i) {
    const std::vector<float> rgb = (*list)[i].reals(3);
    result.coefficients.emplace_back(rgb[0], rgb[1], rgb[2]);
  }
  Diagnostics told;
  Warnings warnings(told);
  if (const auto rotation = light.find("rotation")) result.world_from_light = read_rotation(*rotation, warnings);
  return result;
}

}  // namespace candela::io
