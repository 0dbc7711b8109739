// The panel's sections but for the material: what is shown, in what light, from where, and what was found.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "content/make_environment.h"
#include "raster/quantity.h"
#include "viewer/app.h"

namespace candela::viewer {

namespace {

/// A list to choose from; `choose` is called with the index.
template <class NameOf, class Choose>
void choices(const char* label, const std::string& now, std::size_t count, const NameOf& name_of,
             const Choose& choose) {
  if (!ImGui::BeginCombo(label, now.c_str())) return;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = name_of(i);
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(name.empty() ? "(no name)" : name.c_str(), name == now)) choose(i);
    ImGui::PopID();
  }
  ImGui::EndCombo();
}

std::string animation_label(const std::vector<io::AnimationInfo>& animations, const std::string& chosen) {
  if (chosen.empty()) return animations.empty() ? "" : animations.front().name.empty() ? "0" : animations.front().name;
  return chosen;
}

}  // namespace

void App::panel_picture() {
  if (ImGui::SliderFloat("exposure", &stops_, -6.0f, 6.0f, "%+.2f stops")) change();
  choices(
      "tone curve", std::string(tone_curve_name(shot_.tone_curve)), kToneCurves.size(),
      [](std::size_t i) { return std::string(kToneCurves[i].name); },
      [&](std::size_t i) { shot_.tone_curve = kToneCurves[i].curve, change(); });
  choices(
      "shows", std::string(raster::quantity_name(shot_.drawn.quantity)), raster::kQuantityCount,
      [](std::size_t i) { return std::string(raster::quantity_name(static_cast<raster::Quantity>(i))); },
      [&](std::size_t i) { shot_.drawn.quantity = static_cast<raster::Quantity>(i), change(); });
  if (shot_.drawn.quantity == raster::Quantity::one_light) {
    const int most = std::max(static_cast<int>(scene()->lights.size()) - 1, 0);
    if (ImGui::SliderInt("lamp", &shot_.drawn.shown_light, 0, most)) change();
  }
  if (ImGui::SliderFloat("bloom", &shot_.bloom, 0.0f, 1.0f)) change();
  if (ImGui::Checkbox("path traced beside it", &is_split_)) {
    wants_trace_ = is_split_;
    if (!is_split_) tracing_->stop();
  }
  if (is_split_) {
    if (ImGui::Checkbox("denoised", &is_denoised_)) wants_trace_ = true;
    if (ImGui::SliderInt("samples", &options_.samples, 1, 16384, "%d", ImGuiSliderFlags_Logarithmic))
      wants_trace_ = true;
    if (ImGui::SliderInt("bounces", &shot_.traced.bounces, 0, 32)) wants_trace_ = true;
  }
  if (shown_ != nullptr) ImGui::TextDisabled("%.1f ms a frame", 1e3 * shown_->seconds);
}

void App::panel_pixel() {
  if (explained_.empty()) return ImGui::TextDisabled("click on the picture");
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(explained_.c_str(), explained_.c_str() + explained_.size());
  ImGui::PopTextWrapPos();
}

void App::panel_light() {
  const std::span<const std::string> names = built_in_environments();
  const std::string now = light_name_.empty() ? "the model's own" : light_name_;
  choices(
      "environment", now, names.size() + 1,
      [&](std::size_t i) { return i == 0 ? std::string("the model's own") : names[i - 1]; },
      [&](std::size_t i) {
        const std::string name = i == 0 ? "" : names[i - 1];
        open_light(name == "sky:DEG" ? "sky:20" : name);
      });
  float degrees = glm::degrees(rotation_);
  if (ImGui::SliderFloat("turned by", &degrees, -180.0f, 180.0f, "%.0f°")) {
    rotation_ = glm::radians(degrees);
    change(true);
  }
  if (ImGui::SliderFloat("intensity", &intensity_, 0.01f, 100.0f, "%.2f", ImGuiSliderFlags_Logarithmic)) change(true);
  bool shows_it = shot_.background == Background::environment;
  if (ImGui::Checkbox("behind the subject", &shows_it)) {
    shot_.background = shows_it ? Background::environment : Background::transparent;
    change();
  }
  if (ImGui::SliderFloat("occlusion", &shot_.drawn.occlusion_radius, 0.0f, 0.2f, "%.3f of its size")) change();
  if (ImGui::Checkbox("soft shadows", &shot_.drawn.has_soft_shadows)) change();
}

