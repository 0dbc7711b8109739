// denoise_error REFERENCE.exr SPP SCENE [ENV]: mean FLIP, after the reference's exposure, of a picture with SPP samples
// and of the same denoised, and the seconds that denoising took. PREFIX in the environment: writes both there.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "candela/shot.h"
#include "denoise/regression.h"
#include "image/flip.h"
#include "image/image_file.h"
#include "image/metrics.h"

namespace {

candela::Image shown(const candela::Image& picture, float exposure) {
  candela::Image display(picture.width, picture.height, 3);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x)
      display.set_rgb(x, y, glm::clamp(picture.rgb(x, y) * exposure, 0.0f, 1.0f));
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
  shot.traced.seed = 77;
  shot.traced.has_features = true;
  candela::Film film;
  candela::Take(shot).render([&](candela::TakenPicture picture) { film = std::move(picture.film); });
  candela::Film of_reference;
  of_reference.beauty = candela::Image(reference.width, reference.height, 4);
  for (int y = 0; y < reference.height; ++y) {
    for (int x = 0; x < reference.width; ++x) {
      of_reference.beauty.set_rgb(x, y, reference.rgb(x, y));
      of_reference.beauty.at(x, y)[3] = 1.0f;
    }
  }
  const float exposure = candela::metered_exposure(of_reference);
  const candela::Stopwatch watch;
  const candela::Image denoised = candela::denoise::regress(film);
  const double seconds = watch.seconds();
  const candela::Image wanted = shown(reference, exposure);
  std::printf("FLIP %.5f plain, %.5f denoised; relMSE %.3e, %.3e; %.3f s\n",
              candela::flip_mean(wanted, shown(film.beauty, exposure)), candela::flip_mean(wanted, shown(denoised, exposure)),
              candela::rel_mse_trimmed(film.beauty, reference), candela::rel_mse_trimmed(denoised, reference), seconds);
  if (const char* prefix = std::getenv("PREFIX")) {
    candela::DevelopSettings develop;
    develop.exposure = exposure;
    candela::write_film(std::string(prefix) + "plain.png", film, develop);
    for (int y = 0; y < reference.height; ++y)
      for (int x = 0; x < reference.width; ++x) film.beauty.set_rgb(x, y, denoised.rgb(x, y));
    candela::write_film(std::string(prefix) + "denoised.png", film, develop);
    candela::write_film(std::string(prefix) + "reference.png", of_reference, develop);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "denoise_error: %s\n", error.what());
  return 1;
}
