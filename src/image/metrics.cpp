#include "image/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"

namespace candela {

namespace {

std::string size_text(const Image& image) { return std::to_string(image.width) + " x " + std::to_string(image.height); }

/// Calls visit(colour of a, colour of b) for each pixel in order.
template <class Visit>
void for_each_pixel(const Image& a, const Image& b, Visit visit) {
  if (a.width != b.width || a.height != b.height)
    throw Error("cannot compare a picture of " + size_text(a) + " with one of " + size_text(b));
  if (a.empty() || b.empty()) throw Error("cannot compare empty pictures");
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) visit(dvec3(a.rgb(x, y)), dvec3(b.rgb(x, y)));
}

double mean3(dvec3 v) { return (v.x + v.y + v.z) / 3.0; }
double pixels_of(const Image& image) { return static_cast<double>(image.width) * static_cast<double>(image.height); }

double rel_error(dvec3 a, dvec3 reference) {
  const dvec3 d = a - reference;
  return mean3(d * d / (reference * reference + dvec3(kRelMseEpsilon)));
}

}  // namespace

double mse(const Image& a, const Image& b) {
  double sum = 0.0;
  for_each_pixel(a, b, [&](dvec3 p, dvec3 q) { sum += mean3((p - q) * (p - q)); });
  return sum / pixels_of(a);
}

double rel_mse(const Image& a, const Image& reference) {
  double sum = 0.0;
  for_each_pixel(a, reference, [&](dvec3 p, dvec3 q) { sum += rel_error(p, q); });
  return sum / pixels_of(a);
}

double rel_mse_trimmed(const Image& a, const Image& reference, double fraction) {
  std::vector<double> errors;
  for_each_pixel(a, reference, [&](dvec3 p, dvec3 q) { errors.push_back(rel_error(p, q)); });
  for (const double e : errors)
    if (std::isnan(e)) return std::numeric_limits<double>::quiet_NaN();
  const double share = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(errors.size());
  const std::size_t dropped = std::min(static_cast<std::size_t>(share), errors.size() - 1);
  std::sort(errors.begin(), errors.end());
  errors.resize(errors.size() - dropped);
  double sum = 0.0;
  for (const double e : errors) sum += e;
  return sum / static_cast<double>(errors.size());
}

double max_abs_difference(const Image& a, const Image& b) {
  double largest = 0.0;
  bool nan = false;
  for_each_pixel(a, b, [&](dvec3 p, dvec3 q) {
    const dvec3 d = glm::abs(p - q);
    const double pixel = std::max(d.x, std::max(d.y, d.z));
    nan = nan || std::isnan(d.x + d.y + d.z);
    largest = std::max(largest, pixel);
  });
  return nan ? std::numeric_limits<double>::quiet_NaN() : largest;
}

dvec3 image_mean(const Image& image) {
  dvec3 sum(0.0);
  for_each_pixel(image, image, [&](dvec3 p, dvec3) { sum += p; });
  return sum / pixels_of(image);
}

}  // namespace candela
