#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "check/check_parts.h"
#include "scene/material_table.h"

// Which image stands in which slot, and whether one that should hold colours looks like directions.
namespace candela::check {

namespace {

using Use = TextureUse;

bool is_uniform(const TextureImage& image) {
  const std::size_t texel = 4 * static_cast<std::size_t>(image.bits / 8);
  for (std::size_t i = texel; i < image.pixels.size(); ++i) {
    if (image.pixels[i] != image.pixels[i - texel]) return false;
  }
  return true;
}

struct Place {
  int material;
  int texture;
  std::size_t slot;
};

/// Where each image stands, by image.
std::map<int, std::vector<Place>> places_of_images(const Scene& scene) {
  std::map<int, std::vector<Place>> places;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const auto slots = texture_slots(scene.materials[m]);
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (!*slots[s]) continue;
      const int image = scene.textures[static_cast<std::size_t>(slots[s]->texture)].image;
      places[image].push_back({static_cast<int>(m), slots[s]->texture, s});
    }
  }
  return places;
}

void find_shared_images(const Scene& scene, std::vector<Finding>& findings) {
  for (const auto& entry : places_of_images(scene)) {
    const int image = entry.first;
    const std::vector<Place>& places = entry.second;
    const auto first = [&places](Use use) {
      return std::find_if(places.begin(), places.end(),
                          [use](const Place& p) { return kTextureRows[p.slot].use == use; });
    };
    const auto color = first(Use::color);
    const auto normal = first(Use::normal);
    const auto data = first(Use::data);
    const bool is_mixed = (normal != places.end() && (color != places.end() || data != places.end())) ||
                          (color != places.end() && data != places.end());
    if (!is_mixed || is_uniform(*scene.images[static_cast<std::size_t>(image)])) continue;
    std::set<std::string_view> names;
    for (const Place& place : places) {
      if (kTextureRows[place.slot].use != Use::alpha) names.insert(kTextureRows[place.slot].source.key);
    }
    const Place& blamed = color != places.end() ? *color : *data;
    Finding f;
    f.severity = Severity::warning;
    f.code = normal != places.end() ? "normal-map-as-other" : "data-as-color";
    f.material = blamed.material;
    f.texture = blamed.texture;
    f.message = fmt::format("one image is {}: {}", fmt::join(names, " and "),
                            color != places.end() ? "the same codes are decoded as sRGB colours and as linear data"
                                                  : "directions are read as amounts");
    findings.push_back(std::move(f));
  }
}

/// Whether a colour image holds unit vectors: nearly every texel that the surface shows has length 1 and looks out of
/// the surface, and they are not all the same.
void find_normal_maps_among_colors(const Scene& scene, const std::vector<MaterialSurface>& surfaces,
                                   std::vector<Finding>& findings) {
  constexpr std::uint32_t kPoints = 1024;
  constexpr float kUnitTolerance = 0.06f;  // 8 bits and JPEG
  constexpr double kNearlyAll = 0.97;
  // Plain lavender is a colour too: directions have to differ by some degrees.
  constexpr double kLeastSpread = 0.003;
  // Those that stand in a normal slot too have been told already.
  std::set<int> normal_images;
  for (const Material& m : scene.materials) {
    for (const TextureSlot* slot : {&m.normal_texture, &m.clearcoat_normal_texture}) {
      if (*slot) normal_images.insert(scene.textures[static_cast<std::size_t>(slot->texture)].image);
    }
  }
  const auto is_normal_map = [&](int texture) {
    return normal_images.contains(scene.textures[static_cast<std::size_t>(texture)].image);
  };
  for (std::size_t m = 0; m < surfaces.size(); ++m) {
    const TextureSlot& slot = scene.materials[m].base_color_texture;
    if (!slot || surfaces[m].empty() || is_normal_map(slot.texture)) continue;
    const TexelGrid grid(scene, slot.texture);
    std::uint32_t unit = 0;
    dvec3 sum(0.0);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const vec3 n = 2.0f * grid.rgb(grid.texel_at(slot, surfaces[m].sample(i).uv(slot.uv_set))) - 1.0f;
      if (n.z > 0.0f && std::fabs(glm::length(n) - 1.0f) < kUnitTolerance) {
        ++unit;
        sum += dvec3(glm::normalize(n));
      }
    }
    const double share = static_cast<double>(unit) / kPoints;
    const double spread = unit > 0 ? 1.0 - glm::length(sum) / unit : 0.0;
    if (share < kNearlyAll || spread < kLeastSpread) continue;
    Finding f;
    f.severity = Severity::warning;
    f.code = "base-color-is-normal-map";
    f.material = static_cast<int>(m);
    f.texture = slot.texture;
    f.share = share;
    f.message = "base colours are unit vectors that look out of the surface, as in a normal map";
    f.fix = "the image belongs into normalTexture";
    f.measured.emplace_back("spread", spread);
    findings.push_back(std::move(f));
  }
}

// ----- KTX 2: KHR_texture_basisu, "Additional requirements"

Finding of_texture(Severity severity, const char* code, const Place& place, std::string message, std::string fix) {
  Finding f;
  f.severity = severity;
  f.code = code;
  f.material = place.material;
  f.texture = place.texture;
  f.message = std::move(message);
  f.fix = std::move(fix);
  return f;
}

