// What of a Take is about pictures that are made in parts, or gone on with.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "candela/shot.h"
#include "path/accumulator.h"
#include "scene/environment.h"
#include "scene/posed_camera.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMagic = "candela picture so far 1\n";

std::string numbers_of(const float* values, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += fmt::format("{},", values[i]);
  return text;
}

std::string text_of(vec3 v) { return numbers_of(&v.x, 3); }

std::string text_of(const View& view) {
  std::string text = numbers_of(&view.world_from_camera[0][0], 16);
  if (const auto* p = std::get_if<PerspectiveCamera>(&view.projection)) {
    text += fmt::format("perspective {}", p->yfov);
  } else {
    const auto& o = std::get<OrthographicCamera>(view.projection);
    text += fmt::format("orthographic {} {}", o.xmag, o.ymag);
  }
  const Lens& lens = view.lens;
  return text + fmt::format(" lens {} {} {} {} planes {} {}", lens.radius, lens.focus_distance, lens.blades,
                            lens.vignetting, view.near_plane, view.far_plane);
}

/// All that changes what is sampled. Exposure, denoising and the rest come after.
std::string text_of(const path::Settings& s) {
  std::string text = fmt::format("{}x{} {} {} {} {} {} {} {} {} {} {} {}", s.width, s.height, s.bounces, s.seed,
                                 static_cast<int>(s.filter), s.filter_radius, static_cast<int>(s.integrator),
                                 s.clamp.value_or(0.0f), static_cast<int>(s.background), s.environment_in_glass,
                                 s.sees_lamps, s.sees_backdrop, s.has_features);
  for (const Layer layer : s.layers) text += fmt::format(" {}", layer_name(layer));
  for (const MatteKind kind : s.mattes) text += fmt::format(" {}", static_cast<int>(kind));
  return text;
}

std::string text_of(const Environment& e) {
  std::string text = fmt::format("{} {}{} {}", e.rotation, text_of(e.constant), e.intensity, e.suns.size());
  for (const SunDisc& sun : e.suns)
    text += text_of(sun.direction) + text_of(sun.radiance) + fmt::format("{}", sun.angular_radius);
  for (const auto& map : {e.map, e.backdrop}) {
    text += map == nullptr ? " none" : fmt::format(" {:016x}", fingerprint(std::as_bytes(std::span(map->pixels))));
  }
  return text;
}

}  // namespace

std::string Take::key() const {
  std::string text = fmt::format("{} {} ", version(), shot_.scene.starts_with("demo:") ? shot_.scene : "");
  for (const io::ReferencedFile& file : files()) {
    std::error_code code;
    if (!fs::is_regular_file(file.path, code)) continue;
    text += fmt::format("{} {:016x} ", file.place, fingerprint(read_file(file.path)));
  }
  Shot whole = shot_;
  whole.part.reset();
  const path::Settings settings = traced_settings(whole);
  const shade::ShadingModel& m = shot_.shading;
  text += fmt::format("{} of {} {} {} {} {} {} {} {} {} {}", settings.samples, text_of(settings), m.distribution,
                      m.masking, m.fresnel, m.diffuse, m.blend, m.multiscatter, m.literal_layers,
                      text_of(views()[first_index()]), text_of(environment_));
  const Planned& planned = planned_[first_index()];
  text +=
      fmt::format(" {} {} {} {} {} {} {}", shot_.load.scene, planned.variant.value_or(shot_.load.variant),
                  is_moving_ ? planned.animation : "", is_moving_ ? planned.moment_s : 0.0, shot_.load.texture_memory,
                  shot_.load.measures.metres_per_unit.value_or(0.0f), shot_.load.measures.is_z_up.value_or(false));
  if (shot_.falloff) {
    text += fmt::format(" falloff {} {}", static_cast<int>(shot_.falloff->kind),
                        text_of(shot_.falloff->polynomial.value_or(vec3(-1.0f))));
  }
  if (ground_) text += fmt::format(" ground {} {}{}", ground_->height, text_of(ground_->color), ground_->mirror);
  return fmt::format("{:016x}", fingerprint(std::as_bytes(std::span(text))));
}

