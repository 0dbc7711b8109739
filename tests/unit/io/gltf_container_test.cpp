#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "base/file.h"
#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::vector<std::byte> patched(std::vector<std::byte> bytes, std::size_t offset, std::uint32_t word) {
  std::memcpy(bytes.data() + offset, &word, sizeof word);
  return bytes;
}

class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(fs::temp_directory_path() / ("candela_" + name + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

TEST(unit_io_gltf, glb_and_data_uri_give_the_same_triangle) {
  const Builder b = triangle();
  const Scene glb = load(b).scene;
  const Scene text = load_text(b.gltf()).scene;
  for (const Scene* scene : {&glb, &text}) {
    ASSERT_EQ(scene->meshes.size(), 1u);
    const Primitive& p = scene->meshes[0].primitives.at(0);
    EXPECT_EQ(p.positions, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(p.uvs[0], (std::vector<vec2>{{0, 1}, {1, 1}, {0, 0}}));
    EXPECT_EQ(p.triangles, (std::vector<uvec3>{{0, 1, 2}}));
    EXPECT_TRUE(p.tangents.empty());
    EXPECT_EQ(scene->nodes.at(0).mesh, 0);
  }
}

TEST(unit_io_gltf, what_is_no_gltf_says_so) {
  EXPECT_THAT(error_of(std::string()), HasSubstr("not a glTF file"));
  EXPECT_THAT(error_of(std::string("\x89PNG\r\n")), HasSubstr("not a glTF file"));
  EXPECT_THAT(error_of(std::string("[1, 2]")), HasSubstr("not a glTF file"));
  EXPECT_THAT(error_of(std::string("{}")), HasSubstr("no asset version"));
  EXPECT_THAT(error_of(std::string(R"({"asset": {"version": "1.0"}})")), HasSubstr("glTF 1.0 is not supported"));
  EXPECT_THAT(error_of(std::string(R"({"asset": {"version": 2}})")), HasSubstr("#/asset/version: must be a string"));
  EXPECT_THAT(error_of(std::string(R"({"asset": {"version": "2.0", "minVersion": "2.1"}})")), HasSubstr("2.1"));
}

TEST(unit_io_gltf, json_errors_have_line_and_column) {
  EXPECT_THAT(error_of(std::string("{\n\"asset\": {\n  \"version\" \"2.0\"}}")), HasSubstr("line 3, column 17"));
  EXPECT_THAT(error_of(std::string("{\"a\": \"\xFF\"}")), HasSubstr("JSON error at line 1"));
  EXPECT_THAT(error_of(std::string("{\"asset\": {\"version\": \"2.0\"}, \"extras\": 1e999}")), HasSubstr("JSON error"));
  EXPECT_LT(error_of("{\"a\": " + std::string(100000, 'x')).size(), 400u);
}

TEST(unit_io_gltf, deep_nesting_neither_crashes_nor_hangs) {
  const std::string open(200000, '['), close(200000, ']');
  EXPECT_EQ(error_of(R"({"asset": {"version": "2.0"}, "extras": )" + open + close + "}"), "loaded");
  EXPECT_THAT(error_of(R"({"asset": {"version": "2.0"}, "nodes": )" + open + close + "}"),
              HasSubstr("must be an object"));
  EXPECT_THAT(error_of(R"({"asset": )" + open), HasSubstr("JSON error"));
}

TEST(unit_io_gltf, broken_glb_headers_are_errors) {
  const auto glb = triangle().glb();
  EXPECT_THAT(error_of(std::span(glb).first(8)), HasSubstr("truncated GLB"));
  EXPECT_THAT(error_of(std::span(glb).first(glb.size() - 4)), HasSubstr("truncated GLB"));
  EXPECT_THAT(error_of(patched(glb, 4, 1)), HasSubstr("GLB version 1 is not supported"));
  EXPECT_THAT(error_of(patched(glb, 8, 4)), HasSubstr("length of only 4"));
  EXPECT_THAT(error_of(patched(glb, 12, 0xFFFFFFF0)), HasSubstr("GLB chunk 0 claims"));
  EXPECT_THAT(error_of(patched(glb, 16, 0x004E4942)), HasSubstr("first GLB chunk is not JSON"));
  EXPECT_THAT(error_of(patched(std::vector(glb.begin(), glb.begin() + 12), 8, 12)), HasSubstr("no JSON chunk"));
}

TEST(unit_io_gltf, glb_padding_and_unknown_chunks_are_tolerated) {
  auto glb = triangle().glb();
  const auto size = static_cast<std::uint32_t>(glb.size());
  glb.resize(size + 12);
  glb = patched(patched(patched(glb, 8, size + 12), size, 4), size + 4, 0x12345678);
  Diagnostics diagnostics;
  EXPECT_EQ(load_gltf(glb, {}, diagnostics).meshes.size(), 1u);
  EXPECT_TRUE(diagnostics.warnings().empty());
  glb.resize(glb.size() + 3);
  EXPECT_EQ(load_gltf(glb, {}, diagnostics).meshes.size(), 1u);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_THAT(diagnostics.warnings()[0].text(), HasSubstr("3 bytes after the end"));
}

TEST(unit_io_gltf, external_files_resolve_percent_escapes_spaces_unicode_and_parents) {
  const TemporaryFolder folder("gltf");
  fs::create_directories(folder.path() / "deep er");
  for (const auto& [uri, file] : std::vector<std::pair<std::string, std::string>>{{"a%20b%C3%A9.bin", "a bé.bin"},
                                                                                  {"a b.bin", "a b.bin"},
                                                                                  {"❤.bin", "❤.bin"},
                                                                                  {"100%.bin", "100%.bin"},
                                                                                  {"%41.bin", "%41.bin"},
                                                                                  {"../up.bin", "../up.bin"}}) {
    Builder b = triangle();
    b.root["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", uri}}};
    write_file(folder.path() / "deep er" / file, b.binary);
    write_file(folder.path() / "deep er" / "scene.gltf", b.gltf());
    Diagnostics diagnostics;
    const Scene scene = load_gltf(folder.path() / "deep er" / "scene.gltf", diagnostics);
    EXPECT_EQ(scene.meshes.size(), 1u) << uri;
    EXPECT_EQ(scene.name, "scene");
  }
}

TEST(unit_io_gltf, unwelcome_uris_are_errors) {
  const auto with_uri = [](const std::string& uri) {
    Builder b = triangle();
    b.root["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", uri}}};
    return b;
  };
  EXPECT_THAT(error_of(with_uri("https://example.org/a.bin")),
              HasSubstr("#/buffers/0/uri: 'https://example.org/a.bin' is not a relative"));
  EXPECT_THAT(error_of(with_uri("file:///etc/passwd")), HasSubstr("not a relative"));
  EXPECT_THAT(error_of(with_uri("C:\\a.bin")), HasSubstr("not a relative"));
  EXPECT_THAT(error_of(with_uri("/etc/passwd")), HasSubstr("not a relative"));
  EXPECT_THAT(error_of(with_uri("%2Fetc/passwd")), HasSubstr("not a relative"));
  EXPECT_THAT(error_of(with_uri("a.bin")), HasSubstr("cannot be read from here"));
  EXPECT_THAT(error_of(with_uri("")), HasSubstr("is not a file name"));
  EXPECT_THAT(error_of(with_uri("a%00.bin")), HasSubstr("is not a file name"));
  EXPECT_THAT(error_of(with_uri("data:;base64")), HasSubstr("no comma"));
  EXPECT_THAT(error_of(with_uri("data:;base64,AA*A")), HasSubstr("not valid base64"));
  EXPECT_THAT(error_of(with_uri("data:;base64,AAAA")), HasSubstr("#/buffers/0/byteLength: the buffer claims"));
  const TemporaryFolder folder("gltf_missing");
  Diagnostics diagnostics;
  const std::string text = with_uri("missing.bin").gltf();
  EXPECT_THROW(load_gltf(as_bytes(text), folder.path(), diagnostics), Error);
}

