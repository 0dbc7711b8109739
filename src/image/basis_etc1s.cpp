#include "image/basis_etc1s.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "base/error.h"

namespace candela::codec {

namespace {

static_assert(std::endian::native == std::endian::little, "numbers are stored with the small end first");

[[noreturn]] void damaged(const std::string& what, const std::string& where) {
  throw Error("damaged: the BasisLZ " + what, where);
}

// ----- global data

struct GlobalHeader {
  std::uint16_t endpoints, patterns;
  std::uint32_t endpoint_bytes, pattern_bytes, table_bytes, extended_bytes;
};
constexpr std::size_t kHeaderBytes = 20, kImageBytes = 20;

template <class T>
T number_at(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Its parts fill the data to the last byte.
GlobalHeader read_header(std::span<const std::byte> data, std::size_t images, const std::string& where) {
  if (data.size() < kHeaderBytes) damaged("books are missing", where);
  const GlobalHeader header{number_at<std::uint16_t>(data, 0),  number_at<std::uint16_t>(data, 2),
                            number_at<std::uint32_t>(data, 4),  number_at<std::uint32_t>(data, 8),
                            number_at<std::uint32_t>(data, 12), number_at<std::uint32_t>(data, 16)};
  const std::uint64_t size = kHeaderBytes + std::uint64_t{kImageBytes} * images + header.endpoint_bytes +
                             header.pattern_bytes + header.table_bytes + std::uint64_t{header.extended_bytes};
  if (size != data.size()) damaged("books have other sizes than they state", where);
  if (header.endpoints == 0 || header.patterns == 0) damaged("books are empty", where);
  return header;
}

int symbol_of(const HuffmanTable& table, BitStream& bits, const std::string& where) {
  const int symbol = table.decode(bits);
  if (symbol < 0) damaged("data has a code that its table has not", where);
  return symbol;
}

// ----- the book of endpoints

/// ETC1, table "Intensity modifier sets": the small and the large step of each.
constexpr std::array<std::array<int, 2>, 8> kSteps{
    {{2, 8}, {5, 17}, {9, 29}, {13, 42}, {18, 60}, {24, 80}, {33, 106}, {47, 183}}};

using Rgb5 = std::array<int, 3>;

/// Patterns name the four in order of brightness.
std::array<std::uint32_t, 4> block_colors(const Rgb5& base, int table) {
  const auto [small, large] = kSteps[static_cast<std::size_t>(table)];
  const std::array<int, 4> steps{-large, -small, small, large};
  std::array<std::uint32_t, 4> colors{};
  for (std::size_t i = 0; i < 4; ++i) {
    std::uint32_t color = 0xff000000u;
    for (std::size_t c = 0; c < 3; ++c) {
      const int wide = base[c] << 3 | base[c] >> 2;
      color |= static_cast<std::uint32_t>(std::clamp(wide + steps[i], 0, 255)) << 8 * c;
    }
    colors[i] = color;
  }
  return colors;
}

/// Differences to the endpoint before; which table codes one depends on the value that it is added to.
void read_endpoints(std::span<const std::byte> data, std::size_t count, Etc1sBook& book, const std::string& where) {
  if (count > data.size() * 8) damaged("endpoints are more than their bits", where);
  BitStream bits(data);
  std::array<HuffmanTable, 3> delta_tables;
  for (HuffmanTable& table : delta_tables) table = read_huffman_table(bits, where);
  const HuffmanTable step_table = read_huffman_table(bits, where);
  const bool is_gray = bits.take(1) != 0;
  const auto next_value = [&](int before) {
    const HuffmanTable& table = delta_tables[before <= 9 ? 0 : before <= 21 ? 1 : 2];
    return (before + symbol_of(table, bits, where)) & 31;
  };
  int step = 0;
  Rgb5 base{16, 16, 16};
  book.colors.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    step = (step + symbol_of(step_table, bits, where)) & 7;
    base[0] = next_value(base[0]);
    for (std::size_t c = 1; c < 3; ++c) base[c] = is_gray ? base[0] : next_value(base[c]);
    book.colors.push_back(block_colors(base, step));
  }
  if (bits.overran()) damaged("endpoints end early", where);
}

// ----- the book of patterns

void read_patterns(std::span<const std::byte> data, std::size_t count, Etc1sBook& book, const std::string& where) {
  if (count > data.size() * 8) damaged("patterns are more than their bits", where);
  BitStream bits(data);
  if (bits.take(2) != 0) damaged("patterns are of a kind that is reserved", where);
  const bool is_raw = bits.take(1) != 0;
  HuffmanTable delta_table;
  if (!is_raw) delta_table = read_huffman_table(bits, where);
  std::uint32_t before = 0;
  book.patterns.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t pattern = 0;
    for (unsigned row = 0; row < 4; ++row) {
      const bool is_plain = is_raw || i == 0;
      const std::uint32_t value =
          is_plain ? bits.take(8) : static_cast<std::uint32_t>(symbol_of(delta_table, bits, where)) & 0xffu;
      pattern |= value << 8 * row;
    }
    before = is_raw ? pattern : before ^ pattern;
    book.patterns.push_back(before);
  }
  if (bits.overran()) damaged("patterns end early", where);
}

// ----- slices

/// The patterns that were named last, roughly the most used ones first ("Approximate Move to Front").
class History {
 public:
  explicit History(std::size_t size) : entries_(size), next_(size / 2) {}

