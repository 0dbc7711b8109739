#include "image/basis_uastc.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "base/check.h"
#include "base/parallel.h"

// Names of fields and tables are those of the chapter.
namespace candela::codec {

namespace {

static_assert(std::endian::native == std::endian::little, "a texel's first byte is red");

constexpr std::uint32_t kErrorColor = 0xffff00ffu;  // magenta
constexpr int kModes = 19;
constexpr int kSolidMode = 8;

// ----- what the mode says

/// Endpoint codes are a trit or quint times 2^bits plus bits, or bits alone.
enum class Digit : std::uint8_t { none, trit, quint };
enum class Patterns : std::uint8_t { none, two, two_of_seven, three };

struct Mode {
  std::uint8_t hint_bits;  ///< between the mode and PAT or CSEL; they speed up other conversions
  std::uint8_t endpoint_bits;
  Digit digit;
  std::uint8_t weight_bits;
  std::uint8_t subsets;
  std::uint8_t components;  ///< 2: luminance and alpha
  bool is_dual;             ///< one channel has weights of its own
  Patterns patterns;
  std::uint8_t etc2m_at;  ///< where in the hints the four bits are that must not be 0; 0 where there are none
};

// BC1H0, BC1H1, ETC1F, ETC1D, ETCI0 and ETCI1 are 10 bits (9 without BC1H1), ETCBI 5, ETC2T and ETC2M 8.
constexpr std::array<Mode, kModes> kModeTable{{
    {15, 6, Digit::trit, 4, 1, 3, false, Patterns::none, 0},
    {15, 8, Digit::none, 2, 1, 3, false, Patterns::none, 0},
    {15, 4, Digit::none, 3, 2, 3, false, Patterns::two, 0},
    {15, 2, Digit::trit, 2, 3, 3, false, Patterns::three, 0},
    {15, 3, Digit::quint, 2, 2, 3, false, Patterns::two, 0},
    {15, 8, Digit::none, 3, 1, 3, false, Patterns::none, 0},
    {15, 5, Digit::quint, 2, 1, 3, true, Patterns::none, 0},
    {15, 3, Digit::quint, 2, 2, 3, false, Patterns::two_of_seven, 0},
    {0, 8, Digit::none, 0, 1, 4, false, Patterns::none, 0},
    {23, 4, Digit::none, 2, 2, 4, false, Patterns::two, 19},
    {17, 4, Digit::trit, 4, 1, 4, false, Patterns::none, 13},
    {17, 4, Digit::trit, 2, 1, 4, true, Patterns::none, 13},
    {17, 6, Digit::trit, 3, 1, 4, false, Patterns::none, 13},
    {23, 8, Digit::none, 1, 1, 4, true, Patterns::none, 19},
    {23, 8, Digit::none, 2, 1, 4, false, Patterns::none, 19},
    {23, 8, Digit::none, 4, 1, 2, false, Patterns::none, 19},
    {23, 8, Digit::none, 2, 2, 2, false, Patterns::two, 19},
    {23, 8, Digit::none, 2, 1, 2, true, Patterns::none, 19},
    {15, 5, Digit::none, 5, 1, 3, false, Patterns::none, 0},
}};

struct ModeCode {
  std::uint8_t bits, length;
};
constexpr std::array<ModeCode, kModes> kModeCodes{{{0x01, 4},
                                                   {0x35, 6},
                                                   {0x1d, 5},
                                                   {0x03, 5},
                                                   {0x13, 5},
                                                   {0x0b, 5},
                                                   {0x1b, 5},
                                                   {0x07, 5},
                                                   {0x17, 5},
                                                   {0x0f, 5},
                                                   {0x02, 3},
                                                   {0x00, 2},
                                                   {0x06, 3},
                                                   {0x1f, 5},
                                                   {0x0d, 5},
                                                   {0x05, 7},
                                                   {0x15, 6},
                                                   {0x25, 6},
                                                   {0x09, 4}}};

/// The mode by the first seven bits; -1 where there is none.
constexpr std::array<int, 128> kModeOfBits = [] {
  std::array<int, 128> table{};
  table.fill(-1);
  for (std::size_t mode = 0; mode < kModeCodes.size(); ++mode)
    for (std::size_t bits = kModeCodes[mode].bits; bits < 128; bits += std::size_t{1} << kModeCodes[mode].length)
      table[bits] = static_cast<int>(mode);
  return table;
}();

// ----- partition patterns: two bits a texel, the first texel lowest

constexpr std::uint32_t spread_bits(std::uint32_t mask) {
  std::uint32_t result = 0;
  for (unsigned i = 0; i < 16; ++i) result |= (mask >> i & 1u) << 2 * i;
  return result;
}

template <std::size_t N>
constexpr std::array<std::uint32_t, N> spread(const std::array<std::uint16_t, N>& masks) {
  std::array<std::uint32_t, N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i] = spread_bits(masks[i]);
  return result;
}

constexpr auto kTwoSubsets = spread(
    std::to_array<std::uint16_t>({0xcccc, 0x8888, 0x1111, 0xecc8, 0x377f, 0xfeec, 0x0137, 0x137f, 0xc800, 0x0013,
                                  0xfe80, 0x17ff, 0x0017, 0x00ff, 0xfff0, 0x0fff, 0xff71, 0x8eff, 0x08ce, 0x008c,
                                  0x7310, 0xceff, 0x7331, 0x088c, 0xceef, 0x6666, 0xf00f, 0x5555, 0x0f0f, 0x36c9}));
constexpr auto kTwoSubsetsOfSeven =
    spread(std::to_array<std::uint16_t>({0x00f0, 0x4444, 0x0133, 0xcc80, 0xf0ff, 0x2222, 0xffc8, 0xccce, 0x3c03, 0x00ee,
                                         0x7700, 0x3003, 0x00ce, 0xff80, 0x6fff, 0x1333, 0x11ff, 0x136c, 0x00ef}));
constexpr auto kThreeSubsets =
    std::to_array<std::uint32_t>({0xa5a50000, 0xaa005555, 0xaa000055, 0x0000aa55, 0x25252525, 0x94949494, 0x58585858,
                                  0x56560202, 0x92929292, 0x55aa0055, 0xa05050a0});

std::span<const std::uint32_t> patterns_of(Patterns patterns) {
  switch (patterns) {
    case Patterns::two:
      return kTwoSubsets;
    case Patterns::two_of_seven:
      return kTwoSubsetsOfSeven;
    case Patterns::three:
      return kThreeSubsets;
    case Patterns::none:
      break;
  }
  return {};
}

// ----- endpoints

/// ASTC's unquantization of a code with a trit or quint (there "Endpoint Unquantization"): bits are spread over nine by
/// `layout`, one character per bit, the lowest bit of the code inverts.
struct DigitRange {
  int bits;
  int digits;
  const char* layout;
  int step;
};
constexpr DigitRange kRange11{2, 3, "b000b0bb0", 93};
constexpr DigitRange kRange39{3, 5, "cb0000cbc", 26};
constexpr DigitRange kRange47{4, 3, "dcb000dcb", 22};
constexpr DigitRange kRange159{5, 5, "edcb0000e", 6};
constexpr DigitRange kRange191{6, 3, "fedcb000f", 5};

constexpr std::uint8_t unquantized(const DigitRange& range, int code) {
  const int bits = code & ((1 << range.bits) - 1), digit = code >> range.bits;
  int spread = 0;
  for (int i = 0; i < 9; ++i) {
    const char letter = range.layout[i];
    spread = spread << 1 | (letter == '0' ? 0 : bits >> (letter - 'a') & 1);
  }
  const int inverted = (bits & 1) != 0 ? 0x1ff : 0;
  const int value = (digit * range.step + spread) ^ inverted;
  return static_cast<std::uint8_t>((inverted & 0x80) | value >> 2);
}

using EndpointTable = std::array<std::uint8_t, 256>;

constexpr EndpointTable endpoint_table(const DigitRange& range) {
  EndpointTable table{};
  for (int code = 0; code < range.digits << range.bits; ++code)
    table[static_cast<std::size_t>(code)] = unquantized(range, code);
  return table;
}

/// Codes of bits alone, repeated until they fill eight.
constexpr EndpointTable replicated_table(int bits) {
  EndpointTable table{};
  for (int code = 0; code < 1 << bits; ++code)
    table[static_cast<std::size_t>(code)] =
        static_cast<std::uint8_t>(bits == 8 ? code : code << (8 - bits) | code >> (2 * bits - 8));
  return table;
}

constexpr EndpointTable kEndpoints11 = endpoint_table(kRange11), kEndpoints39 = endpoint_table(kRange39),
                        kEndpoints47 = endpoint_table(kRange47), kEndpoints159 = endpoint_table(kRange159),
                        kEndpoints191 = endpoint_table(kRange191), kEndpoints15 = replicated_table(4),
                        kEndpoints31 = replicated_table(5), kEndpoints255 = replicated_table(8);

constexpr const EndpointTable& endpoint_table_of(const Mode& mode) {
  if (mode.digit == Digit::quint) return mode.endpoint_bits == 3 ? kEndpoints39 : kEndpoints159;
  if (mode.digit == Digit::trit)
    return mode.endpoint_bits == 2 ? kEndpoints11 : mode.endpoint_bits == 4 ? kEndpoints47 : kEndpoints191;
  return mode.endpoint_bits == 4 ? kEndpoints15 : mode.endpoint_bits == 5 ? kEndpoints31 : kEndpoints255;
}

/// 128 bits, read from the lowest up.
class BlockBits {
 public:
  explicit BlockBits(std::span<const std::byte, kUastcBlockBytes> block) {
    std::memcpy(&low_, block.data(), 8);
    std::memcpy(&high_, block.data() + 8, 8);
  }
  /// The next `count` bits, at most 32.
  std::uint32_t take(unsigned count) {
    const auto result = static_cast<std::uint32_t>(rest() & ((std::uint64_t{1} << count) - 1));
    at_ += count;
    return result;
  }
  std::uint32_t peek(unsigned count) const {
    return static_cast<std::uint32_t>(rest() & ((std::uint64_t{1} << count) - 1));
  }
  void skip(unsigned count) { at_ += count; }
  /// The next 64 bits, zeros beyond the block.
  std::uint64_t rest() const {
    if (at_ >= 64) return high_ >> (at_ - 64);
    return at_ == 0 ? low_ : low_ >> at_ | high_ << (64 - at_);
  }
  unsigned at() const { return at_; }

