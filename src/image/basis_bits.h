#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

// The bit stream of BasisLZ: numbers from the lowest bit up, and canonical Huffman codes as in Deflate (RFC 1951,
// § 3.2.2). Private to this folder.
namespace candela::codec {

/// Beyond the end come zeros, which `overran` tells: loops are bounded by what they fill, and ask once at their end.
class BitStream {
 public:
  explicit BitStream(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// The next `count` bits without taking them, at most 32.
  std::uint32_t peek(unsigned count) {
    if (filled_ < count) refill();
    return static_cast<std::uint32_t>(bits_ & ((std::uint64_t{1} << count) - 1));
  }
  /// Of bits that were peeked at.
  void skip(unsigned count) {
    bits_ >>= count;
    filled_ -= count;
    taken_ += count;
  }
  std::uint32_t take(unsigned count) {
    const std::uint32_t result = peek(count);
    skip(count);
    return result;
  }
  bool overran() const { return taken_ > std::uint64_t{bytes_.size()} * 8; }

 private:
  void refill() {
    if (bytes_.size() - at_ >= 8) {
      std::uint64_t next;
      std::memcpy(&next, bytes_.data() + at_, 8);
      bits_ |= next << filled_;
      const unsigned whole = (63 - filled_) / 8;  // bytes that fit
      at_ += whole;
      filled_ += 8 * whole;
      bits_ &= (std::uint64_t{1} << filled_) - 1;
      return;
    }
    for (; filled_ <= 56; filled_ += 8) {
      if (at_ < bytes_.size()) bits_ |= std::uint64_t{std::to_integer<std::uint8_t>(bytes_[at_++])} << filled_;
    }
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint64_t bits_ = 0;
  unsigned filled_ = 0;
  std::uint64_t taken_ = 0;
};

/// Codes of at most 16 bits for at most 16383 symbols.
class HuffmanTable {
 public:
  static constexpr unsigned kLongest = 16;

  HuffmanTable() = default;
  /// By the length of each symbol's code, 0 for those without. Throws Error("damaged: …", where) unless the codes fill
  /// the tree, or there is one symbol alone, or none.
  HuffmanTable(std::span<const std::uint8_t> lengths, const std::string& where);

  /// The next symbol; -1 where the bits are no code.
  int decode(BitStream& bits) const {
    const std::uint32_t code = bits.peek(kLongest);
    const Entry entry = fast_[code & (kFastSize - 1)];
    if (entry.length != 0) {
      bits.skip(entry.length);
      return entry.symbol;
    }
    return decode_long(bits, code);
  }
  bool empty() const { return symbols_.empty(); }

 private:
  static constexpr unsigned kFastBits = 10;
  static constexpr std::size_t kFastSize = std::size_t{1} << kFastBits;
  struct Entry {
    std::uint16_t symbol = 0;
    std::uint8_t length = 0;
  };

  int decode_long(BitStream& bits, std::uint32_t code) const;

  std::array<Entry, kFastSize> fast_{};
  std::vector<std::uint16_t> symbols_;                      ///< by length, then by number
  std::array<std::uint32_t, kLongest + 1> first_code_{};    ///< of each length
  std::array<std::uint32_t, kLongest + 1> first_symbol_{};  ///< its place in symbols_
  std::array<std::uint32_t, kLongest + 2> count_{};
};

/// A table as BasisLZ stores it ("Compressed Huffman Tables"). Throws Error("damaged: …", where).
HuffmanTable read_huffman_table(BitStream& bits, const std::string& where);

}  // namespace candela::codec