  std::size_t size() const { return entries_.size(); }
  void add(std::uint32_t pattern) {
    if (entries_.empty()) return;
    entries_[next_++] = pattern;
    if (next_ == entries_.size()) next_ = entries_.size() / 2;
  }
  /// Takes an entry, which moves half way to the front.
  std::uint32_t use(std::size_t index) {
    const std::uint32_t pattern = entries_[index];
    if (index > 0) std::swap(entries_[index / 2], entries_[index]);
    return pattern;
  }

 private:
  std::vector<std::uint32_t> entries_;
  std::size_t next_;
};

/// A number in chunks of `kBits` bits, each with one bit more that says whether another follows. Of at most 35 bits.
template <unsigned kBits>
std::uint64_t read_chunks(BitStream& bits) {
  std::uint64_t value = 0;
  for (unsigned at = 0; at < 35; at += kBits) {
    const std::uint32_t chunk = bits.take(kBits + 1);
    value |= std::uint64_t{chunk & ((1u << kBits) - 1)} << at;
    if (chunk >> kBits == 0) break;
  }
  return value;
}

/// Names the endpoint and the pattern of each block in rows.
class SliceReader {
 public:
  SliceReader(const Etc1sBook& book, std::span<const std::byte> slice, std::size_t across, const std::string& where)
      : book_(book), bits_(slice), where_(where), history_(book.history), above_(across), squares_((across + 1) / 2) {}

  /// The next row, `emit(x, endpoint, pattern)` for each block.
  template <class Emit>
  void row(const Emit& emit) {
    const bool is_even = (y_ & 1) == 0;
    std::uint32_t corner = 0;  // above and left
    std::uint32_t predictions = 0;
    for (std::size_t x = 0; x < above_.size(); ++x) {
      if ((x & 1) == 0) predictions = is_even ? next_square(x / 2) : squares_[x / 2];
      const std::uint32_t above = above_[x];
      const std::uint32_t endpoint = next_endpoint(predictions & 3u, x, above, corner);
      predictions >>= 2;
      corner = above;
      above_[x] = static_cast<std::uint16_t>(endpoint);
      emit(x, endpoint, next_pattern());
    }
    ++y_;
    if (bits_.overran()) damaged("slice ends early", where_);
  }

