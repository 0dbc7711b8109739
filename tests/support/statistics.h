#pragma once

#include <cstddef>
#include <span>

namespace candela::test {

/// A family of statistical tests (all that one TEST asserts) may fail by bad luck once in ten thousand seedings. Seeds
/// are fixed, so a test that passes keeps passing; the number bounds how often a change that is right has to look for a
/// seed.
inline constexpr double kFamilySignificance = 1e-4;

/// p-value below which one of `tests` independent tests fails. Šidák 1967, "Rectangular Confidence Regions for the
/// Means of Multivariate Normal Distributions".
double sidak_threshold(std::size_t tests, double family = kFamilySignificance);

/// Probability that a χ² variable with `degrees` of freedom exceeds `statistic`: Q(degrees/2, statistic/2).
/// Abramowitz & Stegun 1964, 26.4.19; the incomplete gamma function by 6.5.29 (series) and 6.5.31 (continued fraction).
double chi_square_p_value(double statistic, double degrees);

/// Probability that |z| of a standard normal variable exceeds this one: erfc(|z| / √2).
double normal_p_value(double z);

struct ChiSquare {
  double statistic = 0.0;
  int degrees = 0;
  double p_value = 1.0;
};

/// Pearson's goodness of fit of counts to expected counts with the same total. Neighbouring bins are pooled until each
/// expects at least `pool`: below about five the statistic no longer follows χ² (Cochran 1954, "Some Methods for
/// Strengthening the Common χ² Tests"). p = 0 if a count sits where nothing at all is expected.
ChiSquare chi_square_test(std::span<const double> observed, std::span<const double> expected, double pool = 10.0);

/// Mean and variance of a stream. Welford 1962, "Note on a Method for Calculating Corrected Sums of Squares and
/// Products".
class Moments {
 public:
  void add(double x);
  double count() const { return count_; }
  double mean() const { return mean_; }
  double variance() const { return count_ > 1.0 ? sum_ / (count_ - 1.0) : 0.0; }
  double standard_error() const;  ///< of the mean

 private:
  double count_ = 0.0;
  double mean_ = 0.0;
  double sum_ = 0.0;
};

/// Two-sided p-value of "the mean is `expected`", where `expected` itself may be off by `slack` (an error of
/// quadrature). `least_variance` is what the hypothesis alone implies: rare events may be absent from a sample and from
/// its variance.
double z_test_p_value(const Moments& moments, double expected, double slack = 0.0, double least_variance = 0.0);

/// Two-sided p-value of "each of `trials` succeeds with probability `expected`", which may itself be off by `slack`.
/// Score test with the variance of the hypothesis (Wilson 1927, "Probable Inference"); three counts are forgiven,
/// because a share near 0 or 1 is not normal.
double share_p_value(int successes, int trials, double expected, double slack = 0.0);

}  // namespace candela::test