void App::panel_scene() {
  const io::FileInfo& info = model_->info();
  choices(
      "view", viewpoints_[viewpoint_].first, viewpoints_.size(), [&](std::size_t i) { return viewpoints_[i].first; },
      [&](std::size_t i) { look_from(i); });
  if (!camera_names_.empty()) {
    const auto found = std::find_if(camera_names_.begin(), camera_names_.end(),
                                    [&](const auto& row) { return camera_node_ == row.first; });
    choices(
        "camera", found == camera_names_.end() ? "free" : found->second, camera_names_.size(),
        [&](std::size_t i) { return camera_names_[i].second; },
        [&](std::size_t i) { camera_node_ = camera_names_[i].first, change(); });
  }
  if (!info.variants.empty()) {
    choices(
        "variant", moment_.variant.value_or("default look"), info.variants.size() + 1,
        [&](std::size_t i) { return i == 0 ? std::string("default look") : info.variants[i - 1]; },
        [&](std::size_t i) {
          moment_.variant = i == 0 ? std::optional<std::string>("") : info.variants[i - 1];
          if (i == 0) moment_.variant.reset();
          change();
        });
  }
  if (!model_->is_animated()) return;
  const std::size_t count = info.animations.size();
  choices(
      "animation", animation_label(info.animations, moment_.animation), count + 1,
      [&](std::size_t i) {
        if (i == count) return std::string("all");
        return info.animations[i].name.empty() ? std::to_string(i) : info.animations[i].name;
      },
      [&](std::size_t i) {
        moment_.animation = i == count ? "all" : std::to_string(i);
        moment_.time_s = 0.0;
        change();
      });
  const auto length = static_cast<float>(animation_length());
  auto time = static_cast<float>(moment_.time_s.value_or(0.0));
  if (ImGui::SliderFloat("moment", &time, 0.0f, std::max(length, 1e-3f), "%.2f s")) {
    moment_.time_s = time;
    is_playing_ = false;
    change(true);
  }
  if (ImGui::Button(is_playing_ ? "stop" : "play")) {
    is_playing_ = !is_playing_;
    if (!moment_.time_s) moment_.time_s = 0.0;
  }
  ImGui::SameLine();
  ImGui::SetNextItemWidth(8.0f * ImGui::GetFontSize());
  ImGui::SliderFloat("speed", &speed_, 0.1f, 4.0f, "%.1f ×");
}

void App::panel_lamps() {
  const std::shared_ptr<const Scene> scene = this->scene();
  for (std::size_t i = 0; i < scene->lights.size(); ++i) {
    const int number = number_of(scene->lights, i);
    const auto found = edits_->lights.find(number);
    LightEdit edited = found == edits_->lights.end() ? LightEdit{} : found->second;
    const Light& light = model_->first()->lights[std::min(i, model_->first()->lights.size() - 1)];
    ImGui::PushID(number);
    bool is_on = !edited.is_off;
    float intensity = edited.intensity.value_or(light.intensity);
    vec3 color = edited.color.value_or(light.color);
    bool has_changed = false;
    if (ImGui::Checkbox(light.name.empty() ? fmt::format("lamp {}", number).c_str() : light.name.c_str(), &is_on)) {
      edited.is_off = !is_on;
      has_changed = true;
    }
    const char* unit = light.ies >= 0 ? "%.3g ×" : light.type == LightType::directional ? "%.4g lx" : "%.4g cd";
    if (ImGui::DragFloat("intensity", &intensity, std::max(0.01f * intensity, 1e-3f), 0.0f, 1e9f, unit)) {
      edited.intensity = std::max(intensity, 0.0f);
      has_changed = true;
    }
    if (ImGui::ColorEdit3("colour", &color.x, ImGuiColorEditFlags_Float)) {
      edited.color = glm::max(color, vec3(0.0f));
      has_changed = true;
    }
    if (has_changed) {
      edit().lights[number] = edited;
      change(true);
    }
    ImGui::PopID();
  }
}

void App::panel_findings() {
  if (!verdict_) {
    if (loading_->is_judging()) {
      ImGui::TextDisabled("checking …");
    } else if (ImGui::Button("check")) {
      has_markers_ = true;
      judge();
    }
    return;
  }
  ImGui::Checkbox("markers", &has_markers_);
  if (verdict_->unreadable) ImGui::TextWrapped("%s", verdict_->unreadable->c_str());
  if (verdict_->findings.empty() && !verdict_->unreadable) ImGui::TextUnformatted("nothing found");
  for (std::size_t i = 0; i < verdict_->findings.size(); ++i) {
    const NamedFinding& named = verdict_->findings[i];
    const check::Finding& finding = named.finding;
    const std::string about = !named.material.empty()  ? named.material
                              : !named.texture.empty() ? named.texture
                                                       : finding.subject;
    const std::string text = fmt::format("{} {} {}{}: {}", i + 1, check::severity_name(finding.severity), finding.code,
                                         about.empty() ? "" : " (" + about + ")", finding.message);
    ImGui::TextWrapped("%s", text.c_str());
    if (!finding.fix.empty() && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", finding.fix.c_str());
    if (finding.material >= 0 && ImGui::IsItemClicked()) {
      for (std::size_t m = 0; m < scene()->materials.size(); ++m) {
        if (number_of(scene()->materials, m) == finding.material) material_ = static_cast<int>(m);
      }
    }
    ImGui::Separator();
  }
}

void App::panel_saving() {
  ImGui::InputInt2("size", &saved_size_.x);
  saved_size_ = glm::clamp(saved_size_, ivec2(0), ivec2(16384));
  if (saved_size_.x < 1 || saved_size_.y < 1) ImGui::TextDisabled("the window's, while a side is 0");
  const bool is_whole = saved_size_.x > 0 && saved_size_.y > 0;
  if (ImGui::Button("save the drawn picture")) save_picture(is_whole ? saved_size_ : ivec2(0), {});
  if (is_split_ && traced_ != nullptr && traced_->film != nullptr && ImGui::Button("save the path traced one")) {
    save_traced();
  }
}

}  // namespace candela::viewer
