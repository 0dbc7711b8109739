#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "gl/gl.h"

namespace candela::test {

/// Mesa's software driver unless the environment says LIBGL_ALWAYS_SOFTWARE=0: pictures are then the same everywhere.
inline void prefer_software() {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
  // Every context of a test compiles the same shaders again.
  setenv("MESA_SHADER_CACHE_DIR", (std::filesystem::temp_directory_path() / "candela-test-shaders").c_str(), 0);
}

/// Skips where there is no OpenGL.
class NeedsGl : public testing::Test {
 protected:
  void SetUp() override {
    prefer_software();
    try {
      gl::Context::open();
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
  }
};

}  // namespace candela::test