 private:
  std::uint64_t low_ = 0, high_ = 0;
  unsigned at_ = 0;
};

constexpr std::size_t kMostEndpoints = 18;

/// Packed digits, five trits to 8 bits or three quints to 7; the last group may have fewer.
void read_digits(BlockBits& bits, Digit digit, std::size_t count, std::array<std::uint8_t, kMostEndpoints>& digits) {
  constexpr std::array<unsigned, 6> kTritBits{0, 2, 4, 5, 7, 8};
  const bool is_trit = digit == Digit::trit;
  const std::uint32_t base = is_trit ? 3 : 5;
  const std::size_t group = is_trit ? 5 : 3;
  for (std::size_t begin = 0; begin < count; begin += group) {
    const std::size_t size = std::min(group, count - begin);
    std::uint32_t packed = bits.take(is_trit ? kTritBits[size] : 7);
    for (std::size_t i = 0; i < size; ++i, packed /= base) digits[begin + i] = static_cast<std::uint8_t>(packed % base);
  }
}

/// Four channels of a colour, each in 16 bits of one word, so that one multiplication mixes all.
struct Endpoints {
  std::uint64_t low, high;
};

/// Endpoint values in the order of the block: low and high of each component, subset by subset.
void read_endpoints(BlockBits& bits, const Mode& mode, std::array<Endpoints, 3>& result) {
  const std::size_t components = mode.components;
  const std::size_t count = 2 * components * mode.subsets;
  std::array<std::uint8_t, kMostEndpoints> digits{};
  if (mode.digit != Digit::none) read_digits(bits, mode.digit, count, digits);
  const EndpointTable& table = endpoint_table_of(mode);
  for (std::size_t subset = 0; subset < mode.subsets; ++subset) {
    std::uint64_t low = 0, high = 0;
    for (std::size_t c = 0; c < components; ++c) {
      const std::size_t at = (subset * components + c) * 2;
      const auto value = [&](std::size_t i) {
        return std::uint64_t{
            table[(static_cast<std::size_t>(digits[i]) << mode.endpoint_bits) + bits.take(mode.endpoint_bits)]};
      };
      low |= value(at) << 16 * c;
      high |= value(at + 1) << 16 * c;
    }
    if (components == 3) {
      low |= std::uint64_t{255} << 48;
      high |= std::uint64_t{255} << 48;
    } else if (components == 2) {
      constexpr std::uint64_t kThrice = 0x100010001u;
      low = (low & 0xff) * kThrice | (low >> 16) << 48;
      high = (high & 0xff) * kThrice | (high >> 16) << 48;
    }
    result[subset] = {low, high};
  }
}

// ----- weights

/// 0 to 64 by the code of 1 to 5 bits: repeated to six bits, and one more above the middle.
constexpr std::array<std::array<std::uint8_t, 32>, 6> kWeights = [] {
  std::array<std::array<std::uint8_t, 32>, 6> table{};
  for (unsigned bits = 1; bits <= 5; ++bits) {
    for (unsigned code = 0; code < 1u << bits; ++code) {
      unsigned value = 0;
      for (unsigned filled = 0; filled < 6; filled += bits)
        value |= filled + bits <= 6 ? code << (6 - bits - filled) : code >> (filled + bits - 6);
      table[bits][code] = static_cast<std::uint8_t>(value > 32 ? value + 1 : value);
    }
  }
  return table;
}();

/// (low · (64 - w) + high · w + 32) / 64 of endpoints that are widened to 16 bits, then the upper 8 bits, in all four
/// channels at once. With s = low · (64 - w) + high · w of 8-bit endpoints the widened sum is 257 s, or 256 s + 8192
/// for sRGB, and what is divided away can be divided in two steps: no channel ever needs more than 16 bits.
template <UastcRounding kRounding>
std::uint32_t mixed(const Endpoints& ends, std::uint32_t weight) {
  constexpr std::uint64_t kEach32 = 0x0020002000200020u, kLowBytes = 0x00ff00ff00ff00ffu;
  const std::uint64_t s = ends.low * (64 - weight) + ends.high * weight;
  std::uint64_t v = s + kEach32;
  if constexpr (kRounding == UastcRounding::linear) v = s + (v >> 8 & kLowBytes);
  v = v >> 6 & kLowBytes;
  v = (v | v >> 8) & 0x0000ffff0000ffffu;
  return static_cast<std::uint32_t>(v | v >> 16);
}

/// Colours by subset and weight code; 32 of one subset or 8 of each of three are the most.
using Palette = std::array<std::uint32_t, 32>;

template <UastcRounding kRounding>
void fill_palette(const Mode& mode, const std::array<Endpoints, 3>& ends, Palette& palette) {
  const std::size_t codes = std::size_t{1} << mode.weight_bits;
  for (std::size_t subset = 0; subset < mode.subsets; ++subset)
    for (std::size_t code = 0; code < codes; ++code)
      palette[subset * codes + code] = mixed<kRounding>(ends[subset], kWeights[mode.weight_bits][code]);
}

/// The first texel of each subset has one bit less: its highest is 0.
template <unsigned kBits>
void pick_colors(BlockBits bits, const Mode& mode, std::uint32_t pattern, const Palette& palette,
                 std::span<std::uint32_t, 16> texels) {
  std::uint32_t unseen = (1u << mode.subsets) - 1;
  for (std::size_t i = 0; i < 16; i += 4) {
    std::uint64_t codes = bits.rest();  // four texels have at most 20 bits
    unsigned used = 0;
    for (std::size_t k = i; k < i + 4; ++k) {
      const std::uint32_t subset = pattern >> 2 * k & 3u;
      const unsigned count = kBits - (unseen >> subset & 1u);
      unseen &= ~(1u << subset);
      texels[k] = palette[(subset << kBits) + (codes & ((1u << count) - 1))];
      codes >>= count;
      used += count;
    }
    bits.skip(used);
  }
}

/// Two weights a texel: the second is for one channel.
void pick_dual_colors(BlockBits& bits, const Mode& mode, std::uint32_t channel, const Palette& palette,
                      std::span<std::uint32_t, 16> texels) {
  const std::uint32_t own = 0xffu << 8 * channel;
  unsigned count = mode.weight_bits - 1u;
  for (std::uint32_t& texel : texels) {
    const std::uint32_t first = palette[bits.take(count)], second = palette[bits.take(count)];
    texel = (first & ~own) | (second & own);
    count = mode.weight_bits;
  }
}

void pick(const BlockBits& bits, const Mode& mode, std::uint32_t pattern, const Palette& palette,
          std::span<std::uint32_t, 16> texels) {
  switch (mode.weight_bits) {
    case 2:
      return pick_colors<2>(bits, mode, pattern, palette, texels);
    case 3:
      return pick_colors<3>(bits, mode, pattern, palette, texels);
    case 4:
      return pick_colors<4>(bits, mode, pattern, palette, texels);
    default:
      return pick_colors<5>(bits, mode, pattern, palette, texels);
  }
}

// ----- blocks

/// CSEL of the modes that have it; with luminance it is always alpha.
std::uint32_t dual_channel(BlockBits& bits, const Mode& mode) { return mode.components == 2 ? 3 : bits.take(2); }

int no_mode(std::span<std::uint32_t, 16> texels) {
  std::fill(texels.begin(), texels.end(), kErrorColor);
  return -1;
}

template <UastcRounding kRounding>
int decode_block(std::span<const std::byte, kUastcBlockBytes> block, std::span<std::uint32_t, 16> texels) {
  BlockBits bits(block);
  const int index = kModeOfBits[bits.peek(7)];
  if (index < 0) return no_mode(texels);
  bits.skip(kModeCodes[static_cast<std::size_t>(index)].length);
  if (index == kSolidMode) {
    std::fill(texels.begin(), texels.end(), bits.take(32));
    return index;
  }
  const Mode& mode = kModeTable[static_cast<std::size_t>(index)];
  const std::uint32_t hints = bits.take(mode.hint_bits);
  if (mode.etc2m_at != 0 && (hints >> mode.etc2m_at & 15u) == 0) return no_mode(texels);
  const std::uint32_t channel = mode.is_dual ? dual_channel(bits, mode) : 0;
  std::uint32_t pattern = 0;
  if (mode.patterns != Patterns::none) {
    const std::span<const std::uint32_t> patterns = patterns_of(mode.patterns);
    const std::uint32_t number = bits.take(mode.patterns == Patterns::three ? 4 : 5);
    if (number >= patterns.size()) return no_mode(texels);
    pattern = patterns[number];
  }
  std::array<Endpoints, 3> ends{};
  read_endpoints(bits, mode, ends);
  Palette palette;
  fill_palette<kRounding>(mode, ends, palette);
  if (mode.is_dual)
    pick_dual_colors(bits, mode, channel, palette, texels);
  else
    pick(bits, mode, pattern, palette, texels);
  return index;
}

/// One row of blocks; those at the right and lower edge may be cut.
template <UastcRounding kRounding>
void decode_row(std::span<const std::byte> blocks, int width, int rows, std::uint8_t* rgba) {
  const std::size_t pitch = static_cast<std::size_t>(width) * 4;
  std::array<std::uint32_t, 16> texels;
  for (int x = 0; x < width; x += 4, blocks = blocks.subspan(kUastcBlockBytes)) {
    decode_block<kRounding>(blocks.first<kUastcBlockBytes>(), texels);
    const auto count = static_cast<std::size_t>(std::min(4, width - x)) * 4;
    std::uint8_t* out = rgba + static_cast<std::size_t>(x) * 4;
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row)
      std::memcpy(out + row * pitch, texels.data() + 4 * row, count);
  }
}

}  // namespace