TEST(unit_io_gltf, data_uris_may_be_percent_encoded_and_unpadded) {
  Builder b = triangle();
  std::string escaped = "data:application/gltf-buffer,";
  for (const std::byte byte : b.binary) {
    static constexpr char digits[] = "0123456789abcdef";
    const auto value = std::to_integer<unsigned>(byte);
    escaped += {'%', digits[value >> 4], digits[value & 15]};
  }
  b.root["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", escaped}}};
  EXPECT_EQ(load_text(b.root.dump()).scene.meshes.size(), 1u);
  std::string unpadded = base64(b.binary);
  while (unpadded.back() == '=') unpadded.pop_back();
  b.root["buffers"][0]["uri"] = "data:application/octet-stream;base64," + unpadded;
  EXPECT_EQ(load_text(b.root.dump()).scene.meshes.at(0).primitives.at(0).positions.size(), 3u);
}

TEST(unit_io_gltf, file_info_repeats_what_the_file_says) {
  Builder b = triangle();
  b.root["asset"] = {{"version", "2.0"}, {"generator", "hand"}, {"copyright", "nobody"}};
  b.root["extensionsUsed"] = {"KHR_materials_ior", "KHR_xmp_json_ld"};
  b.root["extensionsRequired"] = {"KHR_materials_ior"};
  b.root["animations"] = {json::object(), json::object()};
  Diagnostics diagnostics;
  FileInfo info;
  const auto bytes = b.glb();
  load_gltf(bytes, {}, diagnostics, LoadOptions(), &info);
  EXPECT_EQ(info.generator, "hand");
  EXPECT_EQ(info.copyright, "nobody");
  EXPECT_EQ(info.version, "2.0");
  EXPECT_EQ(info.extensions_used, (std::vector<std::string>{"KHR_materials_ior", "KHR_xmp_json_ld"}));
  EXPECT_TRUE(info.extensions_ignored.empty());
  EXPECT_EQ(info.extensions_required, (std::vector<std::string>{"KHR_materials_ior"}));
  EXPECT_EQ(info.animations.size(), 2u);
  EXPECT_EQ(info.skins, 0);
  EXPECT_EQ(info.file_bytes, bytes.size());
}

