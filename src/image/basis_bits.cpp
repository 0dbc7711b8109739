#include "image/basis_bits.h"

#include <algorithm>

#include "base/error.h"

namespace candela::codec {

namespace {

[[noreturn]] void damaged(const std::string& what, const std::string& where) {
  throw Error("damaged: the BasisLZ " + what, where);
}

std::uint32_t reversed(std::uint32_t code, unsigned length) {
  std::uint32_t result = 0;
  for (unsigned i = 0; i < length; ++i) result |= (code >> i & 1u) << (length - 1 - i);
  return result;
}

}  // namespace

HuffmanTable::HuffmanTable(std::span<const std::uint8_t> lengths, const std::string& where) {
  for (const std::uint8_t length : lengths) ++count_[length];
  count_[0] = 0;
  std::uint32_t code = 0, used = 0;
  std::uint64_t filled = 0;  // of the tree's 2^16 leaves
  for (unsigned length = 1; length <= kLongest; ++length) {
    code = (code + count_[length - 1]) << 1;
    first_code_[length] = code;
    first_symbol_[length] = used;
    used += count_[length];
    filled += std::uint64_t{count_[length]} << (kLongest - length);
  }
  if (filled > (1u << kLongest) || (filled < (1u << kLongest) && used > 1)) damaged("code lengths make no tree", where);
  symbols_.resize(used);
  std::array<std::uint32_t, kLongest + 1> next = first_symbol_;
  for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
    const unsigned length = lengths[symbol];
    if (length == 0) continue;
    const std::uint32_t place = next[length]++;
    symbols_[place] = static_cast<std::uint16_t>(symbol);
    if (length > kFastBits) continue;
    // A code's first bit is its highest; the stream has it lowest.
    const std::uint32_t bits = reversed(first_code_[length] + place - first_symbol_[length], length);
    for (std::size_t i = bits; i < kFastSize; i += std::size_t{1} << length)
      fast_[i] = {static_cast<std::uint16_t>(symbol), static_cast<std::uint8_t>(length)};
  }
}

int HuffmanTable::decode_long(BitStream& bits, std::uint32_t code) const {
  std::uint32_t value = reversed(code & ((1u << kFastBits) - 1), kFastBits);
  for (unsigned length = kFastBits + 1; length <= kLongest; ++length) {
    value = value << 1 | (code >> (length - 1) & 1u);
    const std::uint32_t place = value - first_code_[length];
    if (value >= first_code_[length] && place < count_[length]) {
      bits.skip(length);
      return symbols_[first_symbol_[length] + place];
    }
  }
  return -1;
}

HuffmanTable read_huffman_table(BitStream& bits, const std::string& where) {
  constexpr std::array<std::uint8_t, 21> kOrder{17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                                11, 4,  12, 3,  13, 2, 14, 1, 15, 16};
  const std::uint32_t symbols = bits.take(14), used_lengths = bits.take(5);
  if (used_lengths > kOrder.size() || (used_lengths == 0 && symbols > 0)) damaged("code lengths have no codes", where);
  std::array<std::uint8_t, kOrder.size()> length_lengths{};
  for (std::size_t i = 0; i < used_lengths; ++i) length_lengths[kOrder[i]] = static_cast<std::uint8_t>(bits.take(3));
  const HuffmanTable length_table(length_lengths, where);

  std::vector<std::uint8_t> lengths;
  lengths.reserve(symbols);
  while (lengths.size() < symbols) {
    const int symbol = length_table.decode(bits);
    if (symbol < 0 || bits.overran()) damaged("code lengths end early", where);
    if (symbol <= 16) {
      lengths.push_back(static_cast<std::uint8_t>(symbol));
      continue;
    }
    // 17 and 18: a run of symbols without a code; 19 and 20: the last length again.
    std::size_t run = 0;
    std::uint8_t length = 0;
    if (symbol == 17) run = 3 + bits.take(3);
    if (symbol == 18) run = 11 + bits.take(7);
    if (symbol == 19) run = 3 + bits.take(2);
    if (symbol == 20) run = 7 + bits.take(7);
    if (symbol >= 19) {
      if (lengths.empty() || lengths.back() == 0) damaged("code lengths repeat none", where);
      length = lengths.back();
    }
    if (run > symbols - lengths.size()) damaged("code lengths are too many", where);
    lengths.insert(lengths.end(), run, length);
  }
  return HuffmanTable(lengths, where);
}

}  // namespace candela::codec
