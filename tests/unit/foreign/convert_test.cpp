#include "foreign/convert.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"

namespace candela::foreign {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

Surroundings files(const std::map<std::string, std::string>& all) {
  return {[all](const std::string& name) { return all.contains(name); },
          [all](const std::string& name) {
            if (!all.contains(name)) throw Error("no such file", name);
            const auto bytes = bytes_of(all.at(name));
            return std::vector<std::byte>(bytes.begin(), bytes.end());
          }};
}

nlohmann::json document(const Converted& made) {
  std::uint32_t length = 0;
  std::memcpy(&length, made.glb.data() + 12, 4);
  const char* text = reinterpret_cast<const char*>(made.glb.data()) + 20;
  return nlohmann::json::parse(text, text + length);
}

TEST(unit_foreign_convert, an_obj_becomes_a_glb_that_names_what_was_read) {
  const std::string obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
  Diagnostics diagnostics;
  const Converted made =
      convert(bytes_of(obj), Format::obj, files({{"a.mtl", "newmtl red\nKd 1 0 0\n"}}), "thing", "a.obj", diagnostics);
  EXPECT_EQ(made.read, std::vector<std::string>{"a.mtl"});
  const nlohmann::json gltf = document(made);
  EXPECT_EQ(gltf["nodes"][0]["name"], "thing");
  EXPECT_EQ(gltf["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"], (nlohmann::json{1, 0, 0, 1}));
  EXPECT_TRUE(diagnostics.warnings().empty());
  EXPECT_EQ(diagnostics.notes().size(), 1u) << "of units";
}

TEST(unit_foreign_convert, a_missing_library_is_a_warning_and_garbage_an_error) {
  Diagnostics diagnostics;
  convert(bytes_of("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), Format::obj, files({}), "a", "a.obj",
          diagnostics);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_EQ(diagnostics.warnings()[0].where, "a.obj");
  for (const Format format : {Format::fbx, Format::collada, Format::three_mf, Format::ply}) {
    EXPECT_THROW(convert(bytes_of("garbage"), format, files({}), "a", "a", diagnostics), Error);
  }
}

}  // namespace
}  // namespace candela::foreign
