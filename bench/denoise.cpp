// denoise_error REFERENCE.exr SPP SCENE [ENV]: mean FLIP at the reference's exposure, and relMSE without the worst 0.1
// %, of a picture with SPP samples and of the same denoised by each method that is here, with its seconds. And how much
// a still picture flickers: mean FLIP between two that have other seeds.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "base/stopwatch.h"
#include "candela/shot.h"
#include "image/flip.h"
#include "image/image_file.h"
#include "image/metrics.h"

namespace {

candela::Image shown(const candela::Image& picture, float exposure) {
  candela::Image display(picture.width, picture.height, 3);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) display.set_rgb(x, y, glm::clamp(picture.rgb(x, y) * exposure, 0.0f, 1.0f));
  }
  return display;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::fprintf(stderr, "usage: denoise_error REFERENCE.exr SPP SCENE [ENV]\n");
    return 2;
  }
  const candela::Image reference = candela::read_image(argv[1]);
  candela::Shot shot{.scene = argv[3]};
  if (argc > 4) shot.environment = argv[4];
  shot.size = {reference.width, reference.height};
  shot.traced.samples = std::atoi(argv[2]);
  shot.traced.has_features = true;
  const auto traced = [&shot](std::uint32_t seed) {
    candela::Film film;
    shot.traced.seed = seed;
    candela::Take(shot).render([&](candela::TakenPicture picture) { film = std::move(picture.film); });
    return film;
  };
  const candela::Film film = traced(77), other = traced(78);
  candela::Film of_reference;
  of_reference.beauty = candela::Image(reference.width, reference.height, 4);
  for (int y = 0; y < reference.height; ++y) {
    for (int x = 0; x < reference.width; ++x) {
      of_reference.beauty.set_rgb(x, y, reference.rgb(x, y));
      of_reference.beauty.at(x, y)[3] = 1.0f;
    }
  }
  const float exposure = candela::metered_exposure(of_reference);
  const candela::Image wanted = shown(reference, exposure);
  const auto judge = [&](const char* name, const candela::Image& picture, const candela::Image& next, double seconds) {
    std::printf("%-12s FLIP %.5f  relMSE %.3e  flicker %.5f  %.3f s\n", name,
                candela::flip_mean(wanted, shown(picture, exposure)), candela::rel_mse_trimmed(picture, reference),
                candela::flip_mean(shown(picture, exposure), shown(next, exposure)), seconds);
  };
  judge("plain", film.beauty, other.beauty, 0.0);
  for (const auto method : {candela::denoise::Method::regression, candela::denoise::Method::oidn}) {
    if (!candela::denoise::why_not(method).empty()) continue;
    candela::Film denoised = film, next = other;
    candela::denoise::denoise(next, method);
    const candela::Stopwatch watch;
    candela::denoise::denoise(denoised, method);
    judge(std::string(candela::denoise::method_name(method)).c_str(), denoised.beauty, next.beauty, watch.seconds());
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "denoise_error: %s\n", error.what());
  return 1;
}
