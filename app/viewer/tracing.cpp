#include "viewer/tracing.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "candela/explain.h"
#include "candela/taking.h"
#include "cli/explain_report.h"
#include "cli/values.h"

namespace candela::viewer {

namespace {

/// Whether two scenes differ in materials and lamps alone.
bool has_same_shapes(const Scene& a, const Scene& b) {
  if (a.meshes.size() != b.meshes.size() || a.nodes.size() != b.nodes.size()) return false;
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    if (a.meshes[i].identity == nullptr || a.meshes[i].identity != b.meshes[i].identity) return false;
  }
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if (a.nodes[i].world_from_node != b.nodes[i].world_from_node || a.nodes[i].mesh != b.nodes[i].mesh) return false;
  }
  return true;
}

}  // namespace

void Tracing::trace(Look look, int samples, std::optional<denoise::Method> denoiser) {
  worker_.ask([this, look = std::move(look), samples, denoiser](const Job& job) {
    try {
      const StopScope scope(job.stop);
      prepare(look);
      converge(look, samples, denoiser, job);
    } catch (const Interrupted&) {
      // Something else is wanted.
    } catch (const std::exception& error) {
      mailbox_.post([this, text = cli::one_line(error.what())] { told_.failed(text); });
    }
  });
}

void Tracing::explain(Look look, ivec2 pixel, std::function<void(std::string)> explained) {
  constexpr int kPaths = 1024;
  constexpr std::size_t kShown = 3;
  worker_.ask([this, look = std::move(look), pixel, explained = std::move(explained)](const Job& job) {
    std::string text;
    try {
      const StopScope scope(job.stop);
      prepare(look);
      path::Settings settings = traced_settings(look.shot);
      settings.samples = kPaths;
      Explanation explanation;
      explanation.scene = prepared_.scene;
      explanation.size = {settings.width, settings.height};
      explanation.view = view_of(look, *prepared_.scene);
      explanation.pixels.push_back(explain_pixel(*tracer_, explanation.view, settings, pixel, kShown, job));
      text = cli::explain_text(explanation);
    } catch (const Interrupted&) {
      return;  // something else is wanted
    } catch (const std::exception& error) {
      text = cli::one_line(error.what());
    }
    mailbox_.post([explained, text = std::move(text)] { explained(text); });
  });
}

/// Brings tracer_ to what a look shows, with as much of what was built as still holds.
void Tracing::prepare(const Look& look) {
  std::shared_ptr<const Scene> scene = look.model->scene(look.moment);
  const bool has_light = far_light_ != nullptr && prepared_.light != nullptr &&
                         prepared_.light->name == look.light->name && prepared_.model == look.model &&
                         prepared_.rotation == look.rotation && prepared_.intensity == look.intensity &&
                         prepared_.light->environment.map == look.light->environment.map;
  if (tracer_ != nullptr && has_light && prepared_.scene == scene) return;
  if (!has_light) far_light_ = std::make_unique<path::FarLight>(look.environment());
  const bool keeps_shapes =
      tracer_ != nullptr && prepared_.model == look.model && has_same_shapes(*prepared_.scene, *scene);
  if (keeps_shapes && prepared_.scene == scene) {
    tracer_ = std::make_unique<path::Tracer>(*tracer_, scene, *far_light_);
  } else if (!keeps_shapes || !tracer_->take_materials(scene, *far_light_, look.shot.shading)) {
    tracer_.reset();  // before there is another
    tracer_ = std::make_unique<path::Tracer>(scene, *far_light_, look.shot.shading);
  }
  prepared_ = {look.model, look.moment, look.light, look.rotation, look.intensity, std::move(scene)};
}

void Tracing::tell(const Look& look, Film film, double samples, double seconds, std::optional<denoise::Method> denoiser,
                   bool is_whole, const Job& job) {
  auto traced = std::make_shared<Traced>();
  if (denoiser) traced->is_denoised = denoise::denoise(film, *denoiser, job);
  traced->develop = develop_of(look.shot, *prepared_.scene, look.environment());
  if (look.exposure) traced->develop.exposure = look.exposure;
  if (!traced->develop.exposure) traced->develop.exposure = metered_exposure(film);
  traced->image = develop(film, traced->develop);
  traced->number = look.number;
  traced->samples = samples;
  traced->seconds = seconds;
  if (is_whole) traced->film = std::make_shared<const Film>(std::move(film));
  if (job.is_stopped()) return;
  mailbox_.post([this, traced = std::move(traced)] { told_.traced(traced); });
}

void Tracing::converge(const Look& look, int samples, std::optional<denoise::Method> denoiser, const Job& job) {
  constexpr int kSmall = 4;          // of a first look: as many pixels for one
  constexpr int kLeastDenoised = 4;  // samples: less is too little to go by
  constexpr int kStep = 64;
  const Stopwatch watch;
  const View view = view_of(look, *prepared_.scene);
  path::Settings settings = traced_settings(look.shot);
  settings.noise.reset();
  settings.time_limit_s.reset();
  settings.has_features = denoiser.has_value();
  path::Settings small = settings;
  small.width = std::max(settings.width / kSmall, 1), small.height = std::max(settings.height / kSmall, 1);
  small.samples = 1;
  small.has_features = false;
  tell(look, tracer_->render(view, small, job), 1.0 / (kSmall * kSmall), watch.seconds(), std::nullopt, false, job);
  settings.samples = samples;
  path::Picture picture(*tracer_, view, settings);
  for (int done = 0; done < samples;) {
    StopScope::check();
    done = std::min({done == 0 ? 1 : 2 * done, done + kStep, samples});
    picture.trace(done, job);
    StopScope::check();
    const bool is_denoised = denoiser && done >= kLeastDenoised;
    tell(look, picture.film(), done, watch.seconds(), is_denoised ? denoiser : std::nullopt, true, job);
  }
}

}  // namespace candela::viewer