 private:
  /// How four blocks' endpoints are found, two bits each; the lower two are kept for the next row.
  std::uint32_t next_square(std::size_t square) {
    constexpr int kRepeat = 256;
    if (square_run_ > 0) {
      --square_run_;
    } else {
      const int symbol = symbol_of(book_.endpoint_prediction, bits_, where_);
      if (symbol > kRepeat) damaged("slice has a prediction of no kind", where_);
      if (symbol == kRepeat)
        square_run_ = read_chunks<4>(bits_) + 2;  // 3 at least, this one among them
      else
        square_ = static_cast<std::uint32_t>(symbol);
    }
    squares_[square] = static_cast<std::uint8_t>(square_ >> 4);
    return square_;
  }

  std::uint32_t next_endpoint(std::uint32_t prediction, std::size_t x, std::uint32_t above, std::uint32_t corner) {
    switch (prediction) {
      case 0:
        if (x == 0) damaged("slice predicts from outside", where_);
        return endpoint_;
      case 1:
        if (y_ == 0) damaged("slice predicts from outside", where_);
        return endpoint_ = above;
      case 2:
        if (x == 0 || y_ == 0) damaged("slice predicts from outside", where_);
        return endpoint_ = corner;
      default:
        break;
    }
    const auto count = static_cast<std::uint32_t>(book_.colors.size());
    endpoint_ += static_cast<std::uint32_t>(symbol_of(book_.endpoint_delta, bits_, where_));
    if (endpoint_ >= count) endpoint_ -= count;
    if (endpoint_ >= count) damaged("slice names an endpoint beyond the book", where_);
    return endpoint_;
  }

  std::uint32_t next_pattern() {
    const auto count = static_cast<std::uint32_t>(book_.patterns.size());
    std::uint32_t symbol = count;  // in a run: the first of the history
    if (pattern_run_ > 0) {
      --pattern_run_;
    } else {
      symbol = static_cast<std::uint32_t>(symbol_of(book_.pattern, bits_, where_));
      if (symbol == count + history_.size()) {
        constexpr int kLongRun = 63;
        const int run = symbol_of(book_.pattern_run, bits_, where_);
        // 3 at least, this one among them.
        pattern_run_ = (run == kLongRun ? read_chunks<7>(bits_) : static_cast<std::uint64_t>(run)) + 2;
        symbol = count;
      }
    }
    if (symbol < count) {
      history_.add(symbol);
      return symbol;
    }
    if (symbol - count >= history_.size()) damaged("slice names a pattern beyond the book", where_);
    return history_.use(symbol - count);
  }

  const Etc1sBook& book_;
  BitStream bits_;
  const std::string& where_;
  History history_;
  std::vector<std::uint16_t> above_;   ///< endpoints of the row before, then of this one
  std::vector<std::uint8_t> squares_;  ///< predictions for the odd row
  std::size_t y_ = 0;
  std::uint32_t endpoint_ = 0, square_ = 0;
  std::uint64_t square_run_ = 0, pattern_run_ = 0;
};

/// Sixteen texels, given one by one where the image cuts the block.
struct Target {
  std::uint8_t* rgba;
  std::size_t pitch;
  int width, height;
};

void put_colors(const Target& to, std::size_t x, std::size_t y, const std::array<std::uint32_t, 4>& colors,
                std::uint32_t pattern) {
  const auto columns = static_cast<std::size_t>(std::min(4, to.width - static_cast<int>(4 * x)));
  const auto rows = static_cast<std::size_t>(std::min(4, to.height - static_cast<int>(4 * y)));
  std::uint8_t* out = to.rgba + 4 * y * to.pitch + 16 * x;
  for (std::size_t row = 0; row < rows; ++row, out += to.pitch, pattern >>= 8) {
    const std::array<std::uint32_t, 4> texels{colors[pattern & 3u], colors[pattern >> 2 & 3u],
                                              colors[pattern >> 4 & 3u], colors[pattern >> 6 & 3u]};
    if (columns == 4)
      std::memcpy(out, texels.data(), 16);
    else
      std::memcpy(out, texels.data(), 4 * columns);
  }
}

/// The second slice is grey: its green goes where it belongs.
void put_channel(const Target& to, std::size_t x, std::size_t y, const std::array<std::uint32_t, 4>& colors,
                 std::uint32_t pattern, std::size_t channel) {
  const auto columns = static_cast<std::size_t>(std::min(4, to.width - static_cast<int>(4 * x)));
  const auto rows = static_cast<std::size_t>(std::min(4, to.height - static_cast<int>(4 * y)));
  std::uint8_t* out = to.rgba + 4 * y * to.pitch + 16 * x + channel;
  for (std::size_t row = 0; row < rows; ++row, out += to.pitch)
    for (std::size_t column = 0; column < columns; ++column)
      out[4 * column] = static_cast<std::uint8_t>(colors[pattern >> (8 * row + 2 * column) & 3u] >> 8);
}

template <class Put>
void decode_slice(const Etc1sBook& book, std::span<const std::byte> slice, const Target& to, const std::string& where,
                  const Put& put) {
  const auto across = static_cast<std::size_t>((to.width + 3) / 4),
             down = static_cast<std::size_t>((to.height + 3) / 4);
  SliceReader reader(book, slice, across, where);
  for (std::size_t y = 0; y < down; ++y)
    reader.row([&](std::size_t x, std::uint32_t endpoint, std::uint32_t pattern) {
      put(x, y, book.colors[endpoint], book.patterns[pattern]);
    });
}

}  // namespace

