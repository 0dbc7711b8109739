#include "io/gltf_material.h"

#include <fmt/format.h>

#include <map>
#include <string_view>

#include "image/image_file.h"
#include "io/gltf_material_reader.h"
#include "scene/material_table.h"

namespace candela::io {

namespace {

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
  texture.image = static_cast<int>(texture_source(json).value().index(count_of(root, "images"), "image"));
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
    set.textures.back().file_index = file_index;
    image_of_file.emplace(set.textures.back().image, 0);
  }
  for (auto& [file_index, index] : image_of_file) {
    index = static_cast<int>(set.images.size());
    const auto number = static_cast<std::size_t>(file_index);
    set.images.push_back(image_source(root.at("images")[number], number, buffers));
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
  return text.starts_with("DDS ") ? "DDS" : nullptr;
}

}  // namespace

ImageSource image_source(const JsonView& json, std::size_t file_index, GltfBuffers& buffers) {
  ImageSource source{json, json.where(), static_cast<int>(file_index), {}, std::nullopt, std::nullopt};
  const auto view = json.find("bufferView");
  const auto uri = json.find("uri");
  if (view && uri) source.failure = json.error("the image has both a uri and a bufferView");
  if (!view && !uri) source.failure = json.error("the image has neither a uri nor a bufferView");
  if (source.failure) return source;
  std::string name = json.string_or("name");
  if (uri && !uri->string().starts_with("data:")) name = uri->string();
  if (!name.empty()) source.label += fmt::format(" ({})", name);
  source.uri = uri;
  try {
    if (view) source.bytes = buffers.view(*view).bytes;
  } catch (const Error& error) {
    source.failure = Error(error.message(), source.label);
  }
  return source;
}

std::string image_oddity(const ImageHeader& header) {
  std::string text;
  for (const ImageFact& fact : header.facts) {
    if (fact.is_odd) text += (text.empty() ? "" : "; ") + fmt::format("{} ({}): {}", fact.name, fact.value, fact.done);
  }
  return text;
}

MaterialSet read_materials(const JsonView& root, const std::vector<bool>& used, bool want_default,
                           const std::function<Material(std::size_t)>& read, GltfBuffers& buffers, Warnings& warnings) {
  MaterialSet set;
  set.material_of_file.assign(used.size(), -1);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    set.material_of_file[i] = static_cast<int>(set.materials.size());
    set.materials.push_back(read(i));
    set.materials.back().file_index = static_cast<int>(i);
  }
  if (want_default || set.materials.empty()) {
    set.default_material = static_cast<int>(set.materials.size());
    set.materials.emplace_back();
    set.materials.back().file_index = static_cast<int>(used.size());
  }
  gather_textures(root, buffers, warnings, set);
  return set;
}

namespace {

/// Calls `f` with the bytes of an image, wherever they are.
template <class F>
auto with_bytes(const ImageSource& source, const UriReader& uris, const F& f) {
  if (source.failure) throw Error(*source.failure);
  std::vector<std::byte> storage;
  if (source.uri) storage = uris.read(*source.uri);
  const std::span<const std::byte> bytes = source.uri ? std::span<const std::byte>(storage) : source.bytes;
  if (const char* format = foreign_format(bytes))
    throw Error(fmt::format("{} images are not supported", format), source.label);
  return f(bytes, read_image_header(bytes, source.label));
}

std::uint64_t texel_count(ivec2 size) {
  return static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
}

}  // namespace

std::shared_ptr<const TextureImage> load_image(const ImageSource& source, const UriReader& uris, bool decode,
                                               const Reduction& reduction, std::atomic<std::uint64_t>& texels,
                                               std::string& oddity) {
  using Result = std::shared_ptr<const TextureImage>;
  return with_bytes(source, uris, [&](std::span<const std::byte> bytes, const ImageHeader& header) -> Result {
    oddity = image_oddity(header);
    const std::uint64_t count = texel_count(size_of_level(header.size, reduction.level));
    if (texels.fetch_add(count) + count > kMostTexels) return nullptr;
    if (decode) {
      TextureImage image = decode_texture(bytes, source.label);
      if (reduction.level > 0) image = reduced(image, reduction.level, reduction.kind);
      return std::make_shared<const TextureImage>(std::move(image));
    }
    auto image = std::make_shared<TextureImage>();
    image->width = header.size.x;
    image->height = header.size.y;
    return image;
  });
}

TextureExtent measure_image(const ImageSource& source, const UriReader& uris) {
  try {
    return with_bytes(source, uris, [](std::span<const std::byte>, const ImageHeader& header) {
      return TextureExtent{.size = header.size, .bits = header.bits};
    });
  } catch (const Error&) {
    return {};  // what it is replaced by
  }
}

bool drop_image(int image, std::span<const Texture> textures, std::span<Material> materials) {
  bool is_dark = false;
  for (Material& material : materials) {
    for (TextureSlot* slot : texture_slots(material)) {
      if (!*slot || textures[static_cast<std::size_t>(slot->texture)].image != image) continue;
      if (slot == &material.emissive_texture) {
        is_dark |= material.emission != vec3(0.0f);
        material.emission = vec3(0.0f);
      }
      if (slot == &material.height_texture) material.height_scale = 0.0f;
      *slot = {};
    }
  }
  return is_dark;
}

}  // namespace candela::io
