#include "io/gltf_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <set>

#include "base/parallel.h"
#include "image/image_file.h"
#include "io/foreign_scene.h"
#include "io/gltf_files.h"
#include "io/gltf_image_light.h"
#include "io/gltf_material.h"
#include "io/gltf_material_reader.h"
#include "io/gltf_mesh.h"
#include "io/gltf_nodes.h"
#include "io/scene_files.h"
#include "scene/material_table.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kTriangles = 4;  // glTF 2.0 §5.24.4: below are points and lines, above strips and fans

// As the Khronos glTF-Validator: a little more than normalised bytes may be off.
constexpr float kLengthTolerance = 0.00674f;

std::uint32_t big_endian(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  return value;
}

/// Depth and alpha of a PNG. ISO/IEC 15948:2004, §11.2.2 (IHDR) and §11.3.2.1 (tRNS, which comes before IDAT).
void read_png_header(std::span<const std::byte> bytes, FileSurvey::Image& image) {
  constexpr std::size_t kSignature = 8, kDepth = 24, kColorType = 25, kChunkFrame = 12;
  if (bytes.size() <= kColorType) return;
  image.bits = bytes[kDepth] == std::byte{16} ? 16 : 8;
  image.has_alpha = (bytes[kColorType] & std::byte{4}) != std::byte{0};
  for (std::size_t at = kSignature; at + kChunkFrame <= bytes.size();) {
    const std::uint32_t type = big_endian(bytes, at + 4);
    constexpr std::uint32_t kTransparency = 0x74524E53, kData = 0x49444154;
    if (type == kTransparency) image.has_alpha = true;
    if (type == kData) return;
    at += kChunkFrame + big_endian(bytes, at);
  }
}

void read_texture_header(std::span<const std::byte> bytes, const std::string& label, FileSurvey::Image& image) {
  image.texture = parse_texture_info(bytes, label);
  const TextureInfo& info = *image.texture;
  image.format = fmt::format("{}, {}", container_name(info.container), info.format);
  if (info.supercompression != "none") image.format += ", " + info.supercompression;
  const bool is_coded = info.block ? !info.block->is_hdr : !info.texel || texel_layout(*info.texel).type_bytes == 1;
  image.bits = is_coded ? 8 : 16;
  image.has_alpha = info.texel ? texel_layout(*info.texel).channels == 4 : info.channels == TextureChannels::rgba;
}

/// Whether a triangle has no area but for rounding, whichever way the compiler multiplies and adds.
bool is_flat(const dvec3& a, const dvec3& b, const dvec3& c) {
  constexpr double kSine = 1e-14;
  const dvec3 e = b - a, f = c - a, n = glm::cross(e, f);
  return glm::dot(n, n) <= kSine * kSine * glm::dot(e, e) * glm::dot(f, f);
}

struct NormalLengths {
  std::size_t count = 0;
  std::size_t off_unit = 0;
  float worst = 1.0f;
};

NormalLengths measure_lengths(std::span<const vec3> normals) {
  NormalLengths result;
  result.count = normals.size();
  for (const vec3 n : normals) {
    const float length = glm::length(n);
    if (std::fabs(length - 1.0f) > kLengthTolerance) ++result.off_unit;
    if (std::fabs(length - 1.0f) > std::fabs(result.worst - 1.0f)) result.worst = length;
  }
  return result;
}

/// One pass over a file, with the loader's own parts.
class Surveyor {
 public:
  Surveyor(const GltfDocument& document, const UriReader& uris, std::size_t file_bytes, Warnings& warnings)
      : root_(document.root()),
        uris_(uris),
        warnings_(warnings),
        buffers_(document, uris),
        reader_(root_, buffers_, file_bytes, warnings) {}

  FileSurvey survey(const SurveyOptions& options);

