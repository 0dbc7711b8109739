#include "denoise/regression.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "base/parallel.h"

namespace candela::denoise {

namespace {

// Chosen by the error of 16 samples against converged pictures of a helmet, a sofa, a candle in a glass and a Cornell
// box.
constexpr int kRadius = 12;                // of a window, pixels
constexpr int kStride = 6;                 // between the middles of windows
constexpr int kOwnRadius = 6;              // of the window of a pixel that has one of its own
constexpr float kLightTolerance = 1.2f;    // standard deviations that pixels of the same light are apart
constexpr float kFeatureTolerance = 0.6f;  // the same of normal and albedo
constexpr float kLeastFeatureVariance = 0.01f;
constexpr float kLeastAlbedo = 0.02f;    // that light is divided by
constexpr float kLeastContrast = 0.01f;  // relative: less is no difference of light
constexpr float kRidge = 1e-3f;          // of the window's weight: keeps what the window does not tell at 0
constexpr float kLeastWeight = 0.5f;     // of a pixel, over the windows that hold it
constexpr std::size_t kBrightRank = 1;   // a pixel is at most as bright as the second of those around it

constexpr std::size_t kWidth = 2 * kRadius + 1;
constexpr std::size_t kRun = 32;  // pixels of a row that are reckoned at once: a window's
constexpr std::size_t kPadded = (kWidth * kWidth + kRun - 1) / kRun * kRun;
static_assert(kWidth * (kWidth - 1) + kRun <= kPadded);
constexpr std::size_t kFeatures = 6;
constexpr std::size_t kBasis = 3 + kFeatures;  // one, x, y, normal, albedo

using Plane = std::vector<float>;
using Matrix = std::array<std::array<float, kBasis>, kBasis>;
using Coefficients = std::array<std::array<float, kBasis>, 3>;  // by channel

/// What windows read, pixel by pixel, with room behind: kRun pixels are read at once.
struct Planes {
  int width = 0, height = 0;
  std::array<Plane, 3> albedo;         ///< that light is multiplied by in the end
  std::array<Plane, 3> light;          ///< what is not seen directly, over albedo
  std::array<Plane, 3> mean;           ///< of the light of 3×3 pixels
  std::array<Plane, 3> mean_variance;  ///< of that
  std::array<Plane, kFeatures> features;
  std::array<Plane, 2> feature_variance;  ///< of normal and albedo

  ivec2 size() const { return {width, height}; }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

void for_rows(int height, const std::function<void(int)>& body) {
  parallel_for(0, static_cast<std::size_t>(height), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) body(static_cast<int>(y));
  });
}

/// The same, telling how far it is between two shares of the whole work.
void for_rows(int height, const Job& job, double from, double to, const std::function<void(int)>& body) {
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) {
    const int first = height * step / kSteps, end = height * (step + 1) / kSteps;
    for_rows(end - first, [&](int row) { body(first + row); });
    job.report({.fraction = from + (to - from) * (step + 1) / kSteps, .what = "denoising"});
  }
}

/// Calls `body(x, y)` for the (2 reach + 1)² pixels around one, row by row; fewer at borders.
template <class Body>
void for_square(ivec2 size, ivec2 middle, int reach, const Body& body) {
  for (int y = std::max(middle.y - reach, 0); y <= std::min(middle.y + reach, size.y - 1); ++y) {
    for (int x = std::max(middle.x - reach, 0); x <= std::min(middle.x + reach, size.x - 1); ++x) body(x, y);
  }
}

/// e^x for x ≤ 0, within 2e-7 of it. Written so that compilers do several at once, which no library's is.
float exp_of_negative(float x) {
  constexpr float kLog2E = 1.44269504f, kLn2 = 0.693147181f;
  const float t = glm::max(-126.0f, x * kLog2E);
  const int power = static_cast<int>(t - 0.5f);
  const float f = (t - static_cast<float>(power)) * kLn2;
  const float series =
      1.0f + f * (1.0f + f * (1 / 2.0f + f * (1 / 6.0f + f * (1 / 24.0f + f * (1 / 120.0f + f * (1 / 720.0f))))));
  return std::bit_cast<float>((power + 127) << 23) * series;
}

/// Mean over 3×3 pixels, fewer at borders.
Plane mean_of_nine(const Plane& in, int width, int height) {
  Plane out(in.size());
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      float sum = 0.0f;
      int count = 0;
      for_square({width, height}, {x, y}, 1, [&](int i, int j) {
        sum += in[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
        ++count;
      });
      out[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
          sum / static_cast<float>(count);
    }
  });
  return out;
}

