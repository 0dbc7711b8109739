// What one bounce costs beside its rays: the surface and the sample points.

#include <benchmark/benchmark.h>

#include <array>

#include "math/sobol.h"
#include "shade/surface.glsl.h"

namespace {

using candela::SobolSampler;
using candela::vec2;
using candela::vec3;

constexpr std::size_t kInputs = 1024;  // fits the first-level cache, and is too long for the branch predictor to learn

struct Input {
  vec3 wo;
  vec3 wi;
  vec3 u;
};

const std::array<Input, kInputs>& inputs() {
  static const auto filled = [] {
    std::array<Input, kInputs> all;
    for (std::size_t i = 0; i < kInputs; ++i) {
      SobolSampler sampler(1, static_cast<std::uint32_t>(i));
      all[i].wo = candela::shade::cosine_sample(sampler.next_2d());
      all[i].wi = candela::shade::cosine_sample(sampler.next_2d());
      const vec2 u = sampler.next_2d();
      all[i].u = vec3(u.x, u.y, sampler.next_1d());
    }
    return all;
  }();
  return filled;
}

using candela::shade::SurfaceParams;

SurfaceParams plastic(float roughness) {
  SurfaceParams params = candela::shade::surface_params_default();
  params.base_color = vec3(0.5f);
  params.metallic = 0.0f;
  params.roughness = roughness;
  return params;
}

SurfaceParams with(int lobe) {
  SurfaceParams params = plastic(0.3f);
  params.lobes = lobe;
  params.clearcoat = 1.0f;
  params.clearcoat_roughness = 0.1f;
  params.sheen_color = vec3(0.5f);
  params.sheen_roughness = 0.4f;
  params.anisotropy = 0.7f;
  params.iridescence = 1.0f;
  params.transmission = 1.0f;
  params.diffuse_transmission = 0.5f;
  return params;
}

SurfaceParams solid_glass() {
  SurfaceParams params = with(candela::shade::kLobeTransmission);
  params.is_thin = false;
  return params;
}

SurfaceParams conductor() {
  SurfaceParams params = with(candela::shade::kLobeConductor);
  params.metallic = 1.0f;
  params.conductor_n = vec3(0.2f, 0.9f, 1.3f);
  params.conductor_k = vec3(3.0f, 2.4f, 1.9f);
  return params;
}

/// One hit: the closure, and a direction from it.
void prepare_and_sample(benchmark::State& state, const SurfaceParams& params) {
  std::size_t i = 0;
  for (auto _ : state) {
    const Input& in = inputs()[i++ % kInputs];
    const auto surface = candela::shade::surface_prepare(params, in.wo);
    benchmark::DoNotOptimize(candela::shade::surface_sample(surface, in.wo, in.u));
  }
}

/// One hit: the closure, and its value for a light. Half of the lights are behind what lets light through.
void prepare_and_eval(benchmark::State& state, const SurfaceParams& params) {
  const bool is_opaque =
      (params.lobes & (candela::shade::kLobeTransmission | candela::shade::kLobeDiffuseTransmission)) == 0;
  std::size_t i = 0;
  for (auto _ : state) {
    const Input& in = inputs()[i++ % kInputs];
    const vec3 wi = is_opaque || i % 2 == 0 ? in.wi : vec3(in.wi.x, in.wi.y, -in.wi.z);
    const auto surface = candela::shade::surface_prepare(params, in.wo);
    benchmark::DoNotOptimize(candela::shade::surface_eval(surface, in.wo, wi));
  }
}

#define CANDELA_LOBE(name, params)                     \
  BENCHMARK_CAPTURE(prepare_and_sample, name, params); \
  BENCHMARK_CAPTURE(prepare_and_eval, name, params)

BENCHMARK_CAPTURE(prepare_and_sample, plain_mirror, plastic(0.0f));
CANDELA_LOBE(plain_20, plastic(0.2f));
CANDELA_LOBE(plain_60, plastic(0.6f));
CANDELA_LOBE(coat, with(candela::shade::kLobeClearcoat));
CANDELA_LOBE(sheen, with(candela::shade::kLobeSheen));
CANDELA_LOBE(thin_glass, with(candela::shade::kLobeTransmission));
CANDELA_LOBE(solid_glass, solid_glass());
CANDELA_LOBE(iridescence, with(candela::shade::kLobeIridescence));
CANDELA_LOBE(anisotropic, with(candela::shade::kLobeAnisotropy));
CANDELA_LOBE(diffuse_transmission, with(candela::shade::kLobeDiffuseTransmission));
CANDELA_LOBE(conductor, conductor());

/// A pixel's sample with the eight pairs of numbers that a path of a few bounces takes.
void sobol_eight_pairs(benchmark::State& state) {
  std::uint32_t i = 0;
  for (auto _ : state) {
    SobolSampler sampler(7, i++);
    for (int pair = 0; pair < 8; ++pair) benchmark::DoNotOptimize(sampler.next_2d());
  }
}
BENCHMARK(sobol_eight_pairs);

}  // namespace
