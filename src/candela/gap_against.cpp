#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "candela/gap_parts.h"
#include "image/image_file.h"
#include "shade/color.glsl.h"

namespace candela {

namespace {

constexpr int kMostShift = 16;  // pixels: a picture further away is of another camera

/// Four channels, no NaN.
Image opaque(const Image& image) {
  Image result(image.width, image.height, 4);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const vec3 color = image.rgb(x, y);
      const auto finite = [](float v) { return std::isfinite(v) ? v : 0.0f; };
      result.set_rgb(x, y, {finite(color.x), finite(color.y), finite(color.z)});
      result.at(x, y)[3] = 1.0f;
    }
  }
  return result;
}

/// Linear values of what a display shows.
Image shown(const Image& light, float exposure, ToneCurve curve) {
  const Shown show(curve, exposure);
  Image result(light.width, light.height, 4);
  parallel_for(0, static_cast<std::size_t>(light.height), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < light.width; ++x) {
        const vec3 encoded = show(light.rgb(x, y));
        vec3 linear;
        for (int c = 0; c < 3; ++c) linear[c] = shade::srgb_decode_channel(encoded[c]);
        result.set_rgb(x, y, linear);
        result.at(x, y)[3] = 1.0f;
      }
    }
  });
  return result;
}

Image cropped(const Image& image, ivec2 corner, ivec2 size) {
  Image result(size.x, size.y, image.channels);
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const auto from = image.at(corner.x + x, corner.y + y);
      std::copy(from.begin(), from.end(), result.at(x, y).begin());
    }
  }
  return result;
}

/// What both pictures show where the second is away from the first by `shift`.
struct Overlap {
  ivec2 of_truth, of_picture;  ///< upper left corners
  ivec2 size;

  Overlap(ivec2 whole, ivec2 shift)
      : of_truth(glm::max(-shift, ivec2(0))), of_picture(of_truth + shift), size(whole - glm::abs(shift)) {}
};

Image luminance_of(const Image& image) {
  Image result(image.width, image.height, 1);
  for (std::size_t i = 0; i < result.pixels.size(); ++i) result.pixels[i] = luminance(pixel_of(image, i));
  return result;
}

/// Squared difference of two luminances where the second is moved by `shift`, of the part that is there at every shift.
double moved_distance(const Image& truth, const Image& picture, ivec2 shift, int margin) {
  double sum = 0.0;
  for (int y = margin; y < truth.height - margin; ++y) {
    const float* a = truth.pixels.data() + truth.index(0, y);
    const float* b = picture.pixels.data() + picture.index(0, y + shift.y) + shift.x;
    float row = 0.0f;
    for (int x = margin; x < truth.width - margin; ++x) row += (a[x] - b[x]) * (a[x] - b[x]);
    sum += static_cast<double>(row);
  }
  return sum;
}

/// By how much a picture is away from the truth, both as shown.
ivec2 shift_of(const Image& of_truth, const Image& of_picture) {
  const Image truth = luminance_of(of_truth), picture = luminance_of(of_picture);
  const int margin = std::min({kMostShift, truth.width / 4, truth.height / 4});
  const int side = 2 * margin + 1;
  std::vector<double> distances(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  parallel_for(0, distances.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int k = static_cast<int>(i);
      distances[i] = moved_distance(truth, picture, {k % side - margin, k / side - margin}, margin);
    }
  });
  // Of equal ones the nearest: a picture of one colour is nowhere else.
  ivec2 best(0);
  double least = distances[static_cast<std::size_t>(margin * side + margin)];
  for (int k = 0; k < side * side; ++k) {
    if (distances[static_cast<std::size_t>(k)] >= least * (1.0 - 1e-6)) continue;
    least = distances[static_cast<std::size_t>(k)];
    best = {k % side - margin, k / side - margin};
  }
  return best;
}

/// What a linear picture is multiplied by, so that both are as bright in the mean, of light relative to the picture's
/// own: highlights have no more of a say than shadows, and the truth's noise none.
float factor_of(const Image& truth, const Image& picture) {
  const std::size_t count = truth.pixels.size() / 4;
  double mean = 0.0;
  for (std::size_t i = 0; i < count; ++i) mean += static_cast<double>(luminance(pixel_of(picture, i)));
  mean /= static_cast<double>(count);
  double wanted = 0.0, there = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<double>(luminance(pixel_of(truth, i)));
    const auto p = static_cast<double>(luminance(pixel_of(picture, i)));
    const double weight = 1.0 / (std::max(p, 0.0) + 0.18 * mean + 1e-30);
    wanted += weight * t, there += weight * p;
  }
  return wanted > 0.0 && there > 0.0 ? static_cast<float>(wanted / there) : 1.0f;
}