/// Lone bright pixels, which no window can tell from light, become as bright as what is around them.
void clamp_outliers(Planes& s, std::array<Plane, 3>& variance) {
  constexpr int kReach = 2;
  constexpr std::size_t kSide = 2 * kReach + 1;
  Plane level(s.light[0].size());
  for (std::size_t i = 0; i < level.size(); ++i)
    level[i] = luminance(vec3(s.light[0][i], s.light[1][i], s.light[2][i]));
  for_rows(s.height, [&](int y) {
    std::array<float, kSide * kSide> around;
    for (int x = 0; x < s.width; ++x) {
      const std::size_t p = s.at(x, y);
      std::size_t as_bright = 0;  // itself among them
      for_square(s.size(), {x, y}, kReach, [&](int i, int j) { as_bright += level[s.at(i, j)] >= level[p]; });
      if (as_bright > kBrightRank) continue;
      auto end = around.begin();
      for_square(s.size(), {x, y}, kReach, [&](int i, int j) { *end++ = level[s.at(i, j)]; });
      const auto count = static_cast<std::size_t>(end - around.begin());
      const auto bright = around.begin() + static_cast<std::ptrdiff_t>(std::min(kBrightRank, count - 1));
      std::nth_element(around.begin(), bright, end, std::greater<>());
      const float limit = std::max(*bright, 0.0f);
      if (level[p] <= limit) continue;
      const float scale = limit / level[p];
      for (std::size_t c = 0; c < 3; ++c) {
        s.light[c][p] *= scale;
        variance[c][p] *= scale * scale;
      }
    }
  });
}

Planes make_planes(const Film& film) {
  const DenoisingFeatures& f = *film.features;
  Planes s;
  s.width = film.width();
  s.height = film.height();
  const std::size_t n = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height);
  std::array<Plane, 3> variance;
  for (std::size_t c = 0; c < 3; ++c) {
    for (Plane* plane : {&s.albedo[c], &s.light[c], &s.features[c], &s.features[3 + c], &variance[c]})
      plane->resize(n + kRun);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = 3 * i + c;
      const float albedo = std::max(f.albedo.pixels[k], kLeastAlbedo);
      s.albedo[c][i] = albedo;
      s.light[c][i] = (film.beauty.pixels[4 * i + c] - f.seen.pixels[4 * i + c]) / albedo;
      variance[c][i] = f.variance.pixels[k] / (albedo * albedo);
      s.features[c][i] = f.normal.pixels[k];
      s.features[3 + c][i] = f.albedo.pixels[k];
    }
  }
  s.feature_variance = {f.normal_variance.pixels, f.albedo_variance.pixels};
  for (Plane& plane : s.feature_variance) plane.resize(n + kRun);
  clamp_outliers(s, variance);
  for (std::size_t c = 0; c < 3; ++c) {
    s.mean[c] = mean_of_nine(s.light[c], s.width, s.height);
    s.mean_variance[c] = mean_of_nine(variance[c], s.width, s.height);
    for (float& v : s.mean_variance[c]) v /= 9.0f;
  }
  return s;
}

/// What chance decides of a pixel, as luminance, and its variance.
struct Chance {
  Plane level, variance;
};

/// How unlike two pixels are, pixel by pixel of the 3×3 around them, over what their variances make likely: 0 where
/// that is all.
float apart(const Chance& chance, ivec2 size, ivec2 p, ivec2 q) {
  constexpr float kTolerance2 = 0.2f;
  float sum = 0.0f, count = 0.0f;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const ivec2 a = p + ivec2(i, j), b = q + ivec2(i, j);
      if (std::min(std::min(a.x, a.y), std::min(b.x, b.y)) < 0) continue;
      if (std::max(a.x, b.x) >= size.x || std::max(a.y, b.y) >= size.y) continue;
      const auto at = [&](ivec2 v) {
        return static_cast<std::size_t>(v.y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(v.x);
      };
      const float difference = chance.level[at(a)] - chance.level[at(b)];
      const float va = chance.variance[at(a)], vb = chance.variance[at(b)];
      sum += (difference * difference - (va + std::min(va, vb))) / (kTolerance2 * (va + vb) + 1e-12f);
      ++count;
    }
  }
  return std::max(sum / count, 0.0f);
}

