// From the film to the file: 1280 x 720, a smooth picture with noise.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>

#include "image/develop.h"
#include "math/hash.h"

namespace {

using candela::Film;

Film noisy_film() {
  Film film;
  film.beauty = candela::Image(1280, 720, 4);
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < film.beauty.pixels.size(); ++i) {
    state = candela::hash(state);
    const float gradient = static_cast<float>(i) / static_cast<float>(film.beauty.pixels.size());
    film.beauty.pixels[i] = i % 4 == 3 ? 1.0f : gradient + 0.05f * candela::unit_float(state);
  }
  return film;
}

void metered_exposure(benchmark::State& state) {
  const Film film = noisy_film();
  for (auto _ : state) benchmark::DoNotOptimize(candela::metered_exposure(film));
}
BENCHMARK(metered_exposure)->Unit(benchmark::kMillisecond);

void develop(benchmark::State& state, candela::ToneCurve curve) {
  const Film film = noisy_film();
  for (auto _ : state) benchmark::DoNotOptimize(candela::develop(film, {.exposure = 1.0f, .tone_curve = curve}));
}
BENCHMARK_CAPTURE(develop, pbr_neutral, candela::ToneCurve::pbr_neutral)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(develop, agx, candela::ToneCurve::agx)->Unit(benchmark::kMillisecond);

void write_film(benchmark::State& state, const char* extension) {
  const Film film = noisy_film();
  const auto path =
      std::filesystem::temp_directory_path() / ("candela-bench-" + std::to_string(getpid()) + "." + extension);
  for (auto _ : state) candela::write_film(path, film, {.exposure = 1.0f});
  std::filesystem::remove(path);
}
BENCHMARK_CAPTURE(write_film, png, "png")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(write_film, jpg, "jpg")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(write_film, exr, "exr")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(write_film, hdr, "hdr")->Unit(benchmark::kMillisecond);

}  // namespace
