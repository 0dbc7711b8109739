// The inspector of materials: every row of the material table, its textures, and what no row says.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <string>

#include "scene/material_table.h"
#include "scene/surface_params.h"
#include "viewer/app.h"

namespace candela::viewer {

namespace {

constexpr int kThumbnail = 96;  // pixels of the longer side

/// A small picture of a texture, as its file has it: colours as they are seen, all else as numbers.
DisplayImage thumbnail_of(const TextureImage& image) {
  const int longer = std::max({image.width, image.height, 1});
  const int shown = std::min(longer, kThumbnail);
  DisplayImage small{std::max(image.width * shown / longer, 1), std::max(image.height * shown / longer, 1), {}};
  small.rgba.resize(static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height) * 4, 255);
  if (image.pixels.empty()) return small;
  const std::size_t bytes = static_cast<std::size_t>(image.bits) / 8;
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      const int from_x = (2 * x + 1) * image.width / (2 * small.width);
      const int from_y = (2 * y + 1) * image.height / (2 * small.height);
      const std::size_t from = (static_cast<std::size_t>(from_y) * static_cast<std::size_t>(image.width) +
                                static_cast<std::size_t>(from_x)) *
                               4;
      std::uint8_t* to =
          small.rgba.data() +
          (static_cast<std::size_t>(y) * static_cast<std::size_t>(small.width) + static_cast<std::size_t>(x)) * 4;
      for (std::size_t c = 0; c < 3; ++c) {
        // Of sixteen bits, the higher eight: on a little-endian machine the second byte.
        to[c] = image.pixels[(from + c) * bytes + (bytes - 1)];
      }
    }
  }
  return small;
}

/// Every row is of the base or of a lobe that the inspector lists.
constexpr bool is_listed(const MaterialProperty& property) {
  return property.lobe.bit == 0 ||
         std::any_of(kLobes.begin(), kLobes.end(), [&](const LobeRow& lobe) { return lobe.bit == property.lobe.bit; });
}
static_assert(std::all_of(kMaterialProperties.begin(), kMaterialProperties.end(), is_listed));

/// The nearest number that a property may have.
float within(const Range& range, float value) {
  return range.contains(value) ? value : std::clamp(value, range.lower, range.upper);
}

}  // namespace

void App::show_texture(const Scene& scene, const TextureSlot& slot, std::size_t slot_index) {
  const Texture& texture = scene.textures[static_cast<std::size_t>(slot.texture)];
  const TextureImage& image = *scene.images[static_cast<std::size_t>(texture.image)];
  GuiPicture& picture = thumbnails_[&image];
  if (picture.empty()) picture.set(thumbnail_of(image));
  const float height = 2.5f * ImGui::GetFontSize();
  const vec2 size(picture.size());
  ImGui::Image(picture.id(), {height * size.x / size.y, height});
  if (ImGui::IsItemHovered()) {
    ImGui::BeginTooltip();
    ImGui::Image(picture.id(), {2.0f * size.x, 2.0f * size.y});
    ImGui::EndTooltip();
  }
  ImGui::SameLine();
  const int number = number_of(scene.textures, static_cast<std::size_t>(slot.texture));
  ImGui::TextDisabled("%s\n%s, %d × %d, %d bits, TEXCOORD_%d", std::string(kTextureRows[slot_index].name).c_str(),
                      texture.name.empty() ? fmt::format("texture {}", number).c_str() : texture.name.c_str(),
                      image.width, image.height, image.bits, slot.uv_set);
}

/// A widget for one row. Returns whether it has changed the value, which then is within the row's range.
bool App::edit_row(std::size_t row, const Material& material, MaterialEdit& edit) {
  const MaterialProperty& property = kMaterialProperties[row];
  const auto found = edit.rows.find(row);
  vec3 value(0.0f);
  for (int i = 0; i < property.member.size(); ++i) {
    value[i] = found != edit.rows.end() ? found->second[i] : property.member.at(material, i);
  }
  const std::string label = std::string(property.name) + (found != edit.rows.end() ? " *" : "");
  const Range& range = property.range;
  const bool is_unit = range.lower == 0.0f && range.upper == 1.0f;
  bool has_changed = false;
  if (property.source.is_flag) {
    bool is_on = value.x != 0.0f;
    has_changed = ImGui::Checkbox(label.c_str(), &is_on);
    value.x = is_on ? 1.0f : 0.0f;
  } else if (property.member.is_color()) {
    const ImGuiColorEditFlags flags = ImGuiColorEditFlags_Float | (is_unit ? 0 : ImGuiColorEditFlags_HDR);
    has_changed = ImGui::ColorEdit3(label.c_str(), &value.x, flags);
  } else if (is_unit) {
    has_changed = ImGui::SliderFloat(label.c_str(), &value.x, 0.0f, 1.0f, "%.3f");
  } else {
    const float step = std::max(0.005f * std::abs(value.x), 0.002f);
    has_changed =
        ImGui::DragFloat(label.c_str(), &value.x, std::isfinite(step) ? step : 1.0f, range.lower, range.upper, "%.4g");
  }
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("%s\n%s %s", std::string(property.doc).c_str(), std::string(property.source.place).c_str(),
                      std::string(property.source.key).c_str());
  }
  if (!has_changed) return false;
  for (int i = 0; i < property.member.size(); ++i) value[i] = within(range, value[i]);
  edit.rows[row] = value;
  return true;
}

