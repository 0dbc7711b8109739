#include "base/memory.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "unit/base/temp_folder.h"

namespace candela {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

constexpr std::uint64_t kKibi = 1024;
constexpr const char* kRoomy =
    "MemTotal: 16000000 kB\nMemFree: 1000000 kB\nMemAvailable:    8000000 kB\nSwapFree: 5 kB\n";

/// A machine in a folder: `proc` and `cgroup` as the kernel shows them.
class Machine {
 public:
  explicit Machine(const std::string& meminfo) { write("proc/meminfo", meminfo); }

  void write(const std::string& name, const std::string& text) const {
    const fs::path path = folder_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  std::optional<std::uint64_t> available() const { return available_memory(folder_ / "proc", folder_ / "cgroup"); }

 private:
  TempFolder folder_;
};

TEST(unit_base_memory, free_memory_is_what_can_be_had_and_swap) {
  EXPECT_EQ(Machine(kRoomy).available(), 8000005 * kKibi);
}

TEST(unit_base_memory, a_system_that_says_nothing_refuses_nothing) {
  const Machine machine("");
  EXPECT_FALSE(machine.available());
  machine.write("proc/meminfo", "MemAvailable: plenty\n");
  EXPECT_FALSE(machine.available());
  EXPECT_NO_THROW(require_memory(~std::uint64_t{0}, machine.available(), "all", "t"));
}

TEST(unit_base_memory, the_limit_of_a_group_counts_less_its_use_beside_the_file_cache) {
  const Machine machine(kRoomy);
  machine.write("proc/self/cgroup", "0::/user/render\n");
  machine.write("cgroup/user/render/memory.max", "max\n");
  machine.write("cgroup/user/render/memory.current", "500\n");
  EXPECT_EQ(machine.available(), 8000005 * kKibi);
  machine.write("cgroup/user/render/memory.max", "1000000\n");
  EXPECT_EQ(machine.available(), 999500U);
  machine.write("cgroup/user/render/memory.stat", "anon 100\nfile 400\ninactive_file 300\nactive_file 100\n");
  EXPECT_EQ(machine.available(), 999800U);
  // The group around it has less to give.
  machine.write("cgroup/user/memory.max", "700000");
  machine.write("cgroup/user/memory.current", "699000");
  EXPECT_EQ(machine.available(), 1000U);
  machine.write("cgroup/user/memory.current", "800000");
  EXPECT_EQ(machine.available(), 0U);
}

TEST(unit_base_memory, groups_of_version_1_count_too) {
  const Machine machine(kRoomy);
  machine.write("proc/self/cgroup", "5:cpu,cpuacct:/box\n4:memory:/box\n0::/\n");
  machine.write("cgroup/memory/box/memory.limit_in_bytes", "9223372036854771712\n");
  machine.write("cgroup/memory/box/memory.usage_in_bytes", "4096\n");
  EXPECT_EQ(machine.available(), 8000005 * kKibi);
  machine.write("cgroup/memory/box/memory.limit_in_bytes", "65536\n");
  EXPECT_EQ(machine.available(), 61440U);
  // A container that sees its own group as the root, under another name.
  machine.write("proc/self/cgroup", "4:memory:/elsewhere/box\n");
  machine.write("cgroup/memory/memory.limit_in_bytes", "32768\n");
  machine.write("cgroup/memory/memory.usage_in_bytes", "4096\n");
  EXPECT_EQ(machine.available(), 28672U);
}

TEST(unit_base_memory, more_than_there_is_is_refused_in_words) {
  constexpr std::uint64_t kGibi = std::uint64_t{1} << 30;
  EXPECT_NO_THROW(require_memory(kGibi, kGibi, "a picture", "--size"));
  try {
    require_memory(kGibi + kGibi / 2, kGibi, "a picture", "--size");
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "--size: a picture needs about 1.50 GiB of memory, 1.00 GiB are available");
  }
}

}  // namespace
}  // namespace candela
