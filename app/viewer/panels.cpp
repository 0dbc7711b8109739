// The picture in the window, and what lies over it. The panel at the side is panel_*.cpp.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/quantity.h"
#include "scene/surface_layers.h"
#include "viewer/app.h"

namespace candela::viewer {

namespace {

constexpr float kMargin = 10.0f;
constexpr ImU32 kWhite = IM_COL32(255, 255, 255, 255);
constexpr ImU32 kShade = IM_COL32(0, 0, 0, 160);

ImVec2 at(vec2 v) { return {v.x, v.y}; }

struct KeyRow {
  const char* keys;
  const char* what;
};
constexpr auto kKeyRows = std::to_array<KeyRow>({
    {"drag", "turns about the subject"},
    {"shift drag, right drag", "moves along"},
    {"wheel", "comes nearer"},
    {"ctrl drag, alt drag", "turns the environment"},
    {"click", "says what is there, shows its material"},
    {"F", "fits the subject into the window"},
    {"R", "back to the first view"},
    {"Page up, Page down", "the view before, the next"},
    {"Space", "starts and stops the animation"},
    {"V, shift V", "next quantity, the one before; L all light"},
    {"T", "path traced picture beside the drawn one"},
    {"+, -, 0", "exposure by quarter stops; as it was"},
    {"[, ]", "environment by eighths of a turn"},
    {"C", "what candela check finds, with markers"},
    {"S", "saves the picture under a name that is free"},
    {"ctrl R", "reads files and shaders again"},
    {"Tab", "hides the panel, shows it"},
    {"H, ?", "this help"},
    {"Escape", "closes help, then the window"},
    {"drop", "a model or an environment to show"},
});

/// A line of text on a dark strip.
void strip(ImDrawList& list, vec2 position, const std::string& text, ImU32 color = kWhite) {
  constexpr float kPadding = 5.0f;
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  list.AddRectFilled(at(position - vec2(kPadding)), at(position + vec2(size.x, size.y) + kPadding), kShade, 4.0f);
  list.AddText(at(position), color, text.c_str());
}

}  // namespace

void App::build() {
  build_picture();
  build_markers();
  build_overlay();
  if (has_panels_) build_panel();
  if (has_help_) build_help();
}

/// The drawn picture fills the window; right of the divider the traced one.
void App::build_picture() {
  if (drawn_picture_.empty()) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const vec2 size(picture_size());
  const bool has_alpha = shot_.background == Background::transparent && shown_ != nullptr && !shown_->is_sketch;
  if (has_alpha) {
    // Behind what is transparent, squares.
    constexpr float kSquare = 16.0f;
    list.AddRectFilled({0, 0}, at(size), IM_COL32(105, 105, 105, 255));
    for (int y = 0; static_cast<float>(y) * kSquare < size.y; ++y) {
      for (int x = y % 2; static_cast<float>(x) * kSquare < size.x; x += 2) {
        const vec2 corner = kSquare * vec2(x, y);
        list.AddRectFilled(at(corner), at(corner + kSquare), IM_COL32(150, 150, 150, 255));
      }
    }
  }
  list.AddImage(drawn_picture_.id(), {0, 0}, at(size));
  if (!is_split_) return;
  const float x = split_ * size.x;
  const bool is_traced = traced_ != nullptr && traced_->number == asked_;  // else it is of what was before
  if (is_traced) {
    list.AddImage(traced_picture_.id(), {x, 0}, at(size), {split_, 0}, {1, 1});
  }
  list.AddLine({x, 0}, {x, size.y}, kWhite, 2.0f);
  const float line = ImGui::GetTextLineHeight();
  const float low = size.y - 2.5f * line - kMargin;
  const std::string left = "real time";
  strip(list, {x - ImGui::CalcTextSize(left.c_str()).x - 2.0f * kMargin, low}, left);
  std::string right = "path traced";
  if (is_traced) {
    right += fmt::format(", {:.4g} samples, {:.1f} s", traced_->samples, traced_->seconds);
    if (traced_->is_denoised) right += ", denoised";
  }
  strip(list, {x + 2.0f * kMargin, low}, right);
}

void App::build_markers() {
  if (!has_markers_ || !verdict_) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float radius = 0.6f * ImGui::GetTextLineHeight();
  std::map<std::pair<int, int>, int> stacked;  // markers of one place stand beside each other
  for (const Marker& marker : markers_) {
    const std::optional<vec3> place = on_screen(marker.position);
    if (!place) continue;
    const int before = stacked[{static_cast<int>(place->x), static_cast<int>(place->y)}]++;
    const vec2 center = vec2(*place) + vec2(static_cast<float>(before) * 2.2f * radius, 0.0f);
    const check::Finding& finding = verdict_->findings[marker.finding].finding;
    const ImU32 color = finding.severity == check::Severity::error     ? IM_COL32(220, 60, 50, 255)
                        : finding.severity == check::Severity::warning ? IM_COL32(225, 150, 30, 255)
                                                                       : IM_COL32(70, 130, 210, 255);
    list.AddCircleFilled(at(center), radius, color);
    list.AddCircle(at(center), radius, kWhite, 0, 1.5f);
    const std::string number = std::to_string(marker.finding + 1);
    const ImVec2 size = ImGui::CalcTextSize(number.c_str());
    list.AddText({center.x - 0.5f * size.x, center.y - 0.5f * size.y}, kWhite, number.c_str());
    if (!gui_.wants_pointer() && glm::distance(pointer_, center) < radius) {
      ImGui::SetTooltip("%s: %s", finding.code.c_str(), finding.message.c_str());
    }
  }
}

/// What goes on, what was said, and what was clicked on.
void App::build_overlay() {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const vec2 size(picture_size());
  const float line = ImGui::GetTextLineHeightWithSpacing();
  std::string doing;
  if (loading_->is_loading()) doing = "reading " + std::filesystem::path(shot_.scene).filename().string();
  if (doing.empty() && loading_->is_lighting()) doing = "baking light";
  if (!working_.empty()) doing += (doing.empty() ? "" : ", ") + working_;
  if (doing.empty() && loading_->is_judging()) doing = "checking";
  if (doing.empty() && drawing_->is_busy() && shown_ != nullptr && !shown_->is_whole) doing = "drawing";
  float y = kMargin;
  if (!doing.empty()) {
    // The bar says that it goes on, not how far: nobody knows before.
    strip(list, {kMargin, y}, doing + " …");
    const float phase = static_cast<float>(std::fmod(watch_.seconds(), 1.2) / 1.2);
    list.AddRectFilled({phase * 0.8f * size.x, 0}, {(phase * 0.8f + 0.2f) * size.x, 3}, IM_COL32(90, 160, 255, 255));
    lively_ = std::max(lively_, 1);
    y += 1.4f * line;
  }
  for (const Message& message : messages_) {
    if (watch_.seconds() - message.at_s > (message.is_error ? kErrorsFor : kShownFor)) continue;
    strip(list, {kMargin, y}, message.text, message.is_error ? IM_COL32(255, 140, 120, 255) : kWhite);
    y += 1.4f * line;
  }
  std::string footer = "H help";
  if (shown_ != nullptr && shown_->is_sketch) footer += "   plain light";
  if (light_ != nullptr && light_->is_plain) footer += "   even light, until the environment's is baked";
  if (shot_.drawn.quantity != raster::Quantity::light) {
    footer += "   " + std::string(raster::quantity_name(shot_.drawn.quantity));
  }
  if (picked_) {
    const SurfaceSample& s = picked_->sample;
    if (s.node < 0) {
      footer += fmt::format("   pixel {},{}: nothing", picked_->pixel.x, picked_->pixel.y);
    } else {
      const Scene& scene = *picked_->scene;
      const auto node = static_cast<std::size_t>(s.node);
      const int material = material_of(scene, s);
      footer += fmt::format("   pixel {},{}: node {} '{}', {}, at {:.4g}, {:.4g}, {:.4g}", picked_->pixel.x,
                            picked_->pixel.y, number_of(scene.nodes, node), scene.nodes[node].name,
                            check::material_label(scene, material), s.position.x, s.position.y, s.position.z);
    }
  }
  strip(list, {kMargin, size.y - line - 0.5f * kMargin}, footer);
}

void App::build_help() {
  const vec2 size(picture_size());
  ImGui::SetNextWindowPos(at(0.5f * size), ImGuiCond_Always, {0.5f, 0.5f});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse;
  if (ImGui::Begin("Help", &has_help_, kFlags) && ImGui::BeginTable("keys", 2)) {
    for (const KeyRow& row : kKeyRows) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextColored({0.6f, 0.8f, 1.0f, 1.0f}, "%s", row.keys);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(row.what);
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

float App::panel_width() const {
  constexpr float kLeast = 180.0f;
  const float wanted = 26.0f * ImGui::GetFontSize();
  return std::clamp(wanted, kLeast, std::max(0.45f * static_cast<float>(window_.size().x), kLeast));
}

void App::build_panel() {
  const vec2 size(window_.size());
  const float width = panel_width();
  ImGui::SetNextWindowPos({size.x - width, 0});
  ImGui::SetNextWindowSize({width, size.y});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoTitleBar |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus;
  if (ImGui::Begin("panel", nullptr, kFlags) && model_ != nullptr) {
    ImGui::PushItemWidth(0.52f * width);
    const auto section = [](const char* name, bool is_open) {
      return ImGui::CollapsingHeader(name, is_open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    };
    if (section("Picture", true)) panel_picture();
    if (section("Light", true)) panel_light();
    if (section("Scene", true)) panel_scene();
    if (!scene()->lights.empty() && section("Lamps", false)) panel_lamps();
    if (section("Material", true)) panel_material();
    if (section("Pixel", false)) panel_pixel();
    if (section("Findings", false)) panel_findings();
    if (section("Save", false)) panel_saving();
    ImGui::PopItemWidth();
  }
  ImGui::End();
}

}  // namespace candela::viewer
