#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "base/file.h"
#include "io/gltf.h"
#include "unit/base/temp_folder.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names_in(const fs::path& folder, const std::vector<io::ReferencedFile>& files) {
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const io::ReferencedFile& file : files)
    names.push_back(file.path.lexically_relative(folder).string() + file.place);
  std::sort(names.begin(), names.end());
  return names;
}

constexpr const char* kText = R"({"asset": {"version": "2.0"},
  "buffers": [{"byteLength": 4, "uri": "numbers.bin"}, {"byteLength": 1, "uri": "data:,a"}],
  "images": [{"uri": "a%20map.png"}, {"uri": "http://example.org/far.png"}, {"uri": "/absolute.png"}, {"uri": "sub/b.png"}],
  "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "extras": {"candela": {"ies": "lamp.ies"}}}]},
                 "EXT_lights_ies": {"lights": [{"uri": "other.ies"}]},
                 "VENDOR_thing": {"deep": [[{"uri": "thing.dat"}]]}},
  "meshes": [{"weights": [0, 1], "primitives": [{"extensions": {"VENDOR_thing": {"uri": "mesh.dat"}}}]}],
  "accessors": [{"min": [0, 0, 0], "extras": {"uri": "list.dat"}}],
  "nodes": [{"name": "uri", "extras": {"uri": 7}}]})";

TEST(unit_io_gltf_files, every_file_that_a_document_names_is_known_whether_it_is_needed_or_there) {
  const test::TempFolder folder;
  write_file(folder / "a.gltf", std::string(kText));
  const std::vector<std::string> expected = {"a map.png#/images/0/uri",
                                             "a%20map.png#/images/0/uri",
                                             "a.gltf",
                                             "lamp.ies#/extensions/KHR_lights_punctual/lights/0/extras/candela/ies",
                                             "list.dat#/accessors/0/extras/uri",
                                             "mesh.dat#/meshes/0/primitives/0/extensions/VENDOR_thing/uri",
                                             "numbers.bin#/buffers/0/uri",
                                             "other.ies#/extensions/EXT_lights_ies/lights/0/uri",
                                             "sub/b.png#/images/3/uri",
                                             "thing.dat#/extensions/VENDOR_thing/deep/0/0/uri"};
  EXPECT_EQ(names_in(folder.path(), io::files_of_gltf(folder / "a.gltf")), expected);
  // An open file knows them before any of them is read.
  Diagnostics diagnostics;
  io::FileInfo info;
  const io::GltfFile file(folder / "a.gltf", diagnostics, {.refuse_unknown_required = false}, &info);
  EXPECT_EQ(names_in(folder.path(), file.info().files), expected);
  EXPECT_EQ(names_in(folder.path(), info.files), expected);
  EXPECT_EQ(file.info().files.front().path, folder / "a.gltf");
}

TEST(unit_io_gltf_files, a_document_in_memory_without_a_folder_names_none) {
  Diagnostics diagnostics;
  std::vector<std::byte> bytes(std::strlen(kText));
  std::memcpy(bytes.data(), kText, bytes.size());
  const io::GltfFile file(bytes, {}, "memory", diagnostics, {.refuse_unknown_required = false});
  EXPECT_TRUE(file.info().files.empty());
}

TEST(unit_io_gltf_files, depth_is_no_danger) {
  const test::TempFolder folder;
  const int depth = 200000;
  std::string text = R"({"asset": {"version": "2.0"}, "extras": )";
  for (int i = 0; i < depth; ++i) text += '[';
  text += R"({"uri": "deep.png"})";
  for (int i = 0; i < depth; ++i) text += ']';
  write_file(folder / "a.gltf", text + "}");
  EXPECT_EQ(io::files_of_gltf(folder / "a.gltf").size(), 2u);
}

}  // namespace
}  // namespace candela
