// exr_error PICTURE REFERENCE: prints relMSE, relMSE without the worst 0.1 % of the pixels, and the ratio of the means.

#include <cstdio>
#include <exception>

#include "image/image_file.h"
#include "image/metrics.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: exr_error PICTURE REFERENCE\n");
    return 2;
  }
  const candela::Image picture = candela::read_image(argv[1]);
  const candela::Image reference = candela::read_image(argv[2]);
  const candela::dvec3 a = candela::image_mean(picture);
  const candela::dvec3 b = candela::image_mean(reference);
  std::printf("relMSE %.6g trimmed %.6g mean ratio %.5f %.5f %.5f\n", candela::rel_mse(picture, reference),
              candela::rel_mse_trimmed(picture, reference), a.x / b.x, a.y / b.y, a.z / b.z);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "exr_error: %s\n", error.what());
  return 1;
}
