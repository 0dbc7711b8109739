#include "foreign/formats.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace candela::foreign {
namespace {

using namespace std::string_literals;

Format of(const std::string& text) { return recognise(std::as_bytes(std::span(text.data(), text.size()))); }
std::string_view kind_of(const std::string& text) {
  return guess_kind(std::as_bytes(std::span(text.data(), text.size())));
}

/// `count` triangles, and what the header says of their number.
std::string binary_stl(const std::string& title, std::size_t count, std::uint32_t claimed) {
  std::string text = title;
  text.resize(80);
  text.append(reinterpret_cast<const char*>(&claimed), 4);
  text.resize(84 + 50 * count);
  return text;
}

TEST(unit_foreign_formats, each_is_known_by_its_content) {
  EXPECT_EQ(of("glTF\2\0\0\0"s), Format::gltf);
  EXPECT_EQ(of(" \n\xEF\xBB\xBF"s), Format::unknown);
  EXPECT_EQ(of("\xEF\xBB\xBF \n{\"asset\""s), Format::gltf);
  EXPECT_EQ(of("Kaydara FBX Binary  \0\x1a\0"s), Format::fbx);
  EXPECT_EQ(of("; FBX 7.4.0 project file\nFBXHeaderExtension: {"), Format::fbx);
  EXPECT_EQ(of("ply\nformat ascii 1.0"), Format::ply);
  EXPECT_EQ(of("ply\r\nformat ascii 1.0"), Format::ply);
  EXPECT_EQ(of("solid a\n facet normal 0 0 1"), Format::stl);
  EXPECT_EQ(of("<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">"), Format::collada);
  EXPECT_EQ(of("\x4D\x4D\x20\0\0\0\x02\0\x0A\0\0\0\3\0\0\0"s), Format::max_3ds);
  EXPECT_EQ(of("PK\3\4....[Content_Types].xml....3D/3dmodel.model...."), Format::three_mf);
}

TEST(unit_foreign_formats, obj_is_known_by_its_statements) {
  EXPECT_EQ(of("# made by hand\n\nmtllib a.mtl\no a\nv 0 0 0\nvn 0 0 1\nf 1 2 3\n"), Format::obj);
  EXPECT_EQ(of("v -1.5 .5 +2\r\nf 1//1 2//2 3//3\r\n"), Format::obj);
  EXPECT_EQ(of("g a\no b\n"), Format::unknown) << "nothing that only an OBJ has";
  EXPECT_EQ(of("v for victory\n"), Format::unknown);
  EXPECT_EQ(of("v 0 0 0\nDear reader,\n"), Format::unknown);
  EXPECT_EQ(of("newmtl a\nKd 1 1 1\n"), Format::unknown) << "a library of materials is no scene";
}

TEST(unit_foreign_formats, a_binary_stl_may_begin_as_a_text_and_is_known_by_its_length) {
  EXPECT_EQ(of(binary_stl("solid facet", 3, 3)), Format::stl);
  EXPECT_EQ(of(binary_stl("made by me", 3, 3)), Format::stl);
  EXPECT_NE(of(binary_stl("made by me", 3, 4)), Format::stl);
  EXPECT_NE(of(binary_stl("made by me", 0, 0)), Format::stl);
  EXPECT_NE(of(binary_stl("made by me", 3, 0xFFFFFFFF)), Format::stl);
}

TEST(unit_foreign_formats, what_is_no_scene_is_named) {
  EXPECT_EQ(of("\x89PNG\r\n\x1a\n"s), Format::unknown);
  EXPECT_EQ(kind_of("\x89PNG\r\n\x1a\n"s), "a PNG image");
  EXPECT_EQ(kind_of("BLENDER-v304"), "a Blender file; export it as glTF");
  EXPECT_EQ(kind_of(""), "empty");
  EXPECT_EQ(kind_of("Dear reader"), "");
  EXPECT_EQ(of("PK\3\4....word/document.xml"), Format::unknown);
}

TEST(unit_foreign_formats, no_beginning_of_a_file_is_too_short) {
  const std::string whole = binary_stl("solid facet", 2, 2);
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_NE(of(whole.substr(0, size)), Format::gltf);
  const std::string chunk = "\x4D\x4D\x20\0\0\0\x02\0\x0A\0\0\0\3\0\0\0"s;
  for (std::size_t size = 0; size < 12; ++size) EXPECT_EQ(of(chunk.substr(0, size)), Format::unknown);
}

}  // namespace
}  // namespace candela::foreign
