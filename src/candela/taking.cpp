#include "candela/taking.h"

#include <fmt/format.h>

#include <utility>

#include "base/stopwatch.h"
#include "io/vertex_frames.h"
#include "scene/material_table.h"

namespace candela {

Shot takeable(Shot shot) {
  if (shot.engine == Engine::raster) raster::check_built();
  if (shot.engine == Engine::path || shot.probes > 0) path::check_built();
  shot.load.counts_texture_levels |= shot.engine == Engine::raster;
  if (shot.ground && shot.ground->color && shot.background == Background::environment) {
    shot.background = Background::transparent;
    shot.background_color = shot.ground->color;
  }
  return shot;
}

Ground ground_of(const Shot& shot, const Scene& scene) {
  const GroundChoice& choice = *shot.ground;
  Ground ground;
  // A little below, so that a floor of the scene's own hides it.
  const Box3 subject = subject_bounds(scene);
  ground.height = choice.height.value_or(subject.lower.y - 1e-4f * glm::length(subject.size()));
  ground.mirror = choice.mirror;
  const std::optional<vec3> color = choice.color ? choice.color : shot.background_color;
  if (color) ground.color = glm::clamp(*color, 0.0f, 1.0f);
  return ground;
}

DevelopSettings develop_of(const Shot& shot, const Scene& scene, const Environment& environment) {
  DevelopSettings develop = default_develop(scene, environment);
  if (shot.exposure) develop.exposure = *shot.exposure;
  develop.tone_curve = shot.tone_curve;
  develop.bloom = shot.bloom;
  if (shot.engine == Engine::raster && raster::shows_numbers(shot.drawn.quantity)) {
    // Numbers, not light: shown as they are.
    develop.exposure = 1.0f;
    develop.tone_curve = ToneCurve::linear;
  }
  develop.background = shot.background_color;
  develop.background_opacity = shot.background_opacity;
  return develop;
}

void set_falloff(const FalloffChoice& choice, Scene& scene) {
  for (Light& light : scene.lights) {
    light.falloff = choice.kind;
    if (choice.polynomial) light.polynomial = *choice.polynomial;
  }
}

bool is_complete(const Scene& scene, const Primitive& primitive) {
  const Material& material = scene.materials[static_cast<std::size_t>(primitive.material)];
  for (const TextureSlot* slot : texture_slots(material)) {
    if (*slot && primitive.uvs[static_cast<std::size_t>(slot->uv_set)].empty()) return false;
  }
  return tangent_slot(material) == nullptr || !primitive.tangents.empty();
}

void complete_primitive(const Material& material, Primitive& primitive) {
  for (const TextureSlot* slot : texture_slots(material)) {
    if (!*slot) continue;
    std::vector<vec2>& uvs = primitive.uvs[static_cast<std::size_t>(slot->uv_set)];
    if (uvs.empty()) uvs.assign(primitive.positions.size(), vec2(0.0f));
  }
  const TextureSlot* slot = tangent_slot(material);
  if (slot == nullptr || !primitive.tangents.empty()) return;
  if (primitive.uvs[static_cast<std::size_t>(slot->uv_set)].empty()) {
    io::turn_tangents(primitive);
  } else {
    io::generate_tangents(*slot, primitive);
  }
}

void choose_denoiser(Shot& shot, const std::function<void(std::string)>& warn) {
  if (!shot.denoiser || shot.engine == Engine::raster) return;
  const std::string why = denoise::why_not(*shot.denoiser);
  if (why.empty()) return;
  warn(why + "; the built-in regression denoises");
  shot.denoiser = denoise::Method::regression;
}

void take_noise_out(denoise::Method method, TakenPicture& picture, const Job& job,
                    const std::function<void(std::string)>& warn) {
  Job part = job;
  if (job.progress) {
    part.progress = [&](Progress p) {
      p.fraction = kShareOfSamples + (1.0 - kShareOfSamples) * p.fraction;
      p.samples_per_pixel = picture.traced.mean_samples_per_pixel;
      job.progress(p);
    };
  }
  const Stopwatch watch;
  picture.is_denoised = denoise::denoise(picture.film, method, part);
  picture.denoise_s = watch.seconds();
  if (picture.is_denoised) return;
  picture.traced.interrupted = true;
  warn("stopped while it was denoised: the picture has its noise");
}

std::map<std::string, std::string> picture_metadata(const Shot& shot, const Environment& environment,
                                                    const std::string& camera, double samples, bool is_denoised) {
  std::map<std::string, std::string> result{
      {"scene", shot.scene},
      {"camera", camera},
      {"environment", environment.name},
      {"integrator", shot.engine == Engine::raster ? "raster" : path::integrator_name(shot.traced.integrator)},
      {"samples", fmt::format("{}", samples)},
      {"seed", fmt::format("{}", shot.traced.seed)},
      {"version", fmt::format("candela {}", version())}};
  if (!shot.shading_name.empty()) result["shading"] = shot.shading_name;
  if (is_denoised) result["denoiser"] = denoise::method_name(*shot.denoiser);
  return result;
}

std::string shading_key(const shade::ShadingModel& m) {
  return fmt::format("{} {} {} {} {} {} {}", m.distribution, m.masking, m.fresnel, m.diffuse, m.blend, m.multiscatter,
                     m.literal_layers);
}

}  // namespace candela
