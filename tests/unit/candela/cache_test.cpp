#include "candela/cache.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace candela {
namespace {

/// The variable as it was, once the test is over.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    const char* before = std::getenv(name);
    if (before != nullptr) before_ = before, was_set_ = true;
    if (value != nullptr) {
      ::setenv(name, value, 1);
    } else {
      ::unsetenv(name);
    }
  }
  ~Variable() {
    if (was_set_) {
      ::setenv(name_, before_.c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::string before_;
  bool was_set_ = false;
};

TEST(unit_candela_cache, is_where_the_environment_says_caches_are) {
  const Variable home("HOME", "/home/anna"), xdg("XDG_CACHE_HOME", "/var/cache/anna");
  EXPECT_EQ(cache_folder(), "/var/cache/anna/candela");
}

TEST(unit_candela_cache, is_below_home_without_one) {
  const Variable home("HOME", "/home/anna"), xdg("XDG_CACHE_HOME", nullptr);
  EXPECT_EQ(cache_folder(), "/home/anna/.cache/candela");
}

TEST(unit_candela_cache, a_place_relative_to_wherever_one_is_does_not_count) {
  const Variable home("HOME", "/home/anna"), xdg("XDG_CACHE_HOME", "cache");
  EXPECT_EQ(cache_folder(), "/home/anna/.cache/candela");
}

TEST(unit_candela_cache, is_nowhere_without_a_home) {
  const Variable home("HOME", nullptr), xdg("XDG_CACHE_HOME", nullptr);
  EXPECT_TRUE(cache_folder().empty());
}

}  // namespace
}  // namespace candela