/// Where `is_by_chance(x, y)`, the mean of pixels around that may be the same, given their variance: non-local means as
/// in Rousselle et al. 2012, "Adaptive Rendering with Non-Local Means Filtering". Elsewhere `of` as it is.
template <class IsByChance>
Image without_chance(const Image& of, Plane variance, const IsByChance& is_by_chance) {
  constexpr int kReach = 5;
  const ivec2 size(of.width, of.height);
  Chance chance{Plane(variance.size()), std::move(variance)};
  Image clean(size.x, size.y, 3);
  std::size_t k = 0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) chance.level[k++] = luminance(of.rgb(x, y));
  }
  for_rows(size.y, [&](int y) {
    for (int x = 0; x < size.x; ++x) {
      clean.set_rgb(x, y, of.rgb(x, y));
      if (!is_by_chance(x, y)) continue;
      vec3 sum(0.0f);
      float total = 0.0f;
      for_square(size, {x, y}, kReach, [&](int i, int j) {
        const float w = exp_of_negative(-apart(chance, size, {x, y}, {i, j}));
        total += w;
        sum += w * of.rgb(i, j);
      });
      clean.set_rgb(x, y, sum / total);
    }
  });
  return clean;
}

/// Light that is seen directly, where chance decides whether a pixel sees a lamp or the background at all: edges out of
/// focus or in motion.
Image clean_seen(const Film& film) {
  const DenoisingFeatures& f = *film.features;
  Plane variance(f.seen.pixels.size() / 4);
  for (std::size_t i = 0; i < variance.size(); ++i) variance[i] = f.seen.pixels[4 * i + 3];
  return without_chance(f.seen, std::move(variance), [&](int x, int y) {
    return glm::length(f.normal.rgb(x, y)) > 0.0f && f.seen.at(x, y)[3] > 0.0f;
  });
}

/// Albedo that light is multiplied by in the end, where chance decides between mirror and clear glass and what is
/// beyond is the background: light over albedo has no noise there, the albedo has it all.
Image clean_albedo(const Film& film) {
  const DenoisingFeatures& f = *film.features;
  return without_chance(f.albedo, f.albedo_variance.pixels, [&](int x, int y) {
    return glm::length(f.normal.rgb(x, y)) <= 0.0f && f.albedo_variance.at(x, y)[0] > 0.0f;
  });
}

using Run = std::array<float, kRun>;

/// How much each pixel from `q` on counts in the window around `p`: how likely both have the same light, and the same
/// surface.
Run weights(const Planes& s, std::size_t p, std::size_t q) {
  constexpr float kContrast2 = kLeastContrast * kLeastContrast;
  Run result;
  for (std::size_t l = 0; l < kRun; ++l) {
    float of_light = 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      const float mean_p = s.mean[c][p], mean_q = s.mean[c][q + l];
      const float difference = mean_p - mean_q, level = 0.5f * (mean_p + mean_q);
      const float vp = s.mean_variance[c][p], vq = s.mean_variance[c][q + l];
      of_light += (difference * difference - (vp + glm::min(vp, vq))) /
                  (kContrast2 * (level * level + kContrast2) + kLightTolerance * kLightTolerance * (vp + vq));
    }
    float of_features = 0.0f;
    for (std::size_t f = 0; f < kFeatures; ++f) {
      const float difference = s.features[f][p] - s.features[f][q + l];
      const float v = s.feature_variance[f / 3][p] + s.feature_variance[f / 3][q + l];
      of_features += glm::max(difference * difference - v, 0.0f) /
                     (kFeatureTolerance * kFeatureTolerance * glm::max(v, kLeastFeatureVariance));
    }
    result[l] = exp_of_negative(-glm::max(of_light, 0.0f) / 3.0f - of_features / kFeatures);
  }
  return result;
}

/// Calls `body(x, count)` for pixels of a row from `first` to `last`, `count` at once: kRun, or what is left of them.
template <class Body>
void for_runs(int first, int last, const Body& body) {
  constexpr int kStep = kRun;
  for (int x = first; x <= last; x += kStep) body(x, static_cast<std::size_t>(std::min(last - x + 1, kStep)));
}

/// Basis of the window around `p` at pixels from `q` on.
std::array<Run, kBasis> basis_at(const Planes& s, ivec2 p, ivec2 q) {
  std::array<Run, kBasis> basis;
  basis[0].fill(1.0f);
  for (std::size_t l = 0; l < kRun; ++l) basis[1][l] = static_cast<float>(q.x - p.x + static_cast<int>(l)) / kRadius;
  basis[2].fill(static_cast<float>(q.y - p.y) / kRadius);
  for (std::size_t f = 0; f < kFeatures; ++f) {
    const float middle = s.features[f][s.at(p.x, p.y)];
    const float* const values = &s.features[f][s.at(q.x, q.y)];
    for (std::size_t l = 0; l < kRun; ++l) basis[3 + f][l] = values[l] - middle;
  }
  return basis;
}