TEST(unit_io_gltf, extensions_are_refused_ignored_or_silent) {
  Builder b = triangle();
  b.root["extensionsUsed"] = {"VENDOR_sky", "KHR_texture_transform", "VENDOR_sky"};
  b.root["scenes"][0]["extensions"]["VENDOR_sky"] = {{"light", 0}};
  const Loaded loaded = load(b);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_EQ(loaded.warnings[0].message, "VENDOR_sky is not supported and will be ignored");
  EXPECT_TRUE(loaded.notes.empty());
  b.root["extensionsRequired"] = {"VENDOR_geometry"};
  EXPECT_THAT(error_of(b), HasSubstr("requires VENDOR_geometry"));
  b.root["extensionsRequired"] = {"KHR_mesh_quantization", "KHR_xmp_json_ld"};
  EXPECT_EQ(error_of(b), "loaded");
}

TEST(unit_io_gltf, extension_data_that_changes_no_pixel_is_a_note) {
  // Known to be unseen; or never heard of, but about the asset as a whole.
  for (const char* name : {"KHR_xmp_json_ld", "KHR_physics_rigid_bodies", "OMI_seat", "MSFT_audio_emitter",
                           "EXT_structural_metadata", "MSFT_texture_dds"}) {
    Builder b = triangle();
    b.root["extensionsUsed"] = {name};
    b.root["nodes"][0]["extensions"][name] = json::object();
    const Loaded loaded = load(b);
    EXPECT_TRUE(loaded.warnings.empty()) << name;
    EXPECT_TRUE(loaded.noted(std::string(name) + " changes no pixel")) << name;
  }
  Builder b = triangle();
  b.root["extensionsUsed"] = {"ACME_catalogue", "ACME_shade"};
  b.root["asset"]["extensions"]["ACME_catalogue"] = {{"number", 7}};
  b.root["meshes"][0]["extensions"]["ACME_shade"] = {{"pattern", "dots"}};
  const Loaded loaded = load(b);
  EXPECT_EQ(loaded.notes.size(), 1u);
  EXPECT_TRUE(loaded.noted("ACME_catalogue changes no pixel"));
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_TRUE(loaded.warned("ACME_shade is not supported and will be ignored"));

  // Required, it still changes nothing; what nobody knows may.
  b.root["extensionsRequired"] = {"KHR_physics_rigid_bodies"};
  EXPECT_EQ(error_of(b), "loaded");
  b.root["extensionsRequired"] = {"ACME_catalogue"};
  EXPECT_THAT(error_of(b), HasSubstr("requires ACME_catalogue"));
  b.root["extensionsRequired"] = {"MSFT_texture_dds"};
  EXPECT_THAT(error_of(b), HasSubstr("requires MSFT_texture_dds"));
}

