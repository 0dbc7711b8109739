#include "cli/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <thread>

#include "base/diagnostics.h"
#include "base/error.h"
#include "candela/cache.h"
#include "candela/candela.h"
#include "cli/output.h"
#include "cli/render_outputs.h"
#include "cli/scene_list.h"
#include "cli/values.h"
#include "content/make_environment.h"
#include "gl/window.h"
#include "raster/render.h"
#include "scene/environment.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

/// When anything below a folder was written last.
fs::file_time_type last_change(const std::string& folder) {
  fs::file_time_type latest = fs::file_time_type::min();
  std::error_code code;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, code)) {
    if (entry.is_regular_file(code)) latest = std::max(latest, entry.last_write_time(code));
  }
  return latest;
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A scene in a window, from where the user turns it to.
class Viewer {
 public:
  explicit Viewer(const ViewOptions& o);
  void run();

 private:
  void react(const gl::Window::Input& input);
  void watch_shaders();
  void draw();
  void save();
  void report_warnings();
  View view();

  double opened_s_ = seconds_now();
  ViewOptions options_;
  Diagnostics diagnostics_;
  std::size_t reported_ = 0;  ///< of `diagnostics_`
  Asset asset_;
  std::shared_ptr<const Scene> scene_;
  Environment environment_;
  std::shared_ptr<const Scene> at_rest_;  ///< is what is framed: what moves shall not move the camera
  Extent extent_;                         ///< of it
  DevelopSettings develop_;
  gl::Window window_;
  raster::Settings settings_;
  raster::Drawer drawer_;
  Orbit orbit_;
  View framed_;  ///< as first seen, for a window of that shape
  float framed_aspect_ = 0.0f;
  std::optional<std::size_t> camera_;  ///< the node of the scene's own
  bool is_turned_ = false;             ///< by the user, away from it
  bool is_playing_ = false;
  double moment_s_ = 0.0, last_s_ = 0.0;
  bool is_broken_ = false;  ///< the shaders do not compile; the last picture stays
  bool has_frame_ = false;
  fs::file_time_type shaders_changed_;
  double next_look_s_ = 0.0;
  int drawn_ = 0;
};

raster::Settings settings_of(const ViewOptions& o) {
  raster::Settings settings;
  settings.width = o.size.x;
  settings.height = o.size.y;
  settings.shader_folder = o.shader_folder;
  settings.cache = cache_folder();
  return settings;
}

Viewer::Viewer(const ViewOptions& o)
    : options_(o),
      asset_(o.scene, &diagnostics_,
             LoadOptions{.root = o.root,
                         .scene = o.scene_choice,
                         .measures = o.measures,
                         .texture_memory = o.texture_memory,
                         .counts_texture_levels = true}),
      scene_(std::make_shared<const Scene>(asset_.scene())),
      environment_(o.environment ? make_environment(*o.environment, &diagnostics_)
                                 : default_light(*scene_, &diagnostics_)),
      at_rest_(scene_),
      extent_(*at_rest_),
      develop_(default_develop(*scene_, environment_)),
      window_("candela: " + o.scene, o.size),
      settings_(settings_of(o)),
      drawer_(scene_, environment_, shade::shading_model_candela(), raster::Device::of_current_context()) {
  const ivec2 size = window_.size();
  const float aspect = static_cast<float>(std::max(size.x, 1)) / static_cast<float>(std::max(size.y, 1));
  camera_ = default_camera(*scene_, aspect, &diagnostics_);
  orbit_ = default_orbit(*scene_, extent_.bounds());
  report_warnings();
  is_playing_ = asset_.is_animated();
  if (!options_.shader_folder.empty()) shaders_changed_ = last_change(options_.shader_folder);
  last_s_ = seconds_now();
}

void Viewer::report_warnings() {
  for (; reported_ < diagnostics_.warnings().size(); ++reported_) {
    std::cerr << "warning: " << diagnostics_.warnings()[reported_].text() << '\n';
  }
}

