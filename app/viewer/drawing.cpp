#include "viewer/drawing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "candela/taking.h"
#include "cli/values.h"

namespace candela::viewer {

namespace {

constexpr double kQuick = 0.05;  // seconds that a frame may take while something moves
constexpr double kLong = 0.12;   // seconds from which on a frame is drawn so that it can be stopped

/// Whether a picture is more than what the driver has drawn: a ground, a background, a glow are added to it.
bool is_composed(const Shot& shot, const Scene& scene) {
  const raster::Quantity quantity = shot.drawn.quantity;
  return scene.ground || shot.background != Background::environment || shot.bloom > 0.0f || shot.vignetting > 0.0f ||
         raster::shows_numbers(quantity);
}

}  // namespace

/// What drawer_ was given.
struct Drawing::Prepared {
  std::shared_ptr<Model> model;
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const FarLight> light;
};

Drawing::Drawing(Mailbox& mailbox, Told told) : mailbox_(mailbox), told_(std::move(told)) {
  worker_ = std::make_unique<Worker>([this] {
    // What the driver holds belongs to this thread.
    sketch_.reset();
    drawer_.reset();
    device_.reset();
  });
  // While the file is read.
  worker_->add_errand([this](const Job&) { attempt([] {}); });
}

Drawing::~Drawing() = default;

void Drawing::attempt(const std::function<void()>& work) {
  try {
    if (device_ == nullptr) device_ = std::make_shared<raster::Device>();
    work();
  } catch (const Interrupted&) {
    // Something else is wanted.
  } catch (const std::exception& error) {
    mailbox_.post([this, text = cli::one_line(error.what())] { told_.failed(text); });
  }
  mailbox_.post([this] { told_.working(""); });
  tell_warnings();
}

void Drawing::tell_warnings() {
  const std::vector<Diagnostic>& all = diagnostics_.warnings();
  if (told_warnings_ == all.size()) return;
  std::vector<Diagnostic> news(all.begin() + static_cast<std::ptrdiff_t>(told_warnings_), all.end());
  told_warnings_ = all.size();
  mailbox_.post([this, news = std::move(news)] { told_.warned(news); });
}

void Drawing::sketch(std::shared_ptr<const Scene> scene, View view, ivec2 size) {
  worker_->ask([this, scene = std::move(scene), view, size](const Job&) {
    attempt([&] {
      const Stopwatch watch;
      sketch_ = std::make_unique<raster::Sketch>(*scene, device_);
      auto shown = std::make_shared<Shown>();
      shown->image = sketch_->draw(view, size);
      shown->view = view;
      shown->is_sketch = true;
      shown->seconds = watch.seconds();
      sketch_.reset();
      mailbox_.post([this, shown = std::move(shown)] { told_.shown(shown); });
    });
  });
}

raster::Settings Drawing::settings_of(const Look& look) const {
  raster::Settings settings = drawn_settings(look.shot);
  settings.frames = 1;
  return settings;
}

DevelopSettings Drawing::develop_of(const Look& look, const Scene& scene) {
  DevelopSettings develop = candela::develop_of(look.shot, scene, look.environment());
  if (raster::shows_numbers(look.shot.drawn.quantity)) return develop;
  if (look.exposure) develop.exposure = look.exposure;
  if (!develop.exposure) develop.exposure = metered_;
  return develop;
}

/// Brings drawer_ to what a look shows.
const Scene& Drawing::prepare(const Look& look, const Job& job) {
  const StopScope scope(job.stop);
  std::shared_ptr<const Scene> scene = look.model->scene(look.moment);
  const bool is_kept = prepared_ != nullptr && prepared_->model == look.model &&
                       prepared_->scene->materials.size() == scene->materials.size() &&
                       prepared_->scene->ies_profiles.size() == scene->ies_profiles.size();
  if (prepared_ == nullptr || prepared_->light != look.light || prepared_->model != look.model) metered_.reset();
  if (!is_kept) {
    mailbox_.post([this] { told_.working("uploading, compiling shaders"); });
    prepared_.reset();
    drawer_.reset();  // before there is another
    drawer_ = std::make_unique<raster::Drawer>(scene, look.light->environment, look.shot.shading, device_);
    drawer_->set_environment(look.light->environment, look.light->baked);
  } else {
    if (prepared_->scene != scene) drawer_->set_scene(scene);
    if (prepared_->light != look.light) drawer_->set_environment(look.light->environment, look.light->baked);
  }
  prepared_ = std::make_unique<Prepared>(Prepared{look.model, std::move(scene), look.light});
  const Environment lit = look.environment();
  drawer_->turn_environment(lit.rotation, lit.intensity);
  return *prepared_->scene;
}

/// What can be drawn in a moment, by how long the last one took.
ivec2 Drawing::quick_size(ivec2 whole) const {
  constexpr float kLeastScale = 0.2f;
  const double expected = seconds_per_pixel_ * whole.x * whole.y;
  const float scale =
      expected > kQuick ? std::max(static_cast<float>(std::sqrt(kQuick / expected)), kLeastScale) : 1.0f;
  // In steps, for targets of another size have to be made.
  const float steps = 8.0f;
  const float stepped = std::max(std::floor(scale * steps) / steps, kLeastScale);
  return glm::max(ivec2(vec2(whole) * stepped), ivec2(1));
}

int Drawing::bands_of(ivec2 size) const {
  const double expected = seconds_per_pixel_ * size.x * size.y;
  return expected > kLong ? std::clamp(static_cast<int>(expected / kLong), 2, 8) : 1;
}

void Drawing::draw_at(const Look& look, ivec2 size, const Job& job, bool is_whole) {
  const Scene& scene = prepare(look, job);
  raster::Settings settings = settings_of(look);
  settings.width = size.x, settings.height = size.y;
  auto shown = std::make_shared<Shown>();
  shown->model = look.model;
  shown->scene = prepared_->scene;
  shown->number = look.number;
  shown->view = view_of(look, scene);
  shown->is_whole = is_whole;
  const Job told{.stop = job.stop, .diagnostics = &diagnostics_};
  DevelopSettings development = develop_of(look, scene);
  const Stopwatch drawing;
  if (is_composed(look.shot, scene)) {
    const Film film = drawer_->render(shown->view, settings, told);
    if (!development.exposure) development.exposure = metered_ = metered_exposure(film);
    shown->image = develop(film, development);
  } else {
    drawer_->draw_frame(shown->view, settings, told, is_whole ? bands_of(size) : 1);
    if (!development.exposure) development.exposure = metered_ = metered_exposure(drawer_->read_frame());
    shown->image = drawer_->read_shown(*development.exposure, development.tone_curve);
  }
  const double pixels = static_cast<double>(size.x) * size.y;
  // A first frame compiles; it says nothing of the next.
  const double took = drawing.seconds();
  if (drawn_once_ == drawer_.get()) {
    seconds_per_pixel_ = took / pixels;
  } else {
    drawn_once_ = drawer_.get();
    seconds_per_pixel_ = std::min(seconds_per_pixel_, took / pixels);
  }
  shown->exposure = development.exposure.value_or(1.0f);
  shown->seconds = took;
  mailbox_.post([this, shown = std::move(shown)] { told_.shown(shown); });
}

void Drawing::draw(Look look, bool is_moving) {
  worker_->ask([this, look = std::move(look), is_moving](const Job& job) {
    if (is_broken_) return;
    attempt([&] {
      try {
        const ivec2 whole = look.shot.size;
        const bool is_first = prepared_ == nullptr || prepared_->model != look.model;
        const ivec2 quick = quick_size(whole);
        const bool is_quick = quick != whole && (is_moving || is_first);
        // The small one is not stopped, or nothing would be seen while something moves on and on.
        if (is_quick) draw_at(look, quick, is_first ? job : Job{}, false);
        if (is_moving && is_quick) wait_for_rest(job);
        draw_at(look, whole, job, true);
      } catch (const Error&) {
        // Without the user's shaders nothing would change by trying again.
        is_broken_ = !look.shot.drawn.shader_folder.empty();
        throw;
      }
    });
  });
}

/// A while in which nothing new was asked for. Throws Interrupted where something was.
void Drawing::wait_for_rest(const Job& job) {
  constexpr int kSteps = 20;
  const StopScope scope(job.stop);
  for (int i = 0; i < kSteps; ++i) {
    StopScope::check();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void Drawing::take(Look look, std::function<void(Film, DevelopSettings)> taken) {
  worker_->add_errand([this, look = std::move(look), taken = std::move(taken)](const Job& job) {
    attempt([&] {
      const Scene& scene = prepare(look, job);
      Film film = drawer_->render(view_of(look, scene), settings_of(look), {.diagnostics = &diagnostics_});
      DevelopSettings develop = develop_of(look, scene);
      if (!develop.exposure) develop.exposure = metered_exposure(film);
      mailbox_.post(
          [taken, film = std::make_shared<Film>(std::move(film)), develop] { taken(std::move(*film), develop); });
    });
  });
}

void Drawing::pick(Look look, ivec2 pixel, std::function<void(Picked)> picked) {
  worker_->add_errand([this, look = std::move(look), pixel, picked = std::move(picked)](const Job& job) {
    attempt([&] {
      // Lights and parts of them do not matter for what is where.
      const Scene& scene = prepare(look, job);
      const ivec2 size = look.shot.size;
      Picked found{.pixel = pixel, .size = size, .scene = prepared_->scene, .sample = {}, .view = view_of(look, scene)};
      raster::Settings settings = settings_of(look);
      drawer_->draw_frame(found.view, settings, {});
      const SurfaceMap map = drawer_->read_surfaces(found.view);
      if (pixel.x >= 0 && pixel.y >= 0 && pixel.x < map.width && pixel.y < map.height) {
        found.sample = map.at(pixel.x, pixel.y);
      }
      mailbox_.post([picked, found] { picked(found); });
    });
  });
}

void Drawing::reload_shaders() {
  worker_->add_errand([this](const Job&) {
    attempt([&] {
      if (drawer_ != nullptr) drawer_->reload_shaders();
      is_broken_ = false;
    });
  });
}

}  // namespace candela::viewer
