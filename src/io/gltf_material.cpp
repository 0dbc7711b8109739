#include "io/gltf_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "image/image_file.h"

namespace candela::io {

namespace {

// Eight bytes each at most: a hundred 4K textures fit, a folder of decompression bombs does not.
constexpr std::uint64_t kMaxTexels = std::uint64_t{1} << 31;
// A float of this size has no fraction left, so that no texture could be told apart from one texel.
constexpr float kLargestTransform = 1e6f;

/// One material while it is read: brings numbers into their range and says so.
class MaterialReader {
 public:
  MaterialReader(const JsonView& root, const JsonView& json, std::size_t index, Warnings& warnings)
      : root_(root), json_(json), warnings_(warnings) {
    material_.name = json.string_or("name");
    label_ = material_.name.empty() ? fmt::format("material {}", index) : fmt::format("material '{}'", material_.name);
  }

  Material read();

 private:
  float clamped(const JsonView& json, const char* key, float value, float lower, float upper);
  float factor(const JsonView& json, const char* key, float fallback, float lower = 0.0f, float upper = 1.0f);
  template <class V>
  V factors(const JsonView& json, const char* key, V fallback, float upper = 1.0f);
  TextureSlot slot(const JsonView& owner, const char* key);
  void read_metallic_roughness(const JsonView& json);
  void read_extensions();

