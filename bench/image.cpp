// From the film to the file: 1280 x 720, a smooth picture with noise. And baked light to the texture and back.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>

#include "image/develop.h"
#include "image/texture_file.h"
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

/// 256² with five smaller levels, smooth with noise.
candela::Cubemap noisy_cube() {
  candela::Cubemap cube;
  std::uint32_t state = 1;
  for (int size = 256; size >= 8; size /= 2) {
    cube.levels.push_back(candela::make_cube_faces(size));
    for (candela::Image& face : cube.levels.back()) {
      for (std::size_t i = 0; i < face.pixels.size(); ++i) {
        state = candela::hash(state);
        const float gradient = static_cast<float>(i) / static_cast<float>(face.pixels.size());
        face.pixels[i] = gradient + 0.05f * candela::unit_float(state);
      }
    }
  }
  return cube;
}

/// The argument is the level of Zstandard, 0 = not packed. "bytes" is the size of the file.
void encode_ktx2(benchmark::State& state, candela::TexelFormat format) {
  const candela::Cubemap cube = noisy_cube();
  const int level = static_cast<int>(state.range(0));
  candela::EncodingLoss loss;
  std::size_t bytes = 0;
  for (auto _ : state) {
    bytes = candela::encode_texture(cube, {.format = format, .zstd = level > 0, .zstd_level = std::max(level, 1)}, loss,
                                    "bench")
                .size();
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK_CAPTURE(encode_ktx2, rgba16f, candela::TexelFormat::rgba16f)
    ->Arg(0)
    ->Arg(3)
    ->Arg(9)
    ->Arg(19)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(encode_ktx2, rgb9e5, candela::TexelFormat::rgb9e5)
    ->Arg(0)
    ->Arg(3)
    ->Arg(9)
    ->Arg(19)
    ->Unit(benchmark::kMillisecond);

void decode_ktx2(benchmark::State& state, candela::TexelFormat format) {
  candela::EncodingLoss loss;
  const std::vector<std::byte> bytes = candela::encode_texture(noisy_cube(), {.format = format}, loss, "bench");
  for (auto _ : state) benchmark::DoNotOptimize(candela::decode_texture_file(bytes, "bench"));
}
BENCHMARK_CAPTURE(decode_ktx2, rgba16f, candela::TexelFormat::rgba16f)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_ktx2, rgb9e5, candela::TexelFormat::rgb9e5)->Unit(benchmark::kMillisecond);

}  // namespace
