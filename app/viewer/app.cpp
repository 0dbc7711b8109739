#include "viewer/app.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.h"
#include "cli/inputs.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/scene_list.h"
#include "cli/values.h"
#include "content/make_environment.h"
#include "raster/quantity.h"
#include "viewer/script.h"

namespace candela::viewer {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostMessages = 200;

std::string file_name_of(const std::string& scene) {
  return scene.starts_with("demo:") ? scene : fs::path(scene).filename().string();
}

/// The shot of a window shows one picture, whatever its options could say of several.
Shot shot_of(const ViewOptions& options) {
  Shot shot = options.render.shot;
  shot.load.counts_texture_levels = true;
  shot.engine = Engine::raster;
  return shot;
}

}  // namespace

App::App(const ViewOptions& options, std::unique_ptr<Script> script)
    : options_(options),
      shot_(shot_of(options)),
      window_(file_name_of(shot_.scene) + " - candela", shot_.size),
      gui_(window_),
      mailbox_(gl::Window::wake),
      is_split_(options.is_split),
      has_panels_(options.frames == 0) {
  std::cerr << fmt::format("window after {:.2f} s\n", watch_.seconds());
  tracing_ = std::make_unique<Tracing>(mailbox_, tracing_told());
  drawing_ = std::make_unique<Drawing>(mailbox_, drawing_told());
  loading_ = std::make_unique<Loading>(mailbox_, loading_told());
  edits_ = std::make_shared<const Edits>();
  light_name_ = shot_.environment.value_or("");
  is_denoised_ = shot_.denoiser.has_value();
  if (!shot_.drawn.shader_folder.empty()) watched_shaders_.set({shot_.drawn.shader_folder});
  script_ = std::move(script);
  open(shot_.scene);
}

App::~App() = default;

Drawing::Told App::drawing_told() {
  Drawing::Told told;
  told.shown = [this](std::shared_ptr<const Shown> shown) { take_shown(std::move(shown)); };
  told.failed = [this](std::string text) { say(std::move(text), true); };
  told.warned = [this](const std::vector<Diagnostic>& warnings) { warn(warnings); };
  told.working = [this](std::string what) { working_ = std::move(what); };
  return told;
}

Tracing::Told App::tracing_told() {
  Tracing::Told told;
  told.traced = [this](std::shared_ptr<const Traced> traced) {
    if (traced->number != asked_) return;  // of what was before
    traced_ = std::move(traced);
    traced_picture_.set(traced_->image);
  };
  told.failed = [this](std::string text) { say(std::move(text), true); };
  return told;
}

Loading::Told App::loading_told() {
  Loading::Told told;
  told.outlined = [this](std::shared_ptr<const Scene> scene) {
    if (model_ != nullptr) return;  // what is shown is better
    has_outline_ = true;
    const View view = views_of(*scene, Extent(*scene)).front().second;
    drawing_->sketch(std::move(scene), view, picture_size());
  };
  told.loaded = [this](std::shared_ptr<Model> model) { take_model(std::move(model)); };
  told.load_failed = [this](std::string text) {
    if (model_ == nullptr && script_ == nullptr) throw Error(text);
    say(std::move(text), true);
  };
  told.lit = [this](std::shared_ptr<const FarLight> light, const std::vector<Diagnostic>& warnings) {
    warn(warnings);
    take_light(std::move(light));
  };
  told.light_failed = [this](std::string text) {
    if (light_ == nullptr && script_ == nullptr) throw Error(text);
    say(std::move(text), true);
    light_name_ = light_ != nullptr ? light_->name : "";
  };
  told.judged = [this](Verdict verdict) {
    verdict_ = std::move(verdict);
    place_markers();
  };
  return told;
}

void App::say(std::string text, bool is_error) {
  std::cerr << (is_error ? "candela: " : "") << text << '\n';
  failures_ += is_error ? 1 : 0;
  if (!messages_.empty() && messages_.back().text == text) messages_.pop_back();
  messages_.push_back({std::move(text), is_error, watch_.seconds()});
  if (messages_.size() > kMostMessages) messages_.pop_front();
}

