#include "image/lettering.h"

#include <algorithm>

#include "image/letters.h"

namespace candela {

namespace {

constexpr std::uint32_t kBox = 0x25a1;

const Letters& letters_of(LetterSize size) { return size == LetterSize::title ? kTitleLetters : kTextLetters; }

const Letter* find(const Letters& letters, std::uint32_t code) {
  const auto found = std::lower_bound(letters.letters.begin(), letters.letters.end(), code,
                                      [](const Letter& letter, std::uint32_t c) { return letter.code < c; });
  return found != letters.letters.end() && found->code == code ? &*found : nullptr;
}
const Letter& letter(const Letters& letters, std::uint32_t code) {
  const Letter* own = find(letters, code);
  if (own == nullptr) own = find(letters, kBox);
  return own != nullptr ? *own : letters.letters.front();
}

/// The first code of a text of UTF-8, which is shortened by it; a byte that begins none is a box.
std::uint32_t take_code(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  const std::size_t count = first < 0x80 ? 1 : first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc0 ? 2 : 0;
  std::uint32_t code = count == 1 ? first : first & (0x7fU >> count);
  bool is_whole = count > 0 && count <= text.size();
  for (std::size_t i = 1; is_whole && i < count; ++i) {
    is_whole = (byte(i) & 0xc0U) == 0x80U;
    code = code << 6U | (byte(i) & 0x3fU);
  }
  text.remove_prefix(is_whole ? count : 1);
  return is_whole && code >= ' ' ? code : kBox;
}

}  // namespace

int line_height(LetterSize size) { return letters_of(size).line_height; }

int text_width(std::string_view line, LetterSize size) {
  int width = 0;
  while (!line.empty()) width += letter(letters_of(size), take_code(line)).advance;
  return width;
}

std::string fitted(std::string_view line, int width, LetterSize size) {
  if (text_width(line, size) <= width) return std::string(line);
  const int room = width - text_width("…", size);
  std::string_view rest = line;
  std::size_t end = 0;
  for (int used = 0; !rest.empty();) {
    used += letter(letters_of(size), take_code(rest)).advance;
    if (used > room) break;
    end = line.size() - rest.size();
  }
  return std::string(line.substr(0, end)) + "…";
}

std::vector<std::string> wrapped(std::string_view text, int width, LetterSize size) {
  std::vector<std::string> lines;
  std::string line;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string word(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    std::string longer = line;
    if (!longer.empty()) longer += ' ';
    longer += word;
    if (!line.empty() && text_width(longer, size) > width) {
      lines.push_back(fitted(line, width, size));
      line = word;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) lines.push_back(fitted(line, width, size));
  return lines;
}

void draw_text(DisplayImage& image, int x, int y, std::string_view line, Ink ink, LetterSize size) {
  const Letters& letters = letters_of(size);
  const auto blend = [](std::uint8_t& under, std::uint8_t over, unsigned coverage) {
    under = static_cast<std::uint8_t>((under * (255U - coverage) + over * coverage + 127U) / 255U);
  };
  while (!line.empty()) {
    const Letter& l = letter(letters, take_code(line));
    for (int row = 0; row < l.height; ++row) {
      for (int column = 0; column < l.width; ++column) {
        const int px = x + l.left + column, py = y + l.top + row;
        if (px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
        const unsigned coverage = letters.coverage[l.offset + static_cast<unsigned>(row * l.width + column)];
        std::uint8_t* pixel =
            image.rgba.data() +
            4 * (static_cast<std::size_t>(py) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(px));
        blend(pixel[0], ink.r, coverage), blend(pixel[1], ink.g, coverage), blend(pixel[2], ink.b, coverage);
        blend(pixel[3], 255, coverage);
      }
    }
    x += l.advance;
  }
}

}  // namespace candela
