#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace candela {

/// A sum of floats that is the same in any order: a fixed-point number of 62 bits behind the point. What exceeds ±2⁴⁶
/// counts as that; a float's bits below 2⁻⁶² are lost. Holds sixty thousand of the largest numbers.
class ExactSum {
 public:
  void add(float v) {
    const double d = std::clamp(static_cast<double>(v), -kMost, kMost);
    const double whole = std::floor(d);
    high_ += static_cast<std::int64_t>(whole);
    carry(static_cast<std::uint64_t>(static_cast<std::int64_t>((d - whole) * kUnit)));
  }
  void add(const ExactSum& other) {
    high_ += other.high_;
    carry(other.low_);
  }
  double value() const { return static_cast<double>(high_) + static_cast<double>(low_) / kUnit; }

 private:
  static constexpr double kMost = 0x1p46, kUnit = 0x1p62;
  static constexpr int kBits = 62;

  void carry(std::uint64_t low) {
    low_ += low;
    high_ += static_cast<std::int64_t>(low_ >> kBits);
    low_ &= (std::uint64_t{1} << kBits) - 1;
  }

  std::int64_t high_ = 0;
  std::uint64_t low_ = 0;  ///< in units of 2⁻⁶², below 2⁶²
};

/// The same for numbers within ±64, in half the room: 40 bits behind the point.
class ExactSmallSum {
 public:
  void add(float v) { sum_ += static_cast<std::int64_t>(std::clamp(static_cast<double>(v), -kMost, kMost) * kUnit); }
  void add(const ExactSmallSum& other) { sum_ += other.sum_; }
  double value() const { return static_cast<double>(sum_) / kUnit; }

 private:
  static constexpr double kMost = 64.0, kUnit = 0x1p40;
  std::int64_t sum_ = 0;
};

}  // namespace candela