  const JsonView& root_;
  const JsonView& json_;
  Warnings& warnings_;
  std::string label_;
  Material material_;
};

float MaterialReader::clamped(const JsonView& json, const char* key, float value, float lower, float upper) {
  const float result = std::clamp(value, lower, upper);
  if (result != value) warnings_.warn(fmt::format("{}: {} {} becomes {}", label_, key, value, result), json);
  return result;
}

float MaterialReader::factor(const JsonView& json, const char* key, float fallback, float lower, float upper) {
  return clamped(json, key, json.real_or(key, fallback), lower, upper);
}

template <class V>
V MaterialReader::factors(const JsonView& json, const char* key, V fallback, float upper) {
  V result = json.vector_or(key, fallback);
  for (int i = 0; i < V::length(); ++i) result[i] = clamped(json, key, result[i], 0.0f, upper);
  return result;
}

/// KHR_texture_transform: scale first, then rotate, then move. A positive angle turns the uvs counter-clockwise as seen
/// with v pointing down, i.e. u' = u cos + v sin, which is what viewers do; the GLSL printed in the extension turns the
/// other way.
void read_transform(const JsonView& json, TextureSlot& slot) {
  const vec2 offset = json.vector_or("offset", vec2(0));
  const vec2 scale = json.vector_or("scale", vec2(1));
  const float angle = json.real_or("rotation", 0.0f);
  const float c = std::cos(angle), s = std::sin(angle);
  slot.transform = {vec2(c, -s) * scale.x, vec2(s, c) * scale.y, offset};
  for (const vec2 column : slot.transform) {
    if (!(std::fabs(column.x) <= kLargestTransform && std::fabs(column.y) <= kLargestTransform)) {
      throw json.error(fmt::format("the texture transform is beyond {:g}", kLargestTransform));
    }
  }
}

TextureSlot MaterialReader::slot(const JsonView& owner, const char* key) {
  const auto info = owner.find(key);
  if (!info) return {};
  TextureSlot result;
  const std::size_t texture = info->at("index").index(count_of(root_, "textures"), "texture");
  std::uint64_t set = info->whole_or("texCoord", 0);
  if (const auto transform = info->extension("KHR_texture_transform")) {
    set = transform->whole_or("texCoord", set);
    read_transform(*transform, result);
  }
  if (set > 1) {
    warnings_.warn(
        fmt::format("{}: {} uses TEXCOORD_{}; only sets 0 and 1 are supported, so it is ignored", label_, key, set),
        *info);
    return {};
  }
  if (!root_.at("textures")[texture].find("source")) {
    warnings_.warn(fmt::format("{}: {} has no PNG or JPEG image and is ignored", label_, key), *info);
    return {};
  }
  result.texture = static_cast<int>(texture);
  result.uv_set = static_cast<int>(set);
  return result;
}

void MaterialReader::read_metallic_roughness(const JsonView& json) {
  const vec4 base = factors(json, "baseColorFactor", vec4(1));
  material_.base_color = vec3(base);
  material_.opacity = base.a;
  material_.base_color_texture = slot(json, "baseColorTexture");
  material_.metallic = factor(json, "metallicFactor", 1.0f);
  material_.roughness = factor(json, "roughnessFactor", 1.0f);
  material_.metallic_roughness_texture = slot(json, "metallicRoughnessTexture");
}

void MaterialReader::read_extensions() {
  if (const auto strength = json_.extension("KHR_materials_emissive_strength")) {
    material_.emission *= factor(*strength, "emissiveStrength", 1.0f, 0.0f, kInfinity);
    if (!is_finite(material_.emission)) throw strength->error("the emission is not finite");
  }
  if (const auto ior = json_.extension("KHR_materials_ior")) {
    const float value = ior->real_or("ior", 1.5f);
    // 0 is the compatibility mode; between 0 and 1 nothing is defined.
    material_.ior = value == 0.0f ? 0.0f : clamped(*ior, "ior", value, 1.0f, kInfinity);
  }
  if (const auto specular = json_.extension("KHR_materials_specular")) {
    material_.specular = factor(*specular, "specularFactor", 1.0f);
    material_.specular_texture = slot(*specular, "specularTexture");
    material_.specular_color = factors(*specular, "specularColorFactor", vec3(1), kInfinity);
    material_.specular_color_texture = slot(*specular, "specularColorTexture");
  }
  material_.unlit = json_.extension("KHR_materials_unlit").has_value();
}

Material MaterialReader::read() {
  if (const auto pbr = json_.find("pbrMetallicRoughness")) read_metallic_roughness(*pbr);
  if (const auto normal = json_.find("normalTexture")) {
    material_.normal_texture = slot(json_, "normalTexture");
    material_.normal_scale = normal->real_or("scale", 1.0f);
  }
  if (const auto occlusion = json_.find("occlusionTexture")) {
    material_.occlusion_texture = slot(json_, "occlusionTexture");
    material_.occlusion_strength = factor(*occlusion, "strength", 1.0f);
  }
  material_.emissive_texture = slot(json_, "emissiveTexture");
  material_.emission = factors(json_, "emissiveFactor", vec3(0));
  const std::string mode = json_.string_or("alphaMode", "OPAQUE");
  if (mode == "MASK") {
    material_.alpha_mode = AlphaMode::mask;
  } else if (mode == "BLEND") {
    material_.alpha_mode = AlphaMode::blend;
  } else if (mode != "OPAQUE") {
    throw json_.at("alphaMode").error("must be OPAQUE, MASK or BLEND");
  }
  material_.alpha_cutoff = factor(json_, "alphaCutoff", 0.5f, 0.0f, kInfinity);
  material_.double_sided = json_.boolean_or("doubleSided", false);
  read_extensions();
  return material_;
}

Wrap read_wrap(const JsonView& sampler, const char* key, Warnings& warnings) {
  const std::uint64_t value = sampler.whole_or(key, 10497);
  switch (value) {
    case 33071:
      return Wrap::clamp_to_edge;
    case 33648:
      return Wrap::mirrored_repeat;
    case 10497:
      return Wrap::repeat;
    default:
      warnings.warn(fmt::format("{} {} is not a wrap mode; repeating", key, value), sampler);
      return Wrap::repeat;
  }
}

Texture read_texture(const JsonView& root, const JsonView& json, Warnings& warnings) {
  Texture texture;
  texture.name = json.string_or("name");
  texture.image = static_cast<int>(json.at("source").index(count_of(root, "images"), "image"));
  if (const auto index = json.index_of("sampler", count_of(root, "samplers"), "sampler")) {
    const JsonView sampler = root.at("samplers")[*index];
    texture.wrap_u = read_wrap(sampler, "wrapS", warnings);
    texture.wrap_v = read_wrap(sampler, "wrapT", warnings);
    const std::uint64_t filter = sampler.whole_or("magFilter", 9729);
    if (filter == 9728) texture.filter = Filter::nearest;
    if (filter != 9728 && filter != 9729)
      warnings.warn(fmt::format("magFilter {} is unknown; linear", filter), sampler);
  }
  return texture;
}

ImageSource image_source(const JsonView& json, GltfBuffers& buffers) {
  ImageSource source{json, json.where(), {}, std::nullopt};
  const auto view = json.find("bufferView");
  const auto uri = json.find("uri");
  if (view && uri) throw json.error("has both a uri and a bufferView");
  if (!view && !uri) throw json.error("has neither a uri nor a bufferView");
  std::string name = json.string_or("name");
  if (uri && !uri->string().starts_with("data:")) name = uri->string();
  if (!name.empty()) source.label += fmt::format(" ({})", name);
  if (view) source.bytes = buffers.view(*view).bytes;
  if (uri) source.uri = uri;
  return source;
}

/// Replaces the file's texture and image indices by positions among those that are used.
void gather_textures(const JsonView& root, GltfBuffers& buffers, Warnings& warnings, MaterialSet& set) {
  std::map<int, int> texture_of_file;
  for (Material& material : set.materials) {
    for (const TextureSlot* slot : texture_slots(material)) {
      if (*slot) texture_of_file.emplace(slot->texture, 0);
    }
  }
  std::map<int, int> image_of_file;
  for (auto& [file_index, index] : texture_of_file) {
    index = static_cast<int>(set.textures.size());
    set.textures.push_back(read_texture(root, root.at("textures")[static_cast<std::size_t>(file_index)], warnings));
    image_of_file.emplace(set.textures.back().image, 0);
  }
  for (auto& [file_index, index] : image_of_file) {
    index = static_cast<int>(set.images.size());
    set.images.push_back(image_source(root.at("images")[static_cast<std::size_t>(file_index)], buffers));
  }
  for (Texture& texture : set.textures) texture.image = image_of_file.at(texture.image);
  for (Material& material : set.materials) {
    for (TextureSlot* slot : texture_slots(material)) {
      if (*slot) slot->texture = texture_of_file.at(slot->texture);
    }
  }
}

/// Names formats that glTF extensions allow and this loader does not read.
const char* foreign_format(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xABKTX 20\xBB")) return "KTX2";
  if (text.starts_with("RIFF") && text.substr(0, 12).ends_with("WEBP")) return "WebP";
  return text.starts_with("DDS ") ? "DDS" : nullptr;
}

}  // namespace

MaterialSet read_materials(const JsonView& root, const std::vector<bool>& used, bool want_default, GltfBuffers& buffers,
                           Warnings& warnings) {
  MaterialSet set;
  set.material_of_file.assign(used.size(), -1);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    set.material_of_file[i] = static_cast<int>(set.materials.size());
    const JsonView json = root.at("materials")[i];
    set.materials.push_back(MaterialReader(root, json, i, warnings).read());
  }
  if (want_default || set.materials.empty()) {
    set.default_material = static_cast<int>(set.materials.size());
    set.materials.emplace_back();
  }
  gather_textures(root, buffers, warnings, set);
  return set;
}

std::shared_ptr<const TextureImage> load_image(const ImageSource& source, const UriReader& uris, bool decode,
                                               std::atomic<std::uint64_t>& texels) {
  std::vector<std::byte> storage;
  if (source.uri) storage = uris.read(*source.uri);
  const std::span<const std::byte> bytes = source.uri ? std::span<const std::byte>(storage) : source.bytes;
  if (const char* format = foreign_format(bytes))
    throw Error(fmt::format("{} images are not supported", format), source.label);
  const ivec2 size = read_image_size(bytes, source.label);
  const std::uint64_t count = static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
  if (texels.fetch_add(count) + count > kMaxTexels) {
    throw Error(fmt::format("the textures have more than {} texels in total", kMaxTexels), source.json.where());
  }
  if (decode) return std::make_shared<const TextureImage>(decode_texture(bytes, source.label));
  auto image = std::make_shared<TextureImage>();
  image->width = size.x;
  image->height = size.y;
  return image;
}

}  // namespace candela::io
