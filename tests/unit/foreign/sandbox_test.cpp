#include "foreign/sandbox.h"

#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"

namespace candela::foreign {
namespace {

constexpr SandboxLimits kLimits{std::uint64_t{1} << 30, 20};

std::string told(const std::function<std::vector<std::byte>()>& work, const SandboxLimits& limits = kLimits) {
  try {
    run_apart(work, limits, "file");
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

[[noreturn]] void spin() {
  for (std::atomic<int> turns = 0;;) ++turns;
}

TEST(unit_foreign_sandbox, hands_back_what_the_work_made) {
  const std::vector<std::byte> large(3 << 20, std::byte{7});
  EXPECT_EQ(run_apart([&] { return std::vector<std::byte>(large); }, kLimits, "file"), large);
  EXPECT_TRUE(run_apart([] { return std::vector<std::byte>(); }, kLimits, "file").empty());
}

TEST(unit_foreign_sandbox, errors_and_crashes_of_the_work_are_errors_here) {
  EXPECT_EQ(told([]() -> std::vector<std::byte> { throw Error("broken"); }), "file: broken");
  EXPECT_EQ(told([]() -> std::vector<std::byte> { throw 1; }), "file: ");
  EXPECT_EQ(told([]() -> std::vector<std::byte> {
              std::raise(SIGSEGV);
              return {};
            }),
            "file: damaged: its reader ended by Segmentation fault");
}

TEST(unit_foreign_sandbox, work_that_does_not_end_is_ended) {
  EXPECT_EQ(told([]() -> std::vector<std::byte> { spin(); }, {std::uint64_t{1} << 30, 1}),
            "file: reading it takes too long or too much memory");
  std::atomic<bool> stop = false;
  const StopScope scope(&stop);
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stop = true;
  });
  EXPECT_THROW(run_apart([]() -> std::vector<std::byte> { spin(); }, kLimits, "file"), Interrupted);
  later.join();
}

}  // namespace
}  // namespace candela::foreign