void App::warn(const std::vector<Diagnostic>& warnings) {
  for (const Diagnostic& warning : warnings) say("warning: " + cli::one_line(warning.text()));
}

void App::set_title() { window_.set_title(file_name_of(shot_.scene) + " - candela"); }

// ----- opening

void App::open(const std::string& model) {
  Shot shot = shot_;
  if (model != shot_.scene) {
    // What was said of one file says nothing of another.
    shot.scene = model;
    shot.load.variant.clear();
    shot.load.scene.clear();
    shot.animation.reset();
    shot.moment_s.reset();
    shot.camera.reset();
  }
  loading_->load(std::move(shot));
}

void App::open_light(const std::string& name) {
  light_name_ = name;
  if (model_ != nullptr) loading_->light(model_, light_name_, shot_.drawn.cache, light_ == nullptr);
}

void App::reload() {
  open(shot_.scene);
  if (!shot_.drawn.shader_folder.empty()) drawing_->reload_shaders();
}

/// The first model and the first environment of what is dropped.
void App::drop(const std::vector<std::string>& files) {
  const auto light = std::find_if(files.begin(), files.end(), is_environment_file);
  const auto model = std::find_if_not(files.begin(), files.end(), is_environment_file);
  if (light != files.end()) open_light(*light);
  if (model != files.end()) open(*model);
}

void App::take_model(std::shared_ptr<Model> model) {
  const bool is_another = model_ == nullptr || model_->name() != model->name();
  model_ = std::move(model);
  shot_.scene = model_->name();
  shot_.load = model_->shot().load;
  shot_.animation = model_->shot().animation;
  shot_.moment_s = model_->shot().moment_s;
  shot_.camera = model_->shot().camera;
  shot_.background = model_->shot().background;
  shot_.background_color = model_->shot().background_color;
  ++loads_;
  warn(model_->warnings());
  picked_.reset();
  explained_.clear();
  thumbnails_.clear();
  if (is_another) {
    edits_ = std::make_shared<const Edits>();
    moment_ = model_->first_moment();
    is_playing_ = moment_.time_s.has_value() && !shot_.moment_s;
    material_ = 0;
    stops_ = 0.0f;
    base_exposure_.reset();
    light_since_ = asked_;
    is_own_camera_ = false;
  }
  moment_.edits = edits_;
  verdict_.reset();
  markers_.clear();
  choose_views();
  std::vector<fs::path> paths;
  for (const io::ReferencedFile& file : model_->files()) paths.push_back(file.path);
  if (!light_name_.empty() && !is_built_in_environment(light_name_)) paths.emplace_back(light_name_);
  if (options_.is_watching) watched_.set(std::move(paths));
  if (shown_ == nullptr && !has_outline_) drawing_->sketch(model_->first(), camera_.view(), picture_size());
  set_title();
  // What lights another model may be the model's own, and the baked light may need another lobe.
  loading_->light(model_, light_name_, shot_.drawn.cache, light_ == nullptr);
  change();
}

void App::take_light(std::shared_ptr<const FarLight> light) {
  const bool is_another = light_ == nullptr || light_->name != light->name || light->is_plain;
  light_ = std::move(light);
  if (is_another) {
    base_exposure_.reset();
    light_since_ = asked_;
  }
  change();
}

void App::take_shown(std::shared_ptr<const Shown> shown) {
  shown_ = std::move(shown);
  drawn_picture_.set(shown_->image);
  if (!has_first_picture_) {
    has_first_picture_ = true;
    std::cerr << fmt::format("first picture after {:.2f} s\n", watch_.seconds());
  }
  if (shown_->is_sketch) return;
  if (!has_first_light_) {
    has_first_light_ = true;
    std::cerr << fmt::format("in full light after {:.2f} s\n", watch_.seconds());
  }
  if (!base_exposure_ && shown_->number > light_since_) {
    base_exposure_ = shown_->exposure;
    if (stops_ != 0.0f) change();
  }
  drawn_ = std::max(drawn_, shown_->number);
  if (!shown_->is_whole) return;
  if (whole_frames_++ == 0) first_frame_s_ = watch_.seconds();
  if (options_.frames == 0) return;
  if (whole_frames_ < options_.frames) {
    change();
  } else {
    is_closing_ = true;
  }
}