void Take::set_checkpoint(Checkpoint checkpoint) {
  const bool is_one =
      end_index() - first_index() == 1 && shot_.engine == Engine::path && !(is_moving_ && shot_.shutter_s > 0.0);
  if (!is_one) throw Error("is of one traced picture without motion blur", "--checkpoint");
  checkpoint_ = std::move(checkpoint);
}

void Take::keep(const path::Picture& picture, const std::string& key) const {
  const std::string header = std::string(kMagic) + key + "\n";
  const std::vector<std::byte> state = picture.state();
  std::vector<std::byte> bytes(header.size());
  std::memcpy(bytes.data(), header.data(), header.size());
  bytes.insert(bytes.end(), state.begin(), state.end());
  write_file(checkpoint_->file, bytes);
}

/// Whether there was something to go on from.
bool Take::resume(path::Picture& picture, const std::string& key) const {
  std::error_code code;
  if (!checkpoint_->resumes || !fs::exists(checkpoint_->file, code)) return false;
  const std::string where = checkpoint_->file.string(), header = std::string(kMagic) + key + "\n";
  const std::vector<std::byte> bytes = read_file(checkpoint_->file, std::uint64_t{1} << 38);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kMagic)) throw Error("is no picture to go on with, or one of another version", where);
  if (!text.starts_with(header)) throw Error("is of another picture: another scene, version or setting", where);
  try {
    picture.set_state(std::span(bytes).subspan(header.size()));
  } catch (const Error& error) {
    throw Error(error.message(), where);
  }
  return true;
}

/// With the sums of a part, or a checkpoint.
Film Take::trace_kept(std::size_t index, Job job, path::Statistics& statistics) {
  constexpr double kMostOfTime = 0.1;  // that writing may take
  const path::Settings settings = settings_of_trace();
  path::Picture picture(*tracer_, view_at(tracer_->scene(), index), settings);
  const std::string own_key = checkpoint_ ? key() : "";  // once: it reads every file
  if (checkpoint_ && resume(picture, own_key)) warn("goes on from " + checkpoint_->file.string());
  Stopwatch since;
  double cost_s = 0.0;
  if (checkpoint_) {
    job.progress = [&, tell = job.progress](const Progress& p) {
      if (tell) tell(p);
      if (since.seconds() < std::max(checkpoint_->interval_s, cost_s / kMostOfTime)) return;
      const Stopwatch writing;
      keep(picture, own_key);
      cost_s = writing.seconds();
      since = {};
    };
  }
  picture.trace(settings.samples, job);
  statistics = picture.statistics();
  if (checkpoint_ && statistics.interrupted) keep(picture, own_key);
  if (shot_.part) {
    sums_.clear();
    picture.sums().write(sums_);
    has_through_ = picture.has_through();
  }
  return picture.film();
}

std::shared_ptr<const PicturePart> Take::part_of(const TakenPicture& picture) const {
  const path::Settings settings = settings_of_trace();
  Shot whole = shot_;
  whole.part.reset();
  auto part = std::make_shared<PicturePart>();
  part->key = key();
  part->first_sample = settings.first_sample;
  part->end_sample = settings.samples;
  part->samples = traced_settings(whole).samples;
  part->size = shot_.size;
  part->layers = shot_.layers;
  part->mattes = shot_.mattes;
  part->has_features = settings.has_features;
  part->has_through = has_through_;
  part->camera_from_world = glm::transpose(mat3(camera_rotation(picture.view)));
  for (const auto& [kind, mattes] : picture.film.mattes) part->names[kind] = mattes.names;
  for (const auto& [layer, image] : picture.film.layers) {
    if (!layer_info(layer).has_mean) part->centres[layer] = image;
  }
  part->metadata = picture.film.metadata;
  part->develop = develop_;
  part->denoiser = shot_.denoiser;
  part->sums = sums_;
  return part;
}

}  // namespace candela
