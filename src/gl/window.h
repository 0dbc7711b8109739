#pragma once

#include <memory>
#include <string>
#include <vector>

#include "math/types.h"

struct GLFWwindow;

namespace candela::gl {

/// Keys by what stands on them on a US keyboard: printable ones are their ASCII character, letters are capitals.
enum class Key : int {
  none = 0,
  space = ' ',
  // ----- those without a character
  escape = 256,
  enter,
  tab,
  backspace,
  insert,
  del,
  right,
  left,
  down,
  up,
  page_up,
  page_down,
  home,
  end
};

enum class MouseButton { left, right, middle };

/// What is held down besides.
struct Modifiers {
  bool shift = false, control = false, alt = false;
};

/// Something that happened to a window.
struct WindowEvent {
  enum class Kind {
    pointer,  ///< it is at `position`
    button,   ///< `button` went down or up
    scroll,   ///< by `scroll` notches, away from the user is positive
    key,      ///< `key` went down (again while it is held) or up
    text,     ///< `character` was typed
    drop,     ///< `files` were dropped
    focus,    ///< it has the keyboard, or lost it
    changed   ///< its size, or what it shows has to be drawn again
  };
  Kind kind = Kind::changed;
  vec2 position{0.0f};  ///< pixels from the upper left corner
  MouseButton button = MouseButton::left;
  bool is_down = false;  ///< of a button, a key, the focus
  bool is_repeat = false;
  vec2 scroll{0.0f};
  Key key = Key::none;
  Modifiers modifiers = {};
  unsigned character = 0;  ///< Unicode
  std::vector<std::string> files = {};
};

/// A window with an OpenGL ES 3.0 context that is current on the thread that opened it. One at a time, on the main
/// thread, but for wake().
class Window {
 public:
  /// Throws Error where there is no display or no OpenGL for it.
  Window(const std::string& title, ivec2 size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// What happened since the last call; where nothing has, it waits for that, or for wake(), at most so long.
  std::vector<WindowEvent> wait(double seconds);
  /// Ends a wait(), from any thread, while there is a window.
  static void wake();
  bool wants_to_close() const;

  /// Pixels to draw into; 0 while it is minimised.
  ivec2 size() const;
  void resize(ivec2 size);
  /// It is gone from the screen, before whatever ends takes its time.
  void hide();
  /// How much larger than usual text has to be.
  float scale() const;
  /// Shows what was drawn.
  void swap();
  void set_title(const std::string& title);
  std::string clipboard() const;
  void set_clipboard(const std::string& text);

 private:
  struct Callbacks;
  struct Deleter {
    void operator()(GLFWwindow* window) const;
  };
  std::unique_ptr<GLFWwindow, Deleter> window_;
  std::vector<WindowEvent> events_;
};

}  // namespace candela::gl
