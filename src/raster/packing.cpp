#include "raster/packing.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/parallel.h"

namespace candela::raster {

namespace {

class Packer {
 public:
  explicit Packer(const Scene& scene) : scene_(scene) {}

  PackedMaterial unpacked(const Material& m) const {
    PackedMaterial result;
    const auto slots = texture_slots(m);
    for (std::size_t i = 0; i < kTextureSlots; ++i) {
      if (*slots[i]) result.slots[i] = {texture(*slots[i]).image, kTextureRows[i].is_srgb(), {}, {}};
    }
    if (m.metallic_roughness_texture) {
      result.channels.metallic = {metallic_roughness_slot, 2};
      result.channels.roughness = {metallic_roughness_slot, 1};
    }
    if (m.occlusion_texture) result.channels.occlusion = {occlusion_slot, 0};
    return result;
  }

  PackedMaterial packed(const Material& m) const {
    PackedMaterial result = unpacked(m);
    if (m.unlit) return result;
    const auto slots = texture_slots(m);
    // Nobody reads the alpha of these.
    std::vector<int> free;
    for (const int slot : {normal_slot, emissive_slot, base_color_slot}) {
      if (!*slots[static_cast<std::size_t>(slot)]) continue;
      if (slot == base_color_slot && m.alpha_mode != AlphaMode::opaque) continue;
      // A texture that is not looked up anyway would save nothing.
      if (slot == emissive_slot && max_component(m.emission) <= 0.0f) continue;
      free.push_back(slot);
    }
    const auto room_for = [&](int guest) {
      return std::count_if(free.begin(), free.end(), [&](int host) { return fits(m, host, guest); });
    };
    const auto move_in = [&](Channel& channel) {
      const auto host = std::find_if(free.begin(), free.end(), [&](int slot) { return fits(m, slot, channel.slot); });
      at(result, *host).alpha = {at(result, channel.slot).image, channel.component};
      channel = {*host, 3};
      free.erase(host);
    };

    const bool has_occlusion = static_cast<bool>(m.occlusion_texture);
    const bool has_metal = static_cast<bool>(m.metallic_roughness_texture);
    const bool is_shared = has_metal && has_occlusion && fits(m, metallic_roughness_slot, occlusion_slot) &&
                           at(result, metallic_roughness_slot).image == at(result, occlusion_slot).image;
    if (has_metal && room_for(metallic_roughness_slot) >= (is_shared ? 3 : 2)) {
      move_in(result.channels.metallic);
      move_in(result.channels.roughness);
      at(result, metallic_roughness_slot) = {};
    }
    if (has_occlusion) {
      const bool is_metal_left = at(result, metallic_roughness_slot).image >= 0;
      if (is_metal_left && fits(m, metallic_roughness_slot, occlusion_slot)) {
        if (!is_shared) at(result, metallic_roughness_slot).red = {at(result, occlusion_slot).image, 0};
        result.channels.occlusion = {metallic_roughness_slot, 0};
      } else if (room_for(occlusion_slot) > 0) {
        move_in(result.channels.occlusion);
      }
      if (result.channels.occlusion.slot != occlusion_slot) at(result, occlusion_slot) = {};
    }
    return result;
  }

 private:
  static TextureSource& at(PackedMaterial& m, int slot) { return m.slots[static_cast<std::size_t>(slot)]; }

  const Texture& texture(const TextureSlot& slot) const {
    return scene_.textures[static_cast<std::size_t>(slot.texture)];
  }

  const TextureImage& image(const TextureSlot& slot) const {
    return *scene_.images[static_cast<std::size_t>(texture(slot).image)];
  }

  /// Whether both slots read the same places of images of one size.
  bool fits(const Material& m, int host, int guest) const {
    const auto slots = texture_slots(m);
    const TextureSlot &a = *slots[static_cast<std::size_t>(host)], &b = *slots[static_cast<std::size_t>(guest)];
    if (a.uv_set != b.uv_set || a.transform != b.transform) return false;
    const Texture &s = texture(a), &t = texture(b);
    const TextureImage &x = image(a), &y = image(b);
    return s.wrap_u == t.wrap_u && s.wrap_v == t.wrap_v && s.filter == t.filter && x.width == y.width &&
           x.height == y.height && x.bits == 8 && y.bits == 8;
  }

  const Scene& scene_;
};

}  // namespace

std::vector<PackedMaterial> pack_textures(const Scene& scene) {
  const Packer packer(scene);
  std::vector<PackedMaterial> result;
  result.reserve(scene.materials.size());
  for (const Material& m : scene.materials) result.push_back(packer.packed(m));

  // Where two want an image in different ways, neither packs it; that may bring about the next such pair.
  for (bool is_settled = false; !is_settled;) {
    std::map<std::pair<int, bool>, std::set<TextureSource>> ways;
    for (const PackedMaterial& m : result) {
      for (const TextureSource& s : m.slots) {
        if (s.image >= 0) ways[{s.image, s.is_srgb}].insert(s);
      }
    }
    is_settled = true;
    for (std::size_t i = 0; i < result.size(); ++i) {
      const bool is_disputed = std::any_of(result[i].slots.begin(), result[i].slots.end(), [&](const TextureSource& s) {
        return s.is_packed() && ways[{s.image, s.is_srgb}].size() > 1;
      });
      if (!is_disputed) continue;
      result[i] = packer.unpacked(scene.materials[i]);
      is_settled = false;
    }
  }
  return result;
}

std::vector<std::uint8_t> packed_texels(const Scene& scene, const TextureSource& source) {
  std::vector<std::uint8_t> texels = scene.images[static_cast<std::size_t>(source.image)]->pixels;
  const auto put = [&](std::size_t component, const TextureSource::Guest& guest) {
    if (guest.image < 0) return;
    const std::uint8_t* from = scene.images[static_cast<std::size_t>(guest.image)]->pixels.data() + guest.component;
    parallel_for(0, texels.size() / 4, 1 << 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) texels[4 * i + component] = from[4 * i];
    });
  };
  put(0, source.red);
  put(3, source.alpha);
  return texels;
}

}  // namespace candela::raster
