#include "base/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "base/error.h"
#include "unit/base/temp_folder.h"

namespace candela {
namespace {

using test::FullDisk;
using test::TempFolder;

std::string text_of(const std::filesystem::path& path) {
  std::string text;
  for (const std::byte b : read_file(path)) text.push_back(static_cast<char>(b));
  return text;
}

TEST(unit_base_file, commit_makes_the_file_appear_whole) {
  const TempFolder folder;
  const auto target = folder / "picture.png";
  {
    AtomicFile file(target);
    std::ofstream(file.temp_path()) << "whole";
    EXPECT_FALSE(exists(target));
    EXPECT_EQ(file.temp_path().extension(), ".png");
    EXPECT_EQ(file.temp_path().parent_path(), folder.path());
    file.commit();
  }
  EXPECT_EQ(text_of(target), "whole");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(unit_base_file, nothing_is_left_after_an_exception) {
  const TempFolder folder;
  try {
    AtomicFile file(folder / "picture.png");
    std::ofstream(file.temp_path()) << "half";
    throw 1;
  } catch (int) {
  }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(unit_base_file, an_uncommitted_file_leaves_the_old_one_alone) {
  const TempFolder folder;
  const auto target = folder / "a.txt";
  write_file(target, std::string("old"));
  {
    AtomicFile file(target);
    std::ofstream(file.temp_path()) << "new";
  }
  EXPECT_EQ(text_of(target), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(unit_base_file, writing_replaces_the_old_file) {
  const TempFolder folder;
  write_file(folder / "a.txt", std::string("a longer old text"));
  write_file(folder / "a.txt", std::string("new"));
  EXPECT_EQ(text_of(folder / "a.txt"), "new");
}

TEST(unit_base_file, writing_follows_the_umask) {
  const TempFolder folder;
  const mode_t before = umask(022);
  write_file(folder / "a.txt", std::string("x"));
  umask(before);
  EXPECT_EQ(static_cast<int>(std::filesystem::status(folder / "a.txt").permissions()), 0644);
}

TEST(unit_base_file, a_missing_folder_is_an_error_that_names_the_target) {
  const TempFolder folder;
  try {
    write_file(folder / "missing" / "a.txt", std::string("x"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), (folder / "missing" / "a.txt").string());
  }
}

TEST(unit_base_file, a_folder_is_no_target) {
  const TempFolder folder;
  create_directory(folder / "taken");
  EXPECT_THROW(AtomicFile{folder / "taken"}, Error);
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(unit_base_file, a_full_disk_is_an_error_and_leaves_no_file) {
  const TempFolder folder;
  write_file(folder / "a.txt", std::string("old"));
  const std::string large(1 << 20, 'x');
  {
    const FullDisk full(4096);
    EXPECT_THROW(write_file(folder / "a.txt", large), Error);
    EXPECT_THROW(write_file(folder / "b.txt", large), Error);
  }
  EXPECT_EQ(text_of(folder / "a.txt"), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(unit_base_file, reading_returns_every_byte) {
  const TempFolder folder;
  std::string all;
  for (int i = 0; i < 1000; ++i) all.push_back(static_cast<char>(i * 37));
  write_file(folder / "a.bin", all);
  EXPECT_EQ(text_of(folder / "a.bin"), all);
  write_file(folder / "empty", std::string());
  EXPECT_TRUE(read_file(folder / "empty").empty());
}

TEST(unit_base_file, what_is_no_readable_file_is_an_error_that_names_it) {
  const TempFolder folder;
  write_file(folder / "a.bin", std::string(11, 'x'));
  EXPECT_EQ(read_file(folder / "a.bin", 11).size(), 11u);
  EXPECT_THROW(read_file(folder / "a.bin", 10), Error);
  EXPECT_THROW(read_file(folder.path()), Error);
  EXPECT_THROW(read_file("/dev/null"), Error);
  try {
    read_file(folder / "missing");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), (folder / "missing").string());
  }
}

TEST(unit_base_file, every_name_of_a_file_is_the_same_file) {
  namespace fs = std::filesystem;
  const TempFolder folder;
  write_file(folder / "a.png", std::string("a"));
  write_file(folder / "b.png", std::string("a"));
  fs::create_directory(folder / "sub");
  fs::create_hard_link(folder / "a.png", folder / "hard.png");
  fs::create_symlink("../a.png", folder / "sub" / "soft.png");
  fs::create_directory_symlink(".", folder / "here");
  const std::string a = file_identity(folder / "a.png");
  for (const char* name : {"./a.png", "sub/../a.png", "hard.png", "sub/soft.png", "here/a.png", "here/here/hard.png"}) {
    EXPECT_EQ(file_identity(folder / name), a) << name;
  }
  // Through folders that are made before the file is written.
  for (const char* name : {"new/../a.png", "new/deep/../../a.png", "sub/new/../../hard.png", "new/../sub/soft.png"}) {
    EXPECT_EQ(file_identity(folder / name), a) << name;
  }
  EXPECT_NE(file_identity(folder / "b.png"), a);
  // Of what is not there yet a name has to do, which some file systems do not tell from another case.
  const std::string absent = file_identity(folder / "new.png");
  EXPECT_NE(absent, a);
  for (const char* name : {"./new.png", "sub/../new.png", "here/new.png", "NEW.png"}) {
    EXPECT_EQ(file_identity(folder / name), absent) << name;
  }
  EXPECT_NE(file_identity(folder / "sub/new.png"), absent);
}

TEST(unit_base_file, a_fingerprint_tells_every_changed_byte) {
  std::vector<std::byte> bytes(61);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7);
  const std::uint64_t whole = fingerprint(bytes);
  EXPECT_EQ(fingerprint(bytes), whole);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] ^= std::byte{1};
    EXPECT_NE(fingerprint(bytes), whole) << i;
    bytes[i] ^= std::byte{1};
  }
  EXPECT_NE(fingerprint(std::span(bytes).first(60)), whole);
}

}  // namespace
}  // namespace candela