// ----- saving

void App::save_picture(ivec2 size, const fs::path& path) {
  if (model_ == nullptr || light_ == nullptr) {
    say("there is no picture yet", true);
    return;
  }
  Look taken = look();
  if (size != ivec2(0)) taken.shot.size = size;
  taken.exposure = taken.exposure ? taken.exposure : std::optional(shown_ != nullptr ? shown_->exposure : 1.0f);
  drawing_->take(std::move(taken), [this, path](const Film& film, const DevelopSettings& develop) {
    write_picture(path, film, develop);
  });
}

/// A file of the user's is never the price of a key: where there is one of that name, the next free number is added.
void App::write_picture(const fs::path& path, const Film& film, const DevelopSettings& develop) {
  cli::Inputs inputs;
  inputs.add(model_->files());
  inputs.add_environment(light_name_);
  const fs::path wanted = path.empty() ? fs::path(cli::default_stem(shot_.scene) + ".png") : path;
  fs::path free = wanted;
  std::error_code code;
  for (int i = 2; fs::exists(fs::symlink_status(free, code)) || inputs.contains(free); ++i) {
    free = wanted.parent_path() / fmt::format("{}-{}{}", wanted.stem().string(), i, wanted.extension().string());
  }
  try {
    check_output_extension(free);
    write_film(free, film, develop);
    say("saved " + free.string());
    ++saves_;
  } catch (const Error& error) {
    say(cli::one_line(error.what()), true);
  }
}

void App::save_traced() { write_picture({}, *traced_->film, traced_->develop); }

void App::save_window(const fs::path& path) {
  // What is on the screen is drawn once more, for a swapped buffer may hold anything.
  frame();
  if (cli::has_extension(path, ".jpg") || cli::has_extension(path, ".jpeg")) {
    write_jpeg(path, last_window_);
  } else if (cli::has_extension(path, ".webp")) {
    write_webp(path, last_window_);
  } else {
    write_png(path, last_window_);
  }
}

// ----- for scripts

bool App::has(const std::string& what, int count) const {
  if (what == "loaded") return loads_ >= count && !loading_->is_loading();
  if (what == "lit") return light_ != nullptr && !light_->is_plain && !loading_->is_lighting();
  if (what == "judged") return verdict_.has_value();
  if (what == "picked") return picks_ >= count;
  if (what == "explained") return explanations_ >= count;
  if (what == "saved") return saves_ >= count;
  if (what == "failed") return failures_ >= count;
  if (what == "sketched") return shown_ != nullptr;
  if (what == "drawn") {
    return shown_ != nullptr && shown_->is_whole && !needs_picture_ && drawn_ == asked_ && has("lit", 1) &&
           !loading_->is_loading();
  }
  if (what == "traced") {
    return traced_ != nullptr && traced_->number == asked_ && !wants_trace_ && traced_->samples >= count;
  }
  throw Error("unknown: wait " + what);
}

std::string App::state() {
  nlohmann::ordered_json json;
  json["model"] = model_ != nullptr ? model_->name() : "";
  json["environment"] = light_ != nullptr ? light_->environment.name : "";
  json["window"] = {window_.size().x, window_.size().y};
  const mat4& m = camera_.view().world_from_camera;
  json["eye"] = {m[3].x, m[3].y, m[3].z};
  json["pivot"] = {camera_.pivot().x, camera_.pivot().y, camera_.pivot().z};
  json["camera"] = camera_node_ ? static_cast<int>(*camera_node_) : -1;
  json["turned"] = rotation_;
  json["exposure"] = shown_ != nullptr ? shown_->exposure : 0.0f;
  json["quantity"] = raster::quantity_name(shot_.drawn.quantity);
  json["moment"] = moment_.time_s.value_or(0.0);
  json["playing"] = is_playing_;
  json["variant"] = moment_.variant.value_or("");
  json["edits"] = edit_count_;
  json["split"] = is_split_;
  json["samples"] = traced_ != nullptr ? traced_->samples : 0.0;
  json["help"] = has_help_;
  json["findings"] = verdict_ ? static_cast<int>(verdict_->findings.size()) : -1;
  json["markers"] = markers_.size();
  if (picked_) {
    json["picked"] = {{"pixel", {picked_->pixel.x, picked_->pixel.y}}, {"node", picked_->sample.node}};
  }
  json["explained"] = explained_;
  json["material"] = material_;
  json["loads"] = loads_;
  json["message"] = messages_.empty() ? "" : messages_.back().text;
  json["slowest_ms"] = 1e3 * std::exchange(slowest_s_, 0.0);
  return json.dump();
}

