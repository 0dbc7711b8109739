#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "gl/gl.h"

namespace candela::test {

/// Mesa's software driver unless the environment says LIBGL_ALWAYS_SOFTWARE=0: pictures are then the same everywhere.
inline void prefer_software() {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
  // Every context of a test compiles the same shaders again.
  setenv("MESA_SHADER_CACHE_DIR", (std::filesystem::temp_directory_path() / "candela-test-shaders").c_str(), 0);
}

/// Skips where there is no OpenGL; the context stays open for the test.
class WithGl : public testing::Test {
 protected:
  void SetUp() override {
    prefer_software();
    try {
      context_ = gl::Context::open();
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
  }

  std::unique_ptr<gl::Context> context_;
};

/// Skips likewise, for tests that open contexts of their own.
class NeedsGl : public WithGl {
 protected:
  void SetUp() override {
    WithGl::SetUp();
    context_.reset();
  }
};

}  // namespace candela::test