 private:
  void find_meshes(const std::string& scene);
  void find_materials();
  void survey_images(bool decode, FileSurvey& result) const;
  FileSurvey::Image survey_image(const ImageSource& source, bool decode, std::atomic<std::uint64_t>& texels) const;
  FileSurvey::Primitive survey_primitive(const JsonView& json);
  void count_degenerate(const JsonView& json, FileSurvey::Primitive& result);
  void measure_normals(const JsonView& attributes, FileSurvey::Primitive& result);
  const std::vector<vec3>& positions(const JsonView& reference);

  JsonView root_;
  const UriReader& uris_;
  Warnings& warnings_;
  GltfBuffers buffers_;
  AccessorReader reader_;
  std::set<std::size_t> meshes_;  ///< that the scene shows
  MaterialSet materials_;
  // Primitives may share accessors: each is read once.
  std::map<std::uint64_t, std::vector<vec3>> positions_;
  std::map<std::uint64_t, NormalLengths> normals_;
};

const std::vector<vec3>& Surveyor::positions(const JsonView& reference) {
  const auto [found, is_new] = positions_.try_emplace(reference.whole());
  if (is_new) found->second = reader_.read_as<vec3>(reader_.open(reference, {"VEC3"}));
  return found->second;
}

void Surveyor::find_meshes(const std::string& scene) {
  for (const FileNode& node : read_nodes(root_, find_scene(root_, scene), warnings_).nodes) {
    if (node.is_used && node.mesh) meshes_.insert(*node.mesh);
  }
}

void Surveyor::find_materials() {
  std::vector<bool> used(count_of(root_, "materials"), false);
  bool want_default = false;
  for (const std::size_t index : meshes_) {
    const JsonView primitives = root_.at("meshes")[index].at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      if (primitives[i].whole_or("mode", kTriangles) < kTriangles) continue;
      if (const auto material = material_of_primitive(primitives[i], used.size(), std::nullopt)) {
        used[*material] = true;
      } else {
        want_default = true;
      }
    }
  }
  const auto read = [&](std::size_t index) {
    return read_material(root_, root_.at("materials")[index], index, warnings_);
  };
  materials_ = read_materials(root_, used, want_default, read, buffers_, warnings_);
}

FileSurvey::Image Surveyor::survey_image(const ImageSource& source, bool decode,
                                         std::atomic<std::uint64_t>& texels) const {
  FileSurvey::Image image;
  image.name = source.json.string_or("name");
  if (image.name.empty() && source.uri && !source.uri->string().starts_with("data:")) image.name = source.uri->string();
  image.file_index = source.file_index;
  try {
    if (source.failure) throw Error(*source.failure);
    std::vector<std::byte> storage;
    if (source.uri) storage = uris_.read(*source.uri);
    const std::span<const std::byte> bytes = source.uri ? std::span<const std::byte>(storage) : source.bytes;
    image.file_bytes = bytes.size();
    const ImageFormat format = sniff_image_format(bytes);
    image.format = format_name(format);
    if (format == ImageFormat::png) read_png_header(bytes, image);
    if (sniff_texture(bytes) == TextureContainer::ktx2) read_texture_header(bytes, source.label, image);
    if (format == ImageFormat::webp || format == ImageFormat::avif) {
      const ImageHeader header = read_image_header(bytes, source.label);
      image.bits = header.bits;
      image.has_alpha = header.has_alpha;
    }
    std::string oddity;
    const auto read = load_image({source.json, source.label, source.file_index, bytes, std::nullopt, std::nullopt},
                                 uris_, decode, {}, texels, oddity);
    if (read == nullptr) {
      throw Error(fmt::format("the textures have more than {} texels in total", kMostTexels), source.label);
    }
  } catch (const Error& error) {
    image.error = error.what();
  }
  return image;
}

void Surveyor::survey_images(bool decode, FileSurvey& result) const {
  result.images.resize(materials_.images.size());
  std::atomic<std::uint64_t> texels = 0;
  parallel_for(0, result.images.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result.images[i] = survey_image(materials_.images[i], decode, texels);
  });
}

