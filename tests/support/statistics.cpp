#include "support/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace candela::test {

namespace {

constexpr double kRelativeEnd = 1e-15;
constexpr int kMaxTerms = 100000;

// P(a, x) by its power series, for x < a + 1.
double gamma_p_series(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < kMaxTerms && term > sum * kRelativeEnd; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

// Q(a, x) by its continued fraction (Lentz's method), for x >= a + 1.
double gamma_q_fraction(double a, double x) {
  constexpr double kTiny = std::numeric_limits<double>::min() / kRelativeEnd;
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny;
  double d = 1.0 / b;
  double h = d;
  for (int i = 1; i < kMaxTerms; ++i) {
    const double an = -i * (i - a);
    b += 2.0;
    d = an * d + b;
    if (std::abs(d) < kTiny) d = kTiny;
    c = b + an / c;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1.0 / d;
    const double factor = d * c;
    h *= factor;
    if (std::abs(factor - 1.0) < kRelativeEnd) break;
  }
  return h * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

}  // namespace

double sidak_threshold(std::size_t tests, double family) {
  return -std::expm1(std::log1p(-family) / static_cast<double>(std::max<std::size_t>(tests, 1)));
}

double chi_square_p_value(double statistic, double degrees) {
  if (statistic <= 0.0) return 1.0;
  const double a = 0.5 * degrees;
  const double x = 0.5 * statistic;
  return x < a + 1.0 ? 1.0 - gamma_p_series(a, x) : gamma_q_fraction(a, x);
}

double normal_p_value(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

ChiSquare chi_square_test(std::span<const double> observed, std::span<const double> expected, double pool) {
  double rest_expected = 0.0;
  for (const double e : expected) rest_expected += e;

  ChiSquare result;
  int bins = 0;
  double o = 0.0;
  double e = 0.0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    o += observed[i];
    e += expected[i];
    rest_expected -= expected[i];
    const bool last = i + 1 == observed.size();
    if (!last && (e < pool || rest_expected < pool)) continue;
    if (e > 0.0) {
      result.statistic += (o - e) * (o - e) / e;
      ++bins;
    } else if (o > 0.0) {
      return {std::numeric_limits<double>::infinity(), bins, 0.0};
    }
    o = 0.0;
    e = 0.0;
  }
  result.degrees = std::max(bins - 1, 0);
  // With one bin the totals agree or they do not.
  if (result.degrees == 0) {
    result.p_value = result.statistic > 1e-6 ? 0.0 : 1.0;
  } else {
    result.p_value = chi_square_p_value(result.statistic, result.degrees);
  }
  return result;
}

void Moments::add(double x) {
  count_ += 1.0;
  const double delta = x - mean_;
  mean_ += delta / count_;
  sum_ += delta * (x - mean_);
}

double Moments::standard_error() const { return count_ > 0.0 ? std::sqrt(variance() / count_) : 0.0; }

double z_test_p_value(const Moments& moments, double expected, double slack, double least_variance) {
  const double excess = std::abs(moments.mean() - expected) - slack;
  if (excess <= 0.0) return 1.0;
  const double error = std::sqrt(std::max(moments.variance(), least_variance) / std::max(moments.count(), 1.0));
  return error > 0.0 ? normal_p_value(excess / error) : 0.0;
}

double share_p_value(int successes, int trials, double expected, double slack) {
  const double n = trials;
  const double excess = std::abs(successes / n - expected) - slack - 3.0 / n;
  if (excess <= 0.0) return 1.0;
  const double p = std::clamp(expected, 0.0, 1.0);
  const double error = std::sqrt(p * (1.0 - p) / n);
  return error > 0.0 ? normal_p_value(excess / error) : 0.0;
}

}  // namespace candela::test
