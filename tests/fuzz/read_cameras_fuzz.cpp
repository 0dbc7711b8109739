#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "io/camera_file.h"

/// Any text: an Error, or cameras that can be looked through and written again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  constexpr ivec2 kSize{640, 480};
  try {
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    for (const PosedCamera& camera : io::parse_cameras(text, "fuzz", kSize)) {
      for (int c = 0; c < 4; ++c) {
        for (int row = 0; row < 4; ++row) {
          if (!std::isfinite(camera.view.world_from_camera[c][row])) std::abort();
        }
      }
      matrix_of_view(camera.view, camera.size.value_or(kSize));
    }
  } catch (const Error&) {
  }
  return 0;
}