void Surveyor::count_degenerate(const JsonView& json, FileSurvey::Primitive& result) {
  const std::vector<vec3>& vertices = positions(json.at("attributes").at("POSITION"));
  std::vector<std::uint32_t> indices;
  const auto reference = json.find("indices");
  if (reference) indices = reader_.read_indices(reader_.open(*reference, {"SCALAR"}), vertices.size());
  const std::size_t count = reference ? indices.size() : vertices.size();
  if (mode_of_primitive(json) != kTriangles) {
    // Strips turn round by triangles without an area, on purpose.
    result.triangles = count > 2 ? count - 2 : 0;
    return;
  }
  const auto corner = [&](std::size_t i) { return dvec3(vertices[reference ? indices[i] : i]); };
  result.triangles = count / 3;
  for (std::size_t i = 0; i + 2 < count; i += 3) {
    if (is_flat(corner(i), corner(i + 1), corner(i + 2))) ++result.degenerate;
  }
}

void Surveyor::measure_normals(const JsonView& attributes, FileSurvey::Primitive& result) {
  const auto reference = attributes.find("NORMAL");
  if (!reference) return;
  const auto [found, is_new] = normals_.try_emplace(reference->whole());
  if (is_new) {
    found->second = measure_lengths(reader_.read_as<vec3>(reader_.open(*reference, {"VEC3"})));
  }
  result.normals = found->second.count;
  result.normals_off_unit = found->second.off_unit;
  result.worst_normal_length = found->second.worst;
}

FileSurvey::Primitive Surveyor::survey_primitive(const JsonView& json) {
  reader_.begin_primitive(json);
  FileSurvey::Primitive result;
  result.where = json.where();
  const JsonView attributes = json.at("attributes");
  const auto material = material_of_primitive(json, materials_.material_of_file.size(), std::nullopt);
  result.material = material ? materials_.material_of_file[*material] : materials_.default_material;
  count_degenerate(json, result);
  measure_normals(attributes, result);
  // Tangents without normals are to be ignored, glTF 2.0 §3.7.2.1.
  result.has_tangents = attributes.find("TANGENT") && attributes.find("NORMAL");
  std::set<int> missing;
  for (const TextureSlot* slot : texture_slots(materials_.materials[static_cast<std::size_t>(result.material)])) {
    if (*slot && !attributes.find(uv_set_name(static_cast<std::size_t>(slot->uv_set)).c_str()))
      missing.insert(slot->uv_set);
  }
  result.missing_uv_sets.assign(missing.begin(), missing.end());
  return result;
}

FileSurvey Surveyor::survey(const SurveyOptions& options) {
  FileSurvey result;
  find_meshes(options.scene);
  find_materials();
  survey_images(options.decode_images, result);
  result.irradiance = read_irradiance(root_, find_scene(root_, options.scene));
  if (!options.read_geometry) return result;
  for (const std::size_t index : meshes_) {
    const JsonView primitives = root_.at("meshes")[index].at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const JsonView json = primitives[i];
      const bool is_surface = json.whole_or("mode", kTriangles) >= kTriangles;
      if (is_surface && json.at("attributes").find("POSITION")) result.primitives.push_back(survey_primitive(json));
    }
  }
  return result;
}

FileSurvey survey(const SceneSource& source, const SurveyOptions& options) {
  Diagnostics diagnostics;
  Warnings warnings(diagnostics);
  const GltfDocument document(source.bytes, source.label, diagnostics);
  const UriReader uris(source.files);
  check_references(document.root(), document.json(), uris);
  FileSurvey result = Surveyor(document, uris, source.bytes.size(), warnings).survey(options);
  for (auto& [pointer, name] : names_outside(document.json(), uris)) {
    result.outside.push_back({source.label + '#' + pointer, std::move(name)});
  }
  return result;
}

}  // namespace

FileSurvey survey_gltf(const fs::path& path, const SurveyOptions& options) {
  Diagnostics ignored;
  return survey(open_gltf(path, options.root, options.measures, ignored), options);
}

FileSurvey survey_gltf(std::span<const std::byte> bytes, const fs::path& base_folder, const SurveyOptions& options) {
  return survey(open_scene({bytes.begin(), bytes.end()}, base_folder, "glTF in memory", options.root), options);
}

}  // namespace candela::io
