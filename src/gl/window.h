#pragma once

#include <memory>
#include <string>

#include "math/types.h"

struct GLFWwindow;

namespace candela::gl {

/// A window with an OpenGL ES 3.0 context that is current on the thread that opened it. One at a time.
class Window {
 public:
  /// Throws Error where there is no display or no OpenGL for it.
  Window(const std::string& title, ivec2 size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// What happened since the last call.
  struct Input {
    vec2 drag{0.0f};      ///< pixels that the pointer moved with its left button down, y down
    float scroll = 0.0f;  ///< notches, away from the user is positive
    std::string keys;     ///< capital letters and ' ' that were pressed, in their order
    bool wants_to_close = false;
  };
  Input poll();

  /// Pixels to draw into; 0 while it is minimised.
  ivec2 size() const;
  /// Shows what was drawn.
  void swap();
  void set_title(const std::string& title);

 private:
  struct Deleter {
    void operator()(GLFWwindow* window) const;
  };
  std::unique_ptr<GLFWwindow, Deleter> window_;
  Input input_;
  vec2 pointer_{0.0f};
};

}  // namespace candela::gl