/// Solves a x = b for each of `b` by Cholesky's factors, in place. `a` is positive definite; its lower half is read.
void solve(Matrix& a, Coefficients& b) {
  for (std::size_t i = 0; i < kBasis; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      float sum = a[i][j];
      for (std::size_t m = 0; m < j; ++m) sum -= a[i][m] * a[j][m];
      a[i][j] = i == j ? std::sqrt(std::max(sum, 1e-12f)) : sum / a[j][j];
    }
  }
  for (auto& x : b) {
    for (std::size_t i = 0; i < kBasis; ++i) {
      for (std::size_t m = 0; m < i; ++m) x[i] -= a[i][m] * x[m];
      x[i] /= a[i][i];
    }
    for (std::size_t i = kBasis; i-- > 0;) {
      for (std::size_t m = i + 1; m < kBasis; ++m) x[i] -= a[m][i] * x[m];
      x[i] /= a[i][i];
    }
  }
}

using Row = std::array<float, kPadded>;

/// Of the first `n`, and of zeros up to a multiple of kRun.
float dot(const Row& a, const Row& b, std::size_t n) {
  Run sums{};
  for (std::size_t i = 0; i < n; i += kRun) {
    for (std::size_t l = 0; l < kRun; ++l) sums[l] += a[i + l] * b[i + l];
  }
  for (std::size_t half = kRun / 2; half > 0; half /= 2) {
    for (std::size_t l = 0; l < half; ++l) sums[l] += sums[l + half];
  }
  return sums[0];
}

Coefficients fit(const Planes& s, ivec2 middle, int reach) {
  // All times the root of the weight.
  std::array<Row, kBasis> basis;
  std::array<Row, 3> light;
  std::array<Row, 2> feature_variance;
  std::size_t n = 0;
  const std::size_t p = s.at(middle.x, middle.y);
  const int left = std::max(middle.x - reach, 0), right = std::min(middle.x + reach, s.width - 1);
  for (int y = std::max(middle.y - reach, 0); y <= std::min(middle.y + reach, s.height - 1); ++y) {
    for_runs(left, right, [&](int x, std::size_t count) {
      const std::size_t q = s.at(x, y);
      Run root = weights(s, p, q);
      for (float& w : root) w = std::sqrt(w);
      const auto store = [&](Row& row, const float* values) {
        for (std::size_t l = 0; l < kRun; ++l) row[n + l] = root[l] * values[l];
      };
      const std::array<Run, kBasis> values = basis_at(s, middle, {x, y});
      for (std::size_t i = 0; i < kBasis; ++i) store(basis[i], values[i].data());
      for (std::size_t c = 0; c < 3; ++c) store(light[c], &s.light[c][q]);
      for (std::size_t f = 0; f < 2; ++f) store(feature_variance[f], &s.feature_variance[f][q]);
      n += count;  // what was stored beyond it is overwritten
    });
  }
  const auto end_at_n = [&](auto& rows) {
    for (Row& row : rows) std::fill(row.begin() + static_cast<std::ptrdiff_t>(n), row.end(), 0.0f);
  };
  end_at_n(basis);
  end_at_n(light);
  end_at_n(feature_variance);
  Matrix a{};
  Coefficients b{};
  for (std::size_t i = 0; i < kBasis; ++i) {
    for (std::size_t j = 0; j <= i; ++j) a[i][j] = dot(basis[i], basis[j], n);
    for (std::size_t c = 0; c < 3; ++c) b[c][i] = dot(basis[i], light[c], n);
    if (i > 0) a[i][i] += kRidge * a[0][0];
    if (i >= 3) a[i][i] += dot(basis[0], feature_variance[(i - 3) / 3], n);
  }
  solve(a, b);
  return b;
}

/// A fit may lie beyond all that it was fitted to; no light is brighter or darker than that of the 5×5 pixels around.
vec3 within_neighbours(const Planes& s, ivec2 pixel, vec3 light) {
  constexpr int kReach = 2;
  vec3 least(kInfinity), most(0.0f);
  for_square(s.size(), pixel, kReach, [&](int x, int y) {
    const std::size_t q = s.at(x, y);
    const vec3 other(s.light[0][q], s.light[1][q], s.light[2][q]);
    least = glm::min(least, other);
    most = glm::max(most, other);
  });
  return glm::clamp(light, glm::max(least, 0.0f), most);
}

