#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "base/error.h"

namespace candela::io {

[[noreturn]] inline void damaged_meshopt(const char* what) {
  throw Error(std::string("damaged meshopt data: ") + what);
}

/// The bytes of a packed view up to its tail, in order.
class MeshoptStream {
 public:
  MeshoptStream(const std::uint8_t* begin, const std::uint8_t* end) : at_(begin), end_(end) {}

  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  const std::uint8_t* take(std::size_t count) {
    if (count > left()) damaged_meshopt("it ends too early");
    return std::exchange(at_, at_ + count);
  }
  /// What comes next, to be looked at before take() says how much of it there is.
  const std::uint8_t* peek() const { return at_; }
  std::uint8_t byte() { return *take(1); }
  /// Unsigned LEB128 of at most five bytes.
  std::uint32_t varint() {
    std::uint32_t value = byte();
    if (value < 0x80) return value;  // as nearly all
    value &= 0x7F;
    for (unsigned shift = 7; shift < 35; shift += 7) {
      const std::uint8_t b = byte();
      value |= static_cast<std::uint32_t>(b & 0x7Fu) << shift;
      if (b < 0x80) return value;
    }
    damaged_meshopt("a number has more than five bytes");
  }
  void expect_end() const {
    if (at_ != end_) damaged_meshopt("bytes are left over");
  }

 private:
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

template <class V>
V load_bytes(const void* from) {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <class V>
void store_bytes(void* to, V v) {
  std::memcpy(to, &v, sizeof v);
}

}  // namespace candela::io