/// At first as `candela render` has it; then around the subject, at the same distance however wide it is from there.
View Viewer::view() {
  const float aspect = static_cast<float>(settings_.width) / static_cast<float>(settings_.height);
  if (!is_turned_ && camera_) return scene_camera(*scene_, scene_->nodes[*camera_], aspect);
  if (framed_aspect_ != aspect) {
    framed_ = frame(extent_, {.orbit = default_orbit(*at_rest_, extent_.bounds()), .aspect = aspect});
    framed_aspect_ = aspect;
  }
  return moved_to(framed_, extent_.empty() ? vec3(0.0f) : extent_.bounds().center(), orbit_);
}

void Viewer::save() {
  Inputs inputs;
  inputs.add(asset_.files());
  inputs.add_environment(options_.environment.value_or(""));
  const fs::path path = free_name({}, default_stem(options_.scene), inputs);
  write_film(path, drawer_.read_frame(), develop_);
  std::cerr << path.string() << '\n';
}

void Viewer::react(const gl::Window::Input& input) {
  constexpr float kRadiansPerPixel = 0.008f;
  constexpr float kSteepest = 1.5f;
  if (input.drag != vec2(0.0f) || input.scroll != 0.0f) {
    is_turned_ = true;
    orbit_.azimuth -= kRadiansPerPixel * input.drag.x;
    orbit_.elevation = std::clamp(orbit_.elevation + kRadiansPerPixel * input.drag.y, -kSteepest, kSteepest);
    orbit_.distance_scale = std::clamp(orbit_.distance_scale * std::exp2(-0.2f * input.scroll), 0.05f, 20.0f);
  }
  for (const char key : input.keys) {
    if (key == ' ') is_playing_ = !is_playing_ && asset_.is_animated();
    if (key == 'R') drawer_.reload_shaders(), is_broken_ = false;
    if (key == 'S' && has_frame_) save();
  }
}

/// Shaders that changed on disk are compiled anew; where they are wrong, it says so and waits for the next change.
void Viewer::watch_shaders() {
  constexpr double kLookEvery = 0.3;  // seconds
  if (options_.shader_folder.empty() || seconds_now() < next_look_s_) return;
  next_look_s_ = seconds_now() + kLookEvery;
  const fs::file_time_type changed = last_change(options_.shader_folder);
  if (changed == shaders_changed_) return;
  shaders_changed_ = changed;
  drawer_.reload_shaders();
  is_broken_ = false;
  std::cerr << "shaders reloaded\n";
}

void Viewer::draw() {
  const ivec2 size = window_.size();
  if (size.x < 1 || size.y < 1) return;
  settings_.width = size.x, settings_.height = size.y;
  if (is_playing_) {
    const double length = asset_.duration_s("");
    moment_s_ = length > 0.0 ? std::fmod(moment_s_ + seconds_now() - last_s_, length) : 0.0;
    scene_ = std::make_shared<const Scene>(asset_.scene(Pose{"", moment_s_}));
    drawer_.set_scene(scene_);
  }
  last_s_ = seconds_now();
  if (is_broken_) {
    // Nothing to draw with; not so fast that it keeps the machine busy.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return;
  }
  try {
    drawer_.draw_frame(view(), settings_, {.diagnostics = &diagnostics_});
    has_frame_ = true;
    report_warnings();
    if (!develop_.exposure) develop_.exposure = metered_exposure(drawer_.read_frame());
    drawer_.present(size, develop_.exposure.value_or(1.0f), develop_.tone_curve);
  } catch (const Error& error) {
    if (options_.shader_folder.empty()) throw;
    is_broken_ = true;
    std::cerr << "candela: " << one_line(error.what()) << '\n';
  }
  window_.swap();
  ++drawn_;
}

void Viewer::run() {
  std::optional<double> first;
  while (options_.frames == 0 || drawn_ < options_.frames) {
    const gl::Window::Input input = window_.poll();
    if (input.wants_to_close) break;
    react(input);
    watch_shaders();
    draw();
    if (drawn_ == 1 && !first) {
      first = seconds_now();
      std::cerr << fmt::format("first picture after {:.1f} s\n", *first - opened_s_);
    }
  }
  if (options_.frames > 1 && drawn_ > 1) {
    std::cerr << fmt::format("{} frames, {:.1f} ms each\n", drawn_, 1e3 * (seconds_now() - *first) / (drawn_ - 1));
  }
}

}  // namespace

void show(const ViewOptions& options) { Viewer(options).run(); }

}  // namespace candela::cli