/// The exposure under which the truth is nearest to what a display shows: by stops, ever finer, around `start`.
float exposure_of(const Image& truth, const Image& picture, float start, ToneCurve curve) {
  const auto distance = [&](float stops) {
    const Image image = shown(truth, start * std::exp2(stops), curve);
    double sum = 0.0;
    for (std::size_t i = 0; i < image.pixels.size() / 4; ++i) {
      const vec3 d = pixel_of(image, i) - pixel_of(picture, i);
      sum += dot(d, d);
    }
    return sum;
  };
  float best = 0.0f;
  double least = std::numeric_limits<double>::infinity();
  for (float step = 1.0f; step > 0.004f; step *= 0.5f) {
    const int reach = step == 1.0f ? 5 : 1;
    const float middle = best;
    for (int k = -reach; k <= reach; ++k) {
      const float stops = middle + static_cast<float>(k) * step;
      const double d = distance(stops);
      if (d < least) least = d, best = stops;
    }
  }
  return start * std::exp2(best);
}

}  // namespace

ViewGap measure_against(const Shot& wished, const GapSettings& settings, const ImageName& name, const Job& job) {
  const Shot shot = comparable(wished, settings);
  const ImageFile file = read_image_file(name);
  if (file.image.width != shot.size.x || file.image.height != shot.size.y) {
    throw Error(fmt::format("is {}x{} pixels, and the truth {}x{}", file.image.width, file.image.height, shot.size.x,
                            shot.size.y),
                name.text());
  }
  Take pictures(shot, job.diagnostics);
  pictures.prepare();
  if (pictures.labels().size() != 1) throw Error("one picture is compared with one view", name.text());
  const std::shared_ptr<const Scene> scene = pictures.scene(0);
  const View view = pictures.view(*scene, 0);
  const path::Tracer tracer(scene, pictures.environment(), shot.shading);
  path::Settings half = traced_settings(shot);
  half.samples = settings.samples / 2;
  const JobParts parts(job, kHalves);
  std::array<Film, kHalves> truths;
  for (std::size_t h = 0; h < kHalves; ++h) {
    truths[h] = trace_half(tracer, view, half, parts.part(h, h == 0 ? "truth, " : "truth again, "));
    ++half.seed;
  }

  // ----- one over the other
  ViewGap gap;
  gap.label = pictures.labels()[0];
  gap.match = GapMatch{.is_display = is_display_format(file.format)};
  gap.develop = pictures.develop();
  gap.develop.dither = false, gap.develop.bloom = 0.0f;
  Image picture = opaque(file.image);
  for (const Film& truth : truths) accumulate(truth, 1.0f / kHalves, gap.truth);
  const float metered = metered_exposure(gap.truth);
  if (gap.match->is_display) {
    const bool is_given = shot.exposure && *shot.exposure;
    float exposure = gap.develop.exposure.value_or(metered);
    for (int round = 0; round < 2; ++round) {
      const Image as_shown = shown(gap.truth.beauty, exposure, shot.tone_curve);
      gap.match->shift = shift_of(as_shown, picture);
      if (is_given) break;
      const Overlap overlap(shot.size, gap.match->shift);
      exposure = exposure_of(cropped(gap.truth.beauty, overlap.of_truth, overlap.size),
                             cropped(picture, overlap.of_picture, overlap.size), exposure, shot.tone_curve);
    }
    gap.match->exposure = exposure;
    for (Film* film : {&truths[0], &truths[1], &gap.truth})
      film->beauty = shown(film->beauty, exposure, shot.tone_curve);
    gap.develop = {.exposure = 1.0f, .tone_curve = ToneCurve::linear, .dither = false};
  } else {
    if (!gap.develop.exposure) gap.develop.exposure = metered;
    gap.match->exposure = factor_of(gap.truth.beauty, picture);
    for (float& v : picture.pixels) v *= gap.match->exposure;
    const Image a = shown(gap.truth.beauty, *gap.develop.exposure, gap.develop.tone_curve);
    gap.match->shift = shift_of(a, shown(picture, *gap.develop.exposure, gap.develop.tone_curve));
    for (std::size_t i = 3; i < picture.pixels.size(); i += 4) picture.pixels[i] = 1.0f;
  }
  const Overlap overlap(shot.size, gap.match->shift);
  for (Film* film : {&truths[0], &truths[1], &gap.truth}) {
    film->beauty = cropped(film->beauty, overlap.of_truth, overlap.size);
    for (auto& [layer, image] : film->layers) image = cropped(image, overlap.of_truth, overlap.size);
  }
  gap.frame.beauty = cropped(picture, overlap.of_picture, overlap.size);

  // ----- how far they are apart
  gap.difference = compare_films(gap.truth, gap.frame, gap.develop);
  gap.flip_noise = 0.5 * compare_films(truths[0], truths[1], gap.develop).flip;
  GapErrors errors;
  for (std::size_t h = 0; h < kHalves; ++h) {
    for (std::size_t i = 0; i < gap.frame.beauty.pixels.size() / 4; ++i) {
      errors[h].push_back(pixel_of(gap.frame.beauty, i) - pixel_of(truths[h].beauty, i));
    }
  }
  find_numbers(*scene, weighted_pixels(gap.truth.beauty, *gap.develop.exposure), materials_seen(*scene, truths[0]),
               errors, {}, gap);
  return gap;
}

}  // namespace candela