int decode_uastc_block(std::span<const std::byte, kUastcBlockBytes> block, UastcRounding rounding,
                       std::span<std::uint32_t, 16> texels) {
  return rounding == UastcRounding::srgb ? decode_block<UastcRounding::srgb>(block, texels)
                                         : decode_block<UastcRounding::linear>(block, texels);
}

void decode_uastc(std::span<const std::byte> blocks, int width, int height, UastcRounding rounding,
                  std::span<std::uint8_t> rgba) {
  const auto across = static_cast<std::size_t>((width + 3) / 4), down = static_cast<std::size_t>((height + 3) / 4);
  CANDELA_CHECK(blocks.size() == across * down * kUastcBlockBytes);
  CANDELA_CHECK(rgba.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  const std::size_t row_bytes = across * kUastcBlockBytes;
  parallel_for(0, down, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      const int rows = std::min(4, height - static_cast<int>(4 * y));
      const std::span<const std::byte> row = blocks.subspan(y * row_bytes, row_bytes);
      std::uint8_t* out = rgba.data() + 4 * y * static_cast<std::size_t>(width) * 4;
      if (rounding == UastcRounding::srgb)
        decode_row<UastcRounding::srgb>(row, width, rows, out);
      else
        decode_row<UastcRounding::linear>(row, width, rows, out);
    }
  });
}

}  // namespace candela::codec
