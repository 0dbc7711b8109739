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

candela::shade::SurfaceParams plastic(float roughness) {
  candela::shade::SurfaceParams params = candela::shade::surface_params_default();
  params.base_color = vec3(0.5f);
  params.metallic = 0.0f;
  params.roughness = roughness;
  return params;
}

/// The argument is the roughness in percent.
void surface_sample(benchmark::State& state) {
  const auto params = plastic(static_cast<float>(state.range(0)) / 100.0f);
  std::size_t i = 0;
  for (auto _ : state) {
    const Input& in = inputs()[i++ % kInputs];
    const auto surface = candela::shade::surface_prepare(params, in.wo.z);
    benchmark::DoNotOptimize(candela::shade::surface_sample(surface, in.wo, in.u));
  }
}
BENCHMARK(surface_sample)->Arg(0)->Arg(20)->Arg(60);

void surface_eval(benchmark::State& state) {
  const auto params = plastic(static_cast<float>(state.range(0)) / 100.0f);
  std::size_t i = 0;
  for (auto _ : state) {
    const Input& in = inputs()[i++ % kInputs];
    const auto surface = candela::shade::surface_prepare(params, in.wo.z);
    benchmark::DoNotOptimize(candela::shade::surface_eval(surface, in.wo, in.wi));
  }
}
BENCHMARK(surface_eval)->Arg(20)->Arg(60);

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