// ----- going on

void App::watch() {
  if (options_.is_watching && watched_.has_changed(watch_.seconds())) {
    say("reading " + file_name_of(shot_.scene) + " again");
    reload();
  }
  if (watched_shaders_.has_changed(watch_.seconds())) {
    drawing_->reload_shaders();
    std::cerr << "shaders reloaded\n";
    change();
  }
}

/// Of the one that is chosen.
double App::animation_length() const {
  double length = 0.0;
  const std::vector<io::AnimationInfo>& animations = model_->info().animations;
  for (std::size_t i = 0; i < animations.size(); ++i) {
    const bool is_chosen = moment_.animation == "all" || moment_.animation == animations[i].name ||
                           moment_.animation == std::to_string(i) || (moment_.animation.empty() && i == 0);
    if (is_chosen) length = std::max(length, static_cast<double>(animations[i].duration_s));
  }
  return length;
}

void App::play() {
  const double now = watch_.seconds();
  const double passed = now - std::exchange(last_s_, now);
  if (!is_playing_ || model_ == nullptr || !moment_.time_s) return;
  const double length = animation_length();
  if (!(length > 0.0)) return;
  // While a frame is being drawn the next is not asked for: what moves goes on where it then is.
  play_lag_ += passed * speed_;
  if (drawing_->is_busy() && asked_ != drawn_) return;
  moment_.time_s = std::fmod(*moment_.time_s + std::exchange(play_lag_, 0.0), length);
  change(true);
}

void App::frame() {
  const ivec2 size = window_.size();
  if (size.x < 1 || size.y < 1) return;
  const double now = watch_.seconds();
  gui_.begin(size, now - std::exchange(framed_s_, now));
  build();
  gui_.draw(size);
  if (script_ != nullptr) last_window_ = Gui::read(size);
  window_.swap();
}

void App::attend() {
  // Nothing is drawn again that does not change.
  const bool is_telling = !messages_.empty() && watch_.seconds() - messages_.back().at_s < kErrorsFor + 1.0;
  const double patience = lively_ > 0 ? 0.004 : is_playing_ || script_ != nullptr ? 0.01 : is_telling ? 0.1 : 0.25;
  const std::vector<gl::WindowEvent> events = window_.wait(patience);
  const double began = watch_.seconds();
  lively_ = events.empty() ? std::max(lively_ - 1, 0) : 3;
  for (const gl::WindowEvent& event : events) handle(event);
  if (mailbox_.read()) lively_ = std::max(lively_, 1);
  if (script_ != nullptr && script_->play(*this)) lively_ = 3;
  watch();
  play();
  ask();
  frame();
  slowest_s_ = std::max(slowest_s_, watch_.seconds() - began);
}

void App::run() {
  last_s_ = watch_.seconds();
  const cli::Interrupt interrupt;
  while (!is_closing_ && !window_.wants_to_close() && !cli::Interrupt::requested()) attend();
  window_.hide();
  if (options_.frames > 1 && whole_frames_ > 1) {
    const double each = (watch_.seconds() - first_frame_s_) / (whole_frames_ - 1);
    std::cerr << fmt::format("{} frames, {:.1f} ms each\n", whole_frames_, 1e3 * each);
  }
  if (script_ != nullptr && !script_->has_ended() && !is_closing_) {
    throw Error("the window was closed before its end", options_.script.string());
  }
}

void show(const ViewOptions& options) {
  // Before a window comes and goes.
  const std::string& scene = options.render.shot.scene;
  if (!scene.starts_with("demo:") && !fs::exists(scene)) throw Error("there is no such file", scene);
  auto script = options.script.empty() ? nullptr : std::make_unique<Script>(options.script);
  App(options, std::move(script)).run();
}

}  // namespace candela::viewer
