#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "scene/material_table.h"
#include "scene/scene.h"

/// Fewer textures than a file has: channels that a material needs lie in channels of its other textures that nothing
/// reads. The numbers stay the same; a shader looks up less, and memory shrinks.
namespace candela::raster {

/// Rows of slots in kTextureRows: those that may give or take channels, and the one that is searched in.
enum Slot : int {
  base_color_slot = texture_slot_index(&Material::base_color_texture),
  metallic_roughness_slot = texture_slot_index(&Material::metallic_roughness_texture),
  normal_slot = texture_slot_index(&Material::normal_texture),
  occlusion_slot = texture_slot_index(&Material::occlusion_texture),
  emissive_slot = texture_slot_index(&Material::emissive_texture),
  height_slot = texture_slot_index(&Material::height_texture),
};

/// A channel of the texture of a slot.
struct Channel {
  int slot = -1;  ///< -1: there is none
  int component = 0;

  explicit operator bool() const { return slot >= 0; }
  auto operator<=>(const Channel&) const = default;  // NOLINT(modernize-use-nullptr): there is none
};

/// Where the numbers stand that may move.
struct Channels {
  Channel metallic, roughness, occlusion;

  auto operator<=>(const Channels&) const = default;  // NOLINT(modernize-use-nullptr): there is none
};

/// What one texture of the driver is made of.
struct TextureSource {
  /// A channel of another image.
  struct Guest {
    int image = -1;  ///< -1: the channel stays as it is
    int component = 0;

    auto operator<=>(const Guest&) const = default;  // NOLINT(modernize-use-nullptr): there is none
  };

  int image = -1;  ///< -1: the slot needs no texture
  bool is_srgb = false;
  Guest red, alpha;

  bool is_packed() const { return red.image >= 0 || alpha.image >= 0; }
  auto operator<=>(const TextureSource&) const = default;  // NOLINT(modernize-use-nullptr): there is none
};

struct PackedMaterial {
  std::array<TextureSource, kTextureSlots> slots;
  Channels channels;
};

/// For each material of a scene. An image is packed one way or not at all: never are there more textures than without.
std::vector<PackedMaterial> pack_textures(const Scene& scene);

/// RGBA texels, 8 bits per channel, of a packed source.
std::vector<std::uint8_t> packed_texels(const Scene& scene, const TextureSource& source);

}  // namespace candela::raster