TEST(unit_io_gltf, a_key_given_twice_is_told_and_the_last_one_counts) {
  const std::string before = R"({"asset":{"version":"2.0"},"nodes":[{"translation":[1,0,0]},{"translation":[2,0,0],)";
  const Loaded twice = load_text(before + R"("name":"a","translation":[3,0,0]}]})");
  ASSERT_EQ(twice.warnings.size(), 1u);
  EXPECT_EQ(twice.warnings[0].text(),
            "glTF in memory#/nodes/1/translation: the key 'translation' is given twice; the last one counts");
  EXPECT_EQ(vec3(twice.scene.nodes.at(1).world_from_node[3]), vec3(3, 0, 0));
  EXPECT_TRUE(load_text(before + R"("name":"translation"}]})").warnings.empty());
  // In extras too, and of the whole document.
  EXPECT_TRUE(
      load_text(R"({"asset":{"version":"2.0"},"extras":{"a/b":[[{"c":1,"c":2}]]}})").warned("#/extras/a~1b/0/0/c"));
  EXPECT_TRUE(load_text(R"({"nodes":[],"asset":{"version":"2.0"},"nodes":[{}]})").warned("#/nodes: the key"));
  std::string many = R"({"asset":{"version":"2.0"},"extras":{"a":0)";
  for (int i = 0; i < 1000; ++i) many += R"(,"a":0)";
  EXPECT_LE(load_text(many + "}}").warnings.size(), 10u) << "a bad file does not fill the screen";
}

TEST(unit_io_gltf, a_buffer_that_nothing_defines_is_read_as_zeros) {
  // glTF 2.0 §5.10.1: without a uri it is for others to say what a buffer holds.
  Builder b = triangle();
  b.root["buffers"] = {{{"byteLength", b.binary.size()}}};
  const Loaded loaded = load_text(b.root.dump());
  EXPECT_TRUE(loaded.warned("#/buffers/0: the buffer has neither a uri nor data in the file"));
  EXPECT_TRUE(loaded.scene.meshes.at(0).primitives.empty());
  // One that nothing uses is nobody's business.
  Builder unused = triangle();
  unused.root["buffers"] = {{{"byteLength", unused.binary.size()}}, {{"byteLength", 9}}};
  EXPECT_TRUE(load(unused).warnings.empty());
  // A GLB without its binary chunk has lost it.
  Builder lost = triangle();
  lost.root["buffers"] = {{{"byteLength", lost.binary.size()}}};
  lost.binary.clear();
  EXPECT_THAT(error_of(lost), HasSubstr("neither a uri nor a GLB binary chunk"));
}

TEST(unit_io_gltf, errors_start_with_file_and_pointer) {
  Builder b = triangle();
  primitive(b)["attributes"]["POSITION"] = 7;
  EXPECT_EQ(error_of(b),
            "glTF in memory#/meshes/0/primitives/0/attributes/POSITION: accessor 7 does not exist (there are 4)");
  const TemporaryFolder folder("gltf_where");
  write_file(folder.path() / "x.glb", b.glb());
  Diagnostics diagnostics;
  try {
    load_gltf(folder.path() / "x.glb", diagnostics);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), (folder.path() / "x.glb").string() + "#/meshes/0/primitives/0/attributes/POSITION");
  }
}

}  // namespace
}  // namespace candela::io::test
