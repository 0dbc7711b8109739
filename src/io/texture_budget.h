#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "image/reduced.h"
#include "scene/scene.h"

namespace candela::io {

/// How an image is to be kept.
struct Reduction {
  int level = 0;  ///< so often it is halved
  TexelKind kind = TexelKind::data;
};

/// An image that has to share memory with others.
struct TextureExtent {
  ivec2 size{1};
  int bits = 8;
  int copies = 1;        ///< that are kept of it
  bool is_here = false;  ///< decoded before, and as large as it stays
};

/// What materials read each of a scene's images as, and of how many kinds (colours, numbers) that is.
struct ImageUses {
  std::vector<TexelKind> kinds;
  std::vector<int> copies;
};
ImageUses uses_of_images(std::span<const Material> materials, std::span<const Texture> textures, std::size_t images);

/// LoadOptions::texture_memory, and whether all smaller levels count.
struct TextureBudget {
  std::uint64_t bytes = 0;
  bool counts_levels = false;
};

/// What an image takes once it has been halved so often.
std::uint64_t texture_bytes(const TextureExtent& image, int level, bool counts_levels);

/// Which images are halved how often, and which are decoded at a time.
struct TexturePlan {
  std::vector<int> levels;                        ///< by image
  std::vector<std::vector<std::size_t>> batches;  ///< one after the other, without those that are here
  std::string told;                               ///< what is dropped, for people; empty where nothing is
};

/// The largest loses a level, of equal ones the first, again and again until all fit. A batch is as long as what is
/// kept by then and one image at its full size for each of `threads` fit too, or a single image: beyond the budget
/// there never is more than one. The levels do not depend on `threads`. Throws Error where one texel of each is too
/// much.
TexturePlan plan_textures(std::span<const TextureExtent> images, const TextureBudget& budget, int threads);

/// Makes the images of a scene that was made in memory fit, which is one warning, said of `where`.
void fit_textures(Scene& scene, const TextureBudget& budget, Diagnostics& diagnostics, const std::string& where);

}  // namespace candela::io