std::vector<Etc1sImage> read_etc1s_images(std::span<const std::byte> global_data, std::size_t count,
                                          const std::string& where) {
  read_header(global_data, count, where);
  std::vector<Etc1sImage> images(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const std::byte> at = global_data.subspan(kHeaderBytes + i * kImageBytes, kImageBytes);
    const auto flags = number_at<std::uint32_t>(at, 0);
    images[i] = {(flags & 2u) != 0, number_at<std::uint32_t>(at, 4), number_at<std::uint32_t>(at, 8),
                 number_at<std::uint32_t>(at, 12), number_at<std::uint32_t>(at, 16)};
    if (images[i].rgb_length == 0) damaged("slice is empty", where);
  }
  return images;
}

Etc1sBook read_etc1s_book(std::span<const std::byte> global_data, std::size_t image_count, const std::string& where) {
  const GlobalHeader header = read_header(global_data, image_count, where);
  std::span<const std::byte> rest = global_data.subspan(kHeaderBytes + image_count * kImageBytes);
  const auto part = [&](std::size_t size) {
    const std::span<const std::byte> result = rest.first(size);
    rest = rest.subspan(size);
    return result;
  };
  Etc1sBook book;
  read_endpoints(part(header.endpoint_bytes), header.endpoints, book, where);
  read_patterns(part(header.pattern_bytes), header.patterns, book, where);
  BitStream bits(part(header.table_bytes));
  book.endpoint_prediction = read_huffman_table(bits, where);
  book.endpoint_delta = read_huffman_table(bits, where);
  book.pattern = read_huffman_table(bits, where);
  book.pattern_run = read_huffman_table(bits, where);
  book.history = bits.take(13);
  if (bits.overran()) damaged("tables end early", where);
  return book;
}

void decode_etc1s(const Etc1sBook& book, std::span<const std::byte> rgb, std::span<const std::byte> second_slice,
                  Etc1sSecond second, int width, int height, std::span<std::uint8_t> rgba, const std::string& where) {
  CANDELA_CHECK(rgba.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  const Target to{rgba.data(), static_cast<std::size_t>(width) * 4, width, height};
  decode_slice(book, rgb, to, where, [&](std::size_t x, std::size_t y, const auto& colors, std::uint32_t pattern) {
    put_colors(to, x, y, colors, pattern);
  });
  if (second == Etc1sSecond::none) return;
  const std::size_t channel = second == Etc1sSecond::alpha ? 3 : 1;
  decode_slice(book, second_slice, to, where,
               [&](std::size_t x, std::size_t y, const auto& colors, std::uint32_t pattern) {
                 put_channel(to, x, y, colors, pattern, channel);
               });
  if (second == Etc1sSecond::green)
    for (std::size_t i = 2; i < rgba.size(); i += 4) rgba[i] = 0;
}

}  // namespace candela::codec
