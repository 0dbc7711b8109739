// What the pointer and the keyboard do.

#include <algorithm>
#include <cmath>
#include <utility>

#include "raster/quantity.h"
#include "viewer/app.h"

namespace candela::viewer {

namespace {

constexpr float kRadiansPerPixel = 0.008f;
constexpr float kClickPixels = 4.0f;    // a pointer that moves less is held still
constexpr float kDividerPixels = 6.0f;  // to either side

constexpr gl::Key key(char letter) { return static_cast<gl::Key>(letter); }

}  // namespace

void App::handle(const gl::WindowEvent& event) {
  using Kind = gl::WindowEvent::Kind;
  gui_.add(event);
  switch (event.kind) {
    case Kind::pointer:
      move(event);
      break;
    case Kind::button:
      press(event);
      break;
    case Kind::scroll:
      if (gui_.wants_pointer() || event.scroll.y == 0.0f || model_ == nullptr) break;
      free_camera();
      camera_.zoom(event.scroll.y);
      change(true);
      break;
    case Kind::key:
      if (event.is_down && !gui_.wants_keyboard()) act(event);
      break;
    case Kind::drop:
      drop(event.files);
      break;
    case Kind::changed:
      change();
      break;
    case Kind::text:
    case Kind::focus:
      break;
  }
}

void App::press(const gl::WindowEvent& event) {
  pointer_ = event.position;
  if (!event.is_down) {
    const bool is_click = held_ == gl::MouseButton::left && !is_dragging_ && !is_at_divider_;
    if (held_ == event.button) {
      held_.reset();
      is_dragging_ = is_at_divider_ = false;
      if (!is_click) return change();
      pick(event.position);  // nothing else has changed, and what is traced goes on after it
    }
    return;
  }
  if (gui_.wants_pointer() || held_) return;
  held_ = event.button;
  held_modifiers_ = event.modifiers;
  pressed_at_ = event.position;
  is_dragging_ = false;
  const float divider = split_ * static_cast<float>(picture_size().x);
  is_at_divider_ = is_split_ && std::abs(event.position.x - divider) < kDividerPixels;
}

/// Left turns, with shift or by another button it moves, with control or alt it turns the environment.
void App::move(const gl::WindowEvent& event) {
  const vec2 by = event.position - std::exchange(pointer_, event.position);
  if (!held_) return;
  if (!is_dragging_ && glm::distance(event.position, pressed_at_) < kClickPixels) return;
  is_dragging_ = true;
  const vec2 size(picture_size());
  if (is_at_divider_) {
    split_ = std::clamp(event.position.x / size.x, 0.0f, 1.0f);
    return;
  }
  if (model_ == nullptr) return;
  if (held_ == gl::MouseButton::left && (held_modifiers_.control || held_modifiers_.alt)) {
    rotation_ = std::remainder(rotation_ + kRadiansPerPixel * by.x, 2.0f * kPi);
    change(true);
    return;
  }
  free_camera();
  if (held_ == gl::MouseButton::left && !held_modifiers_.shift) {
    camera_.orbit(kRadiansPerPixel * by);
  } else {
    camera_.pan(vec2(by.x, -by.y) / size.y);
  }
  change(true);
}

/// On from where the file's camera is.
void App::free_camera() {
  if (!camera_node_ || model_ == nullptr) return;
  const Extent& extent = model_->extent();
  const vec3 center = extent.empty() ? vec3(0.0f) : extent.bounds().center();
  if (shown_ != nullptr && shown_->model == model_) camera_.set(shown_->view, center);
  camera_node_.reset();
}

void App::next_quantity(int step) {
  constexpr int kCount = raster::kQuantityCount;
  const int now = static_cast<int>(shot_.drawn.quantity);
  shot_.drawn.quantity = static_cast<raster::Quantity>((now + step + kCount) % kCount);
  change();
}

void App::act(const gl::WindowEvent& event) {
  const bool has_control = event.modifiers.control, has_shift = event.modifiers.shift;
  const gl::Key pressed = event.key;
  // The keys that mean something before there is a model.
  if (pressed == gl::Key::escape) {
    if (has_help_ || picked_) {
      has_help_ = false;
      picked_.reset();
      explained_.clear();
    } else {
      is_closing_ = true;
    }
  }
  if (pressed == key('H') || pressed == key('/')) has_help_ = !has_help_;
  if (pressed == gl::Key::tab) {
    has_panels_ = !has_panels_;
    change();
  }
  if (pressed == key('R') && has_control) reload();
  if (model_ == nullptr || has_control) return;
  const auto stops = [&](float by) {
    stops_ += by;
    change();
  };
  if (pressed == key('F')) {
    free_camera();
    camera_.fit(model_->extent(), aspect());
    change();
  }
  if (pressed == key('R')) {
    is_own_camera_ = false;
    choose_views();
    change();
  }
  if (pressed == gl::Key::space && moment_.time_s) is_playing_ = !is_playing_;
  if (pressed == key('S') && !event.is_repeat) save_picture(saved_size_, {});
  if (pressed == key('T') && !event.is_repeat) {
    is_split_ = !is_split_;
    wants_trace_ = is_split_;
    if (!is_split_) tracing_->stop();
  }
  if (pressed == key('V')) next_quantity(has_shift ? -1 : 1);
  if (pressed == key('L')) shot_.drawn.quantity = raster::Quantity::light, change();
  if (pressed == key('C')) {
    has_markers_ = !has_markers_;
    if (has_markers_) judge();
  }
  if (pressed == key('=')) stops(0.25f);
  if (pressed == key('-')) stops(-0.25f);
  if (pressed == key('0')) stops(-stops_);
  // Eighths of a turn, as the pointer turns it.
  if (pressed == key('[') || pressed == key(']')) {
    rotation_ = std::remainder(rotation_ + (pressed == key('[') ? -0.25f : 0.25f) * kPi, 2.0f * kPi);
    change();
  }
  if (pressed == gl::Key::page_down || pressed == gl::Key::page_up) {
    const std::size_t count = viewpoints_.size();
    look_from((viewpoint_ + (pressed == gl::Key::page_down ? 1 : count - 1)) % count);
  }
}

}  // namespace candela::viewer