void App::panel_material() {
  const std::shared_ptr<const Scene> scene = this->scene();
  material_ = std::clamp(material_, 0, static_cast<int>(scene->materials.size()) - 1);
  const auto index = static_cast<std::size_t>(material_);
  if (ImGui::BeginCombo("material", check::material_label(*scene, material_).c_str())) {
    for (int i = 0; i < static_cast<int>(scene->materials.size()); ++i) {
      ImGui::PushID(i);
      if (ImGui::Selectable(check::material_label(*scene, i).c_str(), i == material_)) material_ = i;
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  const Material& material = scene->materials[index];
  const int number = number_of(scene->materials, index);
  const auto found = edits_->materials.find(number);
  MaterialEdit edited = found == edits_->materials.end() ? MaterialEdit{} : found->second;
  bool has_changed = false;
  ImGui::PushID(number);

  auto mode = static_cast<int>(edited.alpha_mode.value_or(material.alpha_mode));
  if (ImGui::Combo("alpha mode", &mode, "opaque\0mask\0blend\0")) {
    edited.alpha_mode = static_cast<AlphaMode>(mode);
    has_changed = true;
  }
  bool is_double_sided = edited.double_sided.value_or(material.double_sided);
  if (ImGui::Checkbox("double sided", &is_double_sided)) edited.double_sided = is_double_sided, has_changed = true;
  ImGui::SameLine();
  bool is_unlit = edited.unlit.value_or(material.unlit);
  if (ImGui::Checkbox("unlit", &is_unlit)) edited.unlit = is_unlit, has_changed = true;

  // Every row, those of a lobe that the material has not in a fold of their own.
  std::array<bool, kTextureSlots> is_texture_shown{};
  const auto show_rows = [&](int lobe) {
    for (std::size_t row = 0; row < kMaterialProperties.size(); ++row) {
      const MaterialProperty& property = kMaterialProperties[row];
      if (property.lobe.bit != lobe) continue;
      has_changed |= edit_row(row, material, edited);
      if (!property.texture) continue;
      const std::size_t slot = property.texture.index();
      const TextureSlot& texture = material.*kTextureRows[slot].slot;
      if (texture && !is_texture_shown[slot]) show_texture(*scene, texture, slot);
      is_texture_shown[slot] = true;
    }
  };
  show_rows(0);
  const int lobes = lobes_of(material);
  for (const LobeRow& lobe : kLobes) {
    const bool has_it = (lobes & lobe.bit) != 0;
    const std::string label = std::string(lobe.words) + (has_it ? "" : " (none)");
    if (ImGui::TreeNodeEx(std::string(lobe.name).c_str(), has_it ? ImGuiTreeNodeFlags_DefaultOpen : 0, "%s",
                          label.c_str())) {
      show_rows(lobe.bit);
      ImGui::TreePop();
    }
  }
  // Textures that no row shows.
  const auto slots = texture_slots(material);
  for (std::size_t slot = 0; slot < kTextureSlots; ++slot) {
    const bool is_of_row =
        std::any_of(kMaterialProperties.begin(), kMaterialProperties.end(),
                    [&](const MaterialProperty& p) { return p.texture && p.texture.index() == slot; });
    if (*slots[slot] && !is_of_row) show_texture(*scene, *slots[slot], slot);
  }
  if (found != edits_->materials.end() && ImGui::Button("as in the file")) {
    edit().materials.erase(number);
    has_changed = false;
    change();
  } else if (has_changed) {
    edit().materials[number] = std::move(edited);
    change(true);
  }
  ImGui::PopID();
}

}  // namespace candela::viewer