const char* transfer_name(int transfer) {
  switch (transfer) {
    case 0:
      return "nothing of the transfer function";
    case ColorSpace::kLinear:
      return "that its numbers are linear";
    case ColorSpace::kSrgb:
      return "that its numbers are sRGB";
    default:
      return "another transfer function";
  }
}

/// The slot decides how codes are decoded; a viewer that goes by the file shows something else.
void judge_color_space(const ColorSpace& space, const Place& place, std::vector<Finding>& findings) {
  const bool is_color = kTextureRows[place.slot].use == Use::color;
  const std::string_view slot = kTextureRows[place.slot].source.key;
  const int transfer = is_color ? ColorSpace::kSrgb : ColorSpace::kLinear;
  if (space.transfer != transfer) {
    findings.push_back(of_texture(Severity::warning, "ktx-transfer", place,
                                  fmt::format("{} is read as {}, and its KTX 2 says {}", slot,
                                              is_color ? "sRGB" : "linear data", transfer_name(space.transfer)),
                                  fmt::format("write it with the transfer function {}", is_color ? "sRGB" : "linear")));
  }
  // Encoders write Rec.709 for data too; it does no harm.
  if (is_color && space.primaries != ColorSpace::kRec709) {
    findings.push_back(
        of_texture(space.primaries == 0 ? Severity::note : Severity::warning, "ktx-primaries", place,
                   space.primaries == 0
                       ? fmt::format("{} has colours, and its KTX 2 does not say of which primaries", slot)
                       : fmt::format("{} is read with the primaries of Rec.709, and its KTX 2 says others (number {})",
                                     slot, space.primaries),
                   "convert it to Rec.709, and say so"));
  }
  if (space.is_premultiplied) {
    findings.push_back(of_texture(Severity::warning, "ktx-premultiplied", place,
                                  fmt::format("{} has colours that are multiplied by alpha already", slot),
                                  "write it with straight alpha"));
  }
}

void judge_texture_file(const TextureInfo& info, const Place& place, bool allows_astc, std::vector<Finding>& findings) {
  const auto key = [&info](const char* name, std::string_view plain) -> std::optional<std::string> {
    const auto found = info.key_values.find(name);
    return found == info.key_values.end() || found->second == plain ? std::nullopt : std::optional(found->second);
  };
  if (const auto swizzle = key("KTXswizzle", "rgba")) {
    findings.push_back(
        of_texture(Severity::warning, "ktx-swizzle", place,
                   fmt::format("KTXswizzle is \"{}\": glTF allows rgba alone, and it is not followed", *swizzle),
                   "store the channels in their order"));
  }
  if (const auto orientation = key("KTXorientation", "rd")) {
    findings.push_back(
        of_texture(Severity::warning, "ktx-orientation", place,
                   fmt::format("KTXorientation is \"{}\": glTF allows rd alone, and it is not followed", *orientation),
                   "store the top row first"));
  }
  const bool is_basis =
      info.block && (info.block->codec == BlockCodec::etc1s || info.block->codec == BlockCodec::uastc);
  if (!is_basis && !(info.block && allows_astc)) {
    findings.push_back(
        of_texture(Severity::warning, "ktx-format", place,
                   fmt::format("its KTX 2 holds {}; KHR_texture_basisu allows ETC1S and UASTC", info.format),
                   "encode it as ETC1S or UASTC"));
  }
  if (is_basis && (info.width % 4 != 0 || info.height % 4 != 0)) {
    findings.push_back(
        of_texture(Severity::warning, "ktx-size", place,
                   fmt::format("{} x {} texels: KHR_texture_basisu allows multiples of 4, and WebGL cannot "
                               "show others in blocks",
                               info.width, info.height),
                   "resize it"));
  }
  if (info.color_space && kTextureRows[place.slot].use != Use::alpha)
    judge_color_space(*info.color_space, place, findings);
}

}  // namespace

void check_texture_files(const CheckInput& input, std::vector<Finding>& findings) {
  if (input.survey == nullptr) return;
  const auto& used = input.extensions_used;
  const bool allows_astc = std::find(used.begin(), used.end(), "EXT_texture_astc") != used.end();
  for (const auto& placed : places_of_images(input.scene)) {
    const auto index = static_cast<std::size_t>(placed.first);
    if (index >= input.survey->images.size()) continue;
    const FileSurvey::Image& file = input.survey->images[index];
    const auto& places = placed.second;
    if (!file.texture || !file.error.empty()) continue;
    // Once for an image: where it is a colour, else where it is more than alpha.
    const auto first = [&places](auto fits) { return std::find_if(places.begin(), places.end(), fits); };
    auto place = first([](const Place& p) { return kTextureRows[p.slot].use == Use::color; });
    if (place == places.end()) place = first([](const Place& p) { return kTextureRows[p.slot].use != Use::alpha; });
    judge_texture_file(*file.texture, place == places.end() ? places.front() : *place, allows_astc, findings);
  }
}

void check_textures(const Scene& scene, const std::vector<MaterialSurface>& surfaces, std::vector<Finding>& findings) {
  find_shared_images(scene, findings);
  find_normal_maps_among_colors(scene, surfaces, findings);
}

}  // namespace candela::check