/// Middles of windows along an axis.
struct Middles {
  int size;
  int count() const { return (size + kStride - 1) / kStride + 1; }
  int operator[](int i) const { return std::min(i * kStride, size - 1); }
  /// The first of those whose windows hold pixel `x`.
  int first(int x) const { return std::max((x - kRadius + kStride - 1) / kStride, 0); }
};

/// A pixel's own noise decides how much of it is replaced: all, unless around it the difference is more than noise
/// makes.
void keep_what_is_certain(const Film& film, Image& clean) {
  constexpr float kNoise = 2.0f;  // how many times its expectation a difference of nine pixels may be noise
  const std::size_t n = clean.pixels.size() / 3;
  Plane difference(n), noise(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float d = film.beauty.pixels[4 * i + c] - clean.pixels[3 * i + c];
      difference[i] += d * d;
      noise[i] += film.features->variance.pixels[3 * i + c] + film.features->seen.pixels[4 * i + 3];
    }
  }
  difference = mean_of_nine(difference, clean.width, clean.height);
  noise = mean_of_nine(noise, clean.width, clean.height);
  for (std::size_t i = 0; i < n; ++i) {
    const float bias2 = difference[i] - kNoise * noise[i];
    if (!(bias2 > 0.0f)) continue;
    const float share = bias2 / (bias2 + noise[i]);
    for (std::size_t c = 0; c < 3; ++c) {
      float& value = clean.pixels[3 * i + c];
      value += share * (film.beauty.pixels[4 * i + c] - value);
    }
  }
}

}  // namespace

Image regress(const Film& film, const Job& job) {
  const Planes s = make_planes(film);
  const Image seen = clean_seen(film), albedos = clean_albedo(film);
  const Middles columns{s.width}, rows{s.height};
  const auto index = [&](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns.count()) + static_cast<std::size_t>(column);
  };
  std::vector<Coefficients> fits(index(0, rows.count()));
  for_rows(rows.count(), job, 0.1, 0.6, [&](int row) {
    for (int column = 0; column < columns.count(); ++column)
      fits[index(column, row)] = fit(s, {columns[column], rows[row]}, kRadius);
  });

  Image clean(s.width, s.height, 3);
  for_rows(s.height, job, 0.6, 1.0, [&](int y) {
    // Over the windows that hold a pixel, by pixel of the row.
    Plane total(static_cast<std::size_t>(s.width));
    std::vector<vec3> sum(total.size(), vec3(0.0f));
    for (int row = rows.first(y); row < rows.count() && rows[row] - y <= kRadius; ++row) {
      for (int column = 0; column < columns.count(); ++column) {
        const ivec2 p(columns[column], rows[row]);
        const Coefficients& b = fits[index(column, row)];
        for_runs(std::max(p.x - kRadius, 0), std::min(p.x + kRadius, s.width - 1), [&](int x, std::size_t count) {
          const Run w = weights(s, s.at(p.x, p.y), s.at(x, y));
          const std::array<Run, kBasis> basis = basis_at(s, p, {x, y});
          std::array<Run, 3> light{};
          for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < kBasis; ++i) {
              for (std::size_t l = 0; l < kRun; ++l) light[c][l] += b[c][i] * basis[i][l];
            }
          }
          for (std::size_t l = 0; l < count; ++l) {
            const std::size_t i = static_cast<std::size_t>(x) + l;
            total[i] += w[l];
            sum[i] += w[l] * vec3(light[0][l], light[1][l], light[2][l]);
          }
        });
      }
    }
    for (int x = 0; x < s.width; ++x) {
      const auto i = static_cast<std::size_t>(x);
      vec3 light = sum[i] / total[i];
      // What no window speaks for, as a texel of a colour that no window's middle has, has a window of its own.
      if (total[i] < kLeastWeight) {
        const Coefficients own = fit(s, {x, y}, kOwnRadius);
        light = {own[0][0], own[1][0], own[2][0]};
      }
      const vec3 albedo = glm::max(albedos.rgb(x, y), kLeastAlbedo);
      clean.set_rgb(x, y, within_neighbours(s, {x, y}, light) * albedo + seen.rgb(x, y));
    }
  });
  keep_what_is_certain(film, clean);
  return clean;
}

}  // namespace candela::denoise
