// What is to be seen: the look that the threads are asked for.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "candela/viewpoint.h"
#include "scene/surface_layers.h"
#include "viewer/app.h"

namespace candela::viewer {

/// The picture stands beside the panel, where there is room for both.
ivec2 App::picture_size() const {
  ivec2 size = glm::max(window_.size(), ivec2(1));
  const int panel = has_panels_ ? static_cast<int>(panel_width()) : 0;
  if (size.x > 2 * panel) size.x -= panel;
  return size;
}

float App::aspect() const {
  const ivec2 size = picture_size();
  return static_cast<float>(size.x) / static_cast<float>(size.y);
}

std::shared_ptr<const Scene> App::scene() const {
  if (shown_ != nullptr && shown_->model == model_ && shown_->scene != nullptr) return shown_->scene;
  return model_ != nullptr ? model_->first() : nullptr;
}

void App::change(bool is_moving) {
  needs_picture_ = true;
  is_moving_ |= is_moving;
  if (is_moving) moved_s_ = watch_.seconds();
  tracing_->stop();
}

Edits& App::edit() {
  // What a thread has at hand stays as it is.
  auto edited = std::make_shared<Edits>(*edits_);
  edited->version = ++edit_count_;
  Edits& result = *edited;
  edits_ = std::move(edited);
  moment_.edits = edits_;
  return result;
}

Look App::look() const {
  Look look;
  look.model = model_;
  look.moment = moment_;
  look.light = light_;
  look.rotation = rotation_;
  look.intensity = intensity_;
  look.view = camera_.view();
  look.camera_node = camera_node_;
  look.shot = shot_;
  look.shot.size = picture_size();
  if (base_exposure_) look.exposure = *base_exposure_ * std::exp2(stops_);
  look.number = asked_;
  return look;
}

/// Asks for the picture of what has changed; for the path traced one once things stand still.
void App::ask() {
  if (model_ == nullptr || light_ == nullptr) return;
  constexpr double kRest = 0.15;  // seconds
  if (needs_picture_) {
    camera_.set_aspect(aspect());
    ++asked_;
    drawing_->draw(look(), is_moving_);
    needs_picture_ = is_moving_ = false;
    wants_trace_ = true;
  }
  const bool is_at_rest = watch_.seconds() - moved_s_ > kRest && base_exposure_.has_value();
  if (is_split_ && wants_trace_ && is_at_rest && !is_playing_ && !light_->is_plain) {
    wants_trace_ = false;
    const auto method = shot_.denoiser.value_or(denoise::Method::regression);
    tracing_->trace(look(), options_.samples, is_denoised_ ? std::optional(method) : std::nullopt);
  }
}

/// The file's camera that shows the scene, where nothing else was said.
std::optional<std::size_t> App::own_camera(const Scene& scene) const {
  const bool is_said = shot_.camera || shot_.eye || !shot_.cameras.empty() || frames_subject(shot_, std::size_t{0});
  return is_said ? std::nullopt : default_camera(scene, aspect());
}

/// From where one can look, by what the command line says.
std::vector<std::pair<std::string, View>> App::views_of(const Scene& scene, const Extent& extent) const {
  Shot shot = shot_;
  shot.size = picture_size();
  std::vector<std::pair<std::string, View>> views;
  for (const Viewpoint& viewpoint : choose_viewpoints(shot, {scene, extent, own_camera(scene)})) {
    views.emplace_back(viewpoint.description.empty() ? "start" : viewpoint.description, viewpoint.view);
  }
  return views;
}

void App::choose_views() {
  const Scene& scene = *model_->first();
  const bool is_first = !is_own_camera_;
  viewpoints_ = views_of(scene, model_->extent());
  if (is_first || viewpoint_ >= viewpoints_.size()) viewpoint_ = 0;
  camera_names_.clear();
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].camera < 0) continue;
    const Camera& camera = scene.cameras[static_cast<std::size_t>(scene.nodes[i].camera)];
    const std::string& name = !camera.name.empty() ? camera.name : scene.nodes[i].name;
    camera_names_.emplace_back(i, name.empty() ? "camera " + std::to_string(camera_names_.size()) : name);
  }
  if (is_first) {
    look_from(viewpoint_);
    camera_node_ = own_camera(scene);
    is_own_camera_ = true;
  } else if (camera_node_ && (*camera_node_ >= scene.nodes.size() || scene.nodes[*camera_node_].camera < 0)) {
    camera_node_.reset();
  }
}

void App::look_from(std::size_t viewpoint) {
  viewpoint_ = viewpoint;
  camera_node_.reset();
  const Extent& extent = model_->extent();
  camera_.set(viewpoints_[viewpoint].second, extent.empty() ? vec3(0.0f) : extent.bounds().center());
  change();
}

/// Where a place of the scene is in the window; nothing where it is behind the eye.
std::optional<vec3> App::on_screen(vec3 position) const {
  const View& view = shown_ != nullptr ? shown_->view : camera_.view();
  const vec3 p = transform_point(glm::inverse(view.world_from_camera), position);
  if (p.z >= 0.0f) return std::nullopt;
  const vec2 size(picture_size());
  vec2 ndc(0.0f);
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection)) {
    const float half = std::tan(0.5f * perspective->yfov);
    ndc = vec2(p.x / (half * size.x / size.y), p.y / half) / -p.z;
  } else {
    const auto& orthographic = std::get<OrthographicCamera>(view.projection);
    ndc = vec2(p.x / orthographic.xmag, p.y / orthographic.ymag);
  }
  return vec3((0.5f + 0.5f * ndc.x) * size.x, (0.5f - 0.5f * ndc.y) * size.y, -p.z);
}

void App::pick(vec2 position) {
  if (model_ == nullptr || light_ == nullptr) return;
  drawing_->pick(look(), ivec2(position), [this](const Picked& picked) {
    picked_ = picked;
    ++picks_;
    if (picked.sample.node < 0) return;
    material_ = material_of(*picked.scene, picked.sample);
  });
  explained_.clear();
  tracing_->explain(look(), ivec2(position), [this](std::string text) {
    explained_ = std::move(text);
    ++explanations_;
    wants_trace_ = is_split_;
  });
}

void App::judge() {
  if (model_ != nullptr && !verdict_ && !loading_->is_judging()) loading_->judge(*model_);
}

/// Each finding about a material is marked in the middle of the largest part that wears it, in the first of its nodes.
void App::place_markers() {
  markers_.clear();
  const std::shared_ptr<const Scene> scene = this->scene();
  if (scene == nullptr || !verdict_) return;
  for (std::size_t f = 0; f < verdict_->findings.size(); ++f) {
    const int wanted = verdict_->findings[f].finding.material;
    if (wanted < 0) continue;
    float largest = -1.0f;
    Marker marker{.position = vec3(0.0f), .finding = f};
    for (const Node& node : scene->nodes) {
      if (node.mesh < 0) continue;
      for (const Primitive& primitive : scene->meshes[static_cast<std::size_t>(node.mesh)].primitives) {
        if (number_of(scene->materials, static_cast<std::size_t>(primitive.material)) != wanted) continue;
        Box3 box;
        for (const vec3& p : primitive.positions) box.extend(transform_point(node.world_from_node, p));
        const float size = box.empty() ? -1.0f : glm::length(box.size());
        if (size <= largest) continue;
        largest = size;
        marker.position = box.center();
      }
    }
    if (largest >= 0.0f) markers_.push_back(marker);
  }
}

}  // namespace candela::viewer
