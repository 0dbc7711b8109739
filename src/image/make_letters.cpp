// Draws the letters of a typeface into a source file, for lettering.cpp: make_letters FONT.ttf OUTPUT.cpp
#include <ft2build.h>
#include FT_FREETYPE_H

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "make_letters: %s\n", what.c_str());
  std::exit(1);
}

/// What people name files, materials and findings with.
std::vector<unsigned long> codes() {
  std::vector<unsigned long> result;
  const auto add = [&](unsigned long first, unsigned long last) {
    for (unsigned long code = first; code <= last; ++code) result.push_back(code);
  };
  add(0x20, 0x7e);
  add(0xa0, 0x17f);     // Latin-1 and Extended-A
  add(0x370, 0x45f);    // Greek, Cyrillic
  add(0x2010, 0x2027);  // dashes, quotation marks, ellipsis
  add(0x2070, 0x209c);  // superscripts and subscripts
  add(0x2190, 0x2193);  // arrows
  add(0x2200, 0x2265);  // mathematics
  add(0x25a1, 0x25a1);  // the box for what is not there
  return result;
}

void write_letters(FT_Face face, const char* name, int pixels, std::FILE* out) {
  if (FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(pixels)) != 0) fail("the font has no such size");
  const int ascender = static_cast<int>(face->size->metrics.ascender / 64);
  const int height = static_cast<int>(face->size->metrics.height / 64);
  std::vector<unsigned char> coverage;
  std::fprintf(out, "constexpr Letter k%sTable[] = {\n", name);
  for (const unsigned long code : codes()) {
    // Without hints, whose result depends on the library's version.
    if (FT_Get_Char_Index(face, code) == 0 || FT_Load_Char(face, code, FT_LOAD_RENDER | FT_LOAD_NO_HINTING) != 0)
      continue;
    const FT_GlyphSlot slot = face->glyph;
    const FT_Bitmap& bitmap = slot->bitmap;
    std::fprintf(out, "{%lu,%d,%d,%u,%u,%d,%zu},\n", code, slot->bitmap_left, ascender - slot->bitmap_top, bitmap.width,
                 bitmap.rows, static_cast<int>((slot->advance.x + 32) / 64), coverage.size());
    for (unsigned y = 0; y < bitmap.rows; ++y) {
      const unsigned char* row = bitmap.buffer + static_cast<std::ptrdiff_t>(y) * bitmap.pitch;
      coverage.insert(coverage.end(), row, row + bitmap.width);
    }
  }
  std::fprintf(out, "};\nconstexpr unsigned char k%sCoverage[] = {\n", name);
  for (std::size_t i = 0; i < coverage.size(); ++i) std::fprintf(out, "%u,%s", coverage[i], i % 32 == 31 ? "\n" : "");
  std::fprintf(out, "};\n}\nconst Letters k%sLetters{%d, k%sTable, k%sCoverage};\nnamespace {\n", name, height, name,
               name);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) fail("usage: make_letters FONT.ttf OUTPUT.cpp");
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  if (FT_Init_FreeType(&library) != 0 || FT_New_Face(library, argv[1], 0, &face) != 0) {
    fail(std::string("cannot read ") + argv[1]);
  }
  std::FILE* out = std::fopen(argv[2], "w");
  if (out == nullptr) fail(std::string("cannot write ") + argv[2]);
  constexpr int kText = 14, kTitle = 22;
  std::fputs("#include \"image/letters.h\"\nnamespace candela {\nnamespace {\n", out);
  write_letters(face, "Text", kText, out);
  write_letters(face, "Title", kTitle, out);
  std::fputs("}\n}\n", out);
  if (std::fclose(out) != 0) fail("the disk is full");
  FT_Done_Face(face);
  FT_Done_FreeType(library);
}
