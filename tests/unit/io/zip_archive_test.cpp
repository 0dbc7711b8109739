#include "io/zip_archive.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>

#include "base/error.h"
#include "base/file.h"
#include "unit/base/temp_folder.h"
#include "unit/io/gltf_builder.h"
#include "unit/io/zip_builder.h"

namespace candela::io {
namespace {

using test::as_bytes;
using test::zip_of;
using Bytes = std::vector<std::byte>;

Bytes bytes(const std::string& text) {
  const auto view = as_bytes(text);
  return {view.begin(), view.end()};
}

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(unit_io_zip_archive, files_come_as_they_went_in_from_disk_and_from_memory) {
  const Bytes long_text(200000, std::byte{7});
  const Bytes data = zip_of({{"a/b.bin", long_text}, {"c", bytes("short")}, {"empty", {}}});
  const candela::test::TempFolder folder;
  write_file(folder / "a.any", std::span<const std::byte>(data));
  EXPECT_TRUE(is_zip(folder / "a.any"));
  const ZipArchive disk(folder / "a.any"), memory(data, "memory");
  for (const ZipArchive* archive : {&disk, &memory}) {
    EXPECT_EQ(archive->names(), (std::vector<std::string>{"a/b.bin", "c", "empty"}));
    EXPECT_EQ(archive->read("a/b.bin"), long_text);
    EXPECT_EQ(archive->read("c"), bytes("short"));
    EXPECT_TRUE(archive->read("empty").empty());
    EXPECT_EQ(archive->read_head("c", 2), bytes("sh"));
    EXPECT_EQ(archive->read_head("c", 200), bytes("short"));
    EXPECT_FALSE(archive->contains("d"));
    EXPECT_NE(error_of([&] { archive->read("d"); }).find(archive->label() + ":d: no such file"), std::string::npos);
  }
}

TEST(unit_io_zip_archive, what_is_no_file_of_the_scene_has_no_name) {
  const ZipArchive archive(zip_of({{"a/", {}}, {"__MACOSX/a", {}}, {"a/._b", {}}, {"./c", {}}, {"d\\e", {}}}), "z");
  EXPECT_EQ(archive.names(), (std::vector<std::string>{"c", "d/e"}));
}

TEST(unit_io_zip_archive, names_that_leave_are_refused) {
  for (const char* name : {"../a", "a/../../b", "/a", "..", "a\\..\\..\\b", "C:/a"}) {
    EXPECT_NE(error_of([&] {
                ZipArchive(zip_of({{name, {}}}), "z");
              }).find("leads out of the archive"),
              std::string::npos)
        << name;
  }
  EXPECT_EQ(error_of([&] { ZipArchive(zip_of({{"a..b/..c", {}}}), "z"); }), "no error");
}

TEST(unit_io_zip_archive, all_files_together_have_a_limit) {
  std::map<std::string, Bytes> files;
  for (int i = 0; i < 6; ++i) files[std::to_string(i)] = Bytes(std::size_t{20} << 20);
  const Bytes data = zip_of(files);
  ASSERT_LT(data.size(), 500000u);
  const ZipArchive archive(data, "z");
  // 64 MiB and a hundred times about 120 kB: three of them, not six, and one of them as often as one likes.
  for (int i = 0; i < 5; ++i) EXPECT_EQ(archive.read("0").size(), std::size_t{20} << 20);
  const std::string error = error_of([&] {
    for (const auto& file : files) archive.read(file.first);
  });
  EXPECT_NE(error.find("unpacks to more than"), std::string::npos) << error;
}

TEST(unit_io_zip_archive, a_size_that_is_not_true_is_an_error) {
  const Bytes data = zip_of({{"a", Bytes(100000)}});
  constexpr std::size_t kSizeInDirectory = 24;
  const std::string text(reinterpret_cast<const char*>(data.data()), data.size());
  const std::size_t at = text.rfind("PK\1\2") + kSizeInDirectory;
  for (const std::uint32_t claim : {0u, 1u, 99999u, 100001u, 50000000u, 0xfffffff0u}) {
    Bytes changed = data;
    std::memcpy(changed.data() + at, &claim, sizeof claim);
    EXPECT_NE(error_of([&] { ZipArchive(changed, "z").read("a"); }), "no error") << claim;
  }
}

TEST(unit_io_zip_archive, damage_gives_files_or_errors) {
  const Bytes data = zip_of({{"scene.gltf", bytes(test::triangle().gltf())}, {"a.bin", Bytes(3000)}});
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    Bytes changed = data;
    for (int flips = 0; flips <= i % 3; ++flips) {
      changed[random() % changed.size()] ^= static_cast<std::byte>(1 << random() % 8);
    }
    if (i % 5 == 0) changed.resize(random() % changed.size());
    error_of([&] {
      const ZipArchive archive(changed, "z");
      for (const std::string& name : archive.names()) archive.read(name);
    });
  }
}

TEST(unit_io_zip_archive, a_scene_in_memory_is_read_from_its_archive) {
  test::Builder b = test::triangle();
  const Bytes glb = b.glb();
  Diagnostics diagnostics;
  FileInfo info;
  const Scene scene = load_gltf(zip_of({{"x/y.glb", glb}}), {}, diagnostics, {}, &info);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(info.archive_entry, "x/y.glb");
  EXPECT_NE(test::error_of(zip_of({{"a.glb", glb}, {"b.glb", glb}})).find("holds 2 glTF files"), std::string::npos);
}

}  // namespace
}  // namespace candela::io
