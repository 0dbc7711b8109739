#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "image/image_file.h"
#include "io/gltf_document.h"
#include "io/gltf_warnings.h"
#include "io/texture_budget.h"
#include "scene/scene.h"

namespace candela::io {

/// Encoded bytes of one image: in a buffer view, or behind a URI that is read only when the image is decoded.
struct ImageSource {
  JsonView json;
  std::string label;  ///< file, pointer and name for errors
  int file_index = -1;
  std::span<const std::byte> bytes;
  std::optional<JsonView> uri;
  std::optional<Error> failure;  ///< why neither can be had
};

/// Where image `file_index` of the file has its bytes; why not, in ImageSource::failure.
ImageSource image_source(const JsonView& json, std::size_t file_index, GltfBuffers& buffers);

/// The materials that a scene uses and what they need, renumbered without gaps in the file's order.
struct MaterialSet {
  std::vector<Material> materials;
  std::vector<int> material_of_file;  ///< -1 = not used
  int default_material = -1;          ///< glTF's default, where it is wanted
  std::vector<Texture> textures;
  std::vector<ImageSource> images;
};

/// Gathers the materials with `used[i]`, which `read` gives by the file's indices as read_material does, plus the
/// default one when asked for or when there is no other.
MaterialSet read_materials(const JsonView& root, const std::vector<bool>& used, bool want_default,
                           const std::function<Material(std::size_t)>& read, GltfBuffers& buffers, Warnings& warnings);

/// Of all images of a file together, eight bytes each at most: a hundred 4K textures fit, a folder of decompression
/// bombs does not.
inline constexpr std::uint64_t kMostTexels = std::uint64_t{1} << 31;

/// What is odd about an image that can be read; empty where nothing is.
std::string image_oddity(const ImageHeader& header);

/// Decodes one image, or only measures it, and says what is odd about it. `texels` counts what is kept of all images
/// together; beyond kMostTexels none is decoded, the result is null, and the caller refuses the file. Throws Error for
/// what cannot be read. Thread-safe.
std::shared_ptr<const TextureImage> load_image(const ImageSource& source, const UriReader& uris, bool decode,
                                               const Reduction& reduction, std::atomic<std::uint64_t>& texels,
                                               std::string& oddity);

/// The size and the depth of an image; one texel where it cannot be read. Thread-safe.
TextureExtent measure_image(const ImageSource& source, const UriReader& uris);

/// Empties the slots that would read an image of the scene, and darkens what an emissive texture of it should make
/// glow; whether there was any.
bool drop_image(int image, std::span<const Texture> textures, std::span<Material> materials);

}  // namespace candela::io
