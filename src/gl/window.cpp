#include "gl/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <utility>

#include "base/error.h"

namespace candela::gl {

namespace {

/// GLFW, looked for when a window is opened: it needs the libraries of X11, which a machine that only renders has not.
class Glfw {
 public:
  static const Glfw& get() {
    static const Glfw glfw;
    return glfw;
  }

 private:
  template <class Function>
  Function find(const char* name) const {
    void* found = dlsym(library_, name);
    if (found == nullptr) throw Error(std::string("GLFW's library has no ") + name);
    return reinterpret_cast<Function>(found);
  }
  static void* open() {
    // Of the version that the header is of; it stays open, as the driver that it loads does.
    void* library = dlopen("libglfw.so.3", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      throw Error(std::string("windows need GLFW, which cannot be loaded (Debian's package libglfw3): ") + dlerror());
    }
    return library;
  }

  void* library_ = open();

 public:
  decltype(&::glfwCreateWindow) create_window = find<decltype(&::glfwCreateWindow)>("glfwCreateWindow");
  decltype(&::glfwDestroyWindow) destroy_window = find<decltype(&::glfwDestroyWindow)>("glfwDestroyWindow");
  decltype(&::glfwGetClipboardString) get_clipboard_string =
      find<decltype(&::glfwGetClipboardString)>("glfwGetClipboardString");
  decltype(&::glfwGetCursorPos) get_cursor_pos = find<decltype(&::glfwGetCursorPos)>("glfwGetCursorPos");
  decltype(&::glfwGetError) get_error = find<decltype(&::glfwGetError)>("glfwGetError");
  decltype(&::glfwGetFramebufferSize) get_framebuffer_size =
      find<decltype(&::glfwGetFramebufferSize)>("glfwGetFramebufferSize");
  decltype(&::glfwGetKey) get_key = find<decltype(&::glfwGetKey)>("glfwGetKey");
  decltype(&::glfwGetWindowContentScale) get_window_content_scale =
      find<decltype(&::glfwGetWindowContentScale)>("glfwGetWindowContentScale");
  decltype(&::glfwGetWindowSize) get_window_size = find<decltype(&::glfwGetWindowSize)>("glfwGetWindowSize");
  decltype(&::glfwGetWindowUserPointer) get_window_user_pointer =
      find<decltype(&::glfwGetWindowUserPointer)>("glfwGetWindowUserPointer");
  decltype(&::glfwHideWindow) hide_window = find<decltype(&::glfwHideWindow)>("glfwHideWindow");
  decltype(&::glfwInit) init = find<decltype(&::glfwInit)>("glfwInit");
  decltype(&::glfwMakeContextCurrent) make_context_current =
      find<decltype(&::glfwMakeContextCurrent)>("glfwMakeContextCurrent");
  decltype(&::glfwPostEmptyEvent) post_empty_event = find<decltype(&::glfwPostEmptyEvent)>("glfwPostEmptyEvent");
  decltype(&::glfwSetCharCallback) set_char_callback = find<decltype(&::glfwSetCharCallback)>("glfwSetCharCallback");
  decltype(&::glfwSetClipboardString) set_clipboard_string =
      find<decltype(&::glfwSetClipboardString)>("glfwSetClipboardString");
  decltype(&::glfwSetCursorPosCallback) set_cursor_pos_callback =
      find<decltype(&::glfwSetCursorPosCallback)>("glfwSetCursorPosCallback");
  decltype(&::glfwSetDropCallback) set_drop_callback = find<decltype(&::glfwSetDropCallback)>("glfwSetDropCallback");
  decltype(&::glfwSetFramebufferSizeCallback) set_framebuffer_size_callback =
      find<decltype(&::glfwSetFramebufferSizeCallback)>("glfwSetFramebufferSizeCallback");
  decltype(&::glfwSetKeyCallback) set_key_callback = find<decltype(&::glfwSetKeyCallback)>("glfwSetKeyCallback");
  decltype(&::glfwSetMouseButtonCallback) set_mouse_button_callback =
      find<decltype(&::glfwSetMouseButtonCallback)>("glfwSetMouseButtonCallback");
  decltype(&::glfwSetScrollCallback) set_scroll_callback =
      find<decltype(&::glfwSetScrollCallback)>("glfwSetScrollCallback");
  decltype(&::glfwSetWindowFocusCallback) set_window_focus_callback =
      find<decltype(&::glfwSetWindowFocusCallback)>("glfwSetWindowFocusCallback");
  decltype(&::glfwSetWindowRefreshCallback) set_window_refresh_callback =
      find<decltype(&::glfwSetWindowRefreshCallback)>("glfwSetWindowRefreshCallback");
  decltype(&::glfwSetWindowSize) set_window_size = find<decltype(&::glfwSetWindowSize)>("glfwSetWindowSize");
  decltype(&::glfwSetWindowTitle) set_window_title = find<decltype(&::glfwSetWindowTitle)>("glfwSetWindowTitle");
  decltype(&::glfwSetWindowUserPointer) set_window_user_pointer =
      find<decltype(&::glfwSetWindowUserPointer)>("glfwSetWindowUserPointer");
  decltype(&::glfwSwapBuffers) swap_buffers = find<decltype(&::glfwSwapBuffers)>("glfwSwapBuffers");
  decltype(&::glfwSwapInterval) swap_interval = find<decltype(&::glfwSwapInterval)>("glfwSwapInterval");
  decltype(&::glfwTerminate) terminate = find<decltype(&::glfwTerminate)>("glfwTerminate");
  decltype(&::glfwWaitEventsTimeout) wait_events_timeout =
      find<decltype(&::glfwWaitEventsTimeout)>("glfwWaitEventsTimeout");
  decltype(&::glfwWindowHint) window_hint = find<decltype(&::glfwWindowHint)>("glfwWindowHint");
  decltype(&::glfwWindowShouldClose) window_should_close =
      find<decltype(&::glfwWindowShouldClose)>("glfwWindowShouldClose");
};

std::string last_error() {
  const char* text = nullptr;
  return Glfw::get().get_error(&text) == GLFW_NO_ERROR || text == nullptr ? "no reason given" : text;
}

[[noreturn]] void fail(const std::string& what) {
  throw Error(what + " (" + last_error() + "); candela render --engine raster needs no display");
}

/// Whether the environment names a display. Libraries that look for one elsewhere print messages of their own.
bool has_display() {
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY") || is_set("WAYLAND_SOCKET");
}

constexpr std::array<std::pair<int, Key>, 15> kKeys{{{GLFW_KEY_ESCAPE, Key::escape},
                                                     {GLFW_KEY_ENTER, Key::enter},
                                                     {GLFW_KEY_KP_ENTER, Key::enter},
                                                     {GLFW_KEY_TAB, Key::tab},
                                                     {GLFW_KEY_BACKSPACE, Key::backspace},
                                                     {GLFW_KEY_INSERT, Key::insert},
                                                     {GLFW_KEY_DELETE, Key::del},
                                                     {GLFW_KEY_RIGHT, Key::right},
                                                     {GLFW_KEY_LEFT, Key::left},
                                                     {GLFW_KEY_DOWN, Key::down},
                                                     {GLFW_KEY_UP, Key::up},
                                                     {GLFW_KEY_PAGE_UP, Key::page_up},
                                                     {GLFW_KEY_PAGE_DOWN, Key::page_down},
                                                     {GLFW_KEY_HOME, Key::home},
                                                     {GLFW_KEY_END, Key::end}}};

Key key_of(int key) {
  // GLFW calls printable keys by their character.
  if (key >= GLFW_KEY_SPACE && key <= GLFW_KEY_GRAVE_ACCENT) return static_cast<Key>(key);
  const auto* found = std::find_if(kKeys.begin(), kKeys.end(), [key](const auto& row) { return row.first == key; });
  return found == kKeys.end() ? Key::none : found->second;
}

std::optional<MouseButton> button_of(int button) {
  if (button == GLFW_MOUSE_BUTTON_LEFT) return MouseButton::left;
  if (button == GLFW_MOUSE_BUTTON_RIGHT) return MouseButton::right;
  if (button == GLFW_MOUSE_BUTTON_MIDDLE) return MouseButton::middle;
  return std::nullopt;
}

Modifiers modifiers_of(GLFWwindow* window) {
  const auto is_down = [window](int a, int b) {
    return Glfw::get().get_key(window, a) == GLFW_PRESS || Glfw::get().get_key(window, b) == GLFW_PRESS;
  };
  return {.shift = is_down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT),
          .control = is_down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL),
          .alt = is_down(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT)};
}

/// The pointer counts in units of the desktop, of which a pixel may be a part.
vec2 in_pixels(GLFWwindow* window, double x, double y) {
  ivec2 pixels(1), units(1);
  Glfw::get().get_framebuffer_size(window, &pixels.x, &pixels.y);
  Glfw::get().get_window_size(window, &units.x, &units.y);
  return vec2(x, y) * vec2(pixels) / vec2(glm::max(units, ivec2(1)));
}

}  // namespace

/// What GLFW calls while it waits for events.
struct Window::Callbacks {
  static void add(GLFWwindow* window, WindowEvent event) {
    event.modifiers = modifiers_of(window);
    static_cast<Window*>(Glfw::get().get_window_user_pointer(window))->events_.push_back(std::move(event));
  }
  static vec2 pointer(GLFWwindow* window) {
    double x = 0.0, y = 0.0;
    Glfw::get().get_cursor_pos(window, &x, &y);
    return in_pixels(window, x, y);
  }
  static void moved(GLFWwindow* window, double x, double y) {
    add(window, {.kind = WindowEvent::Kind::pointer, .position = in_pixels(window, x, y)});
  }
  static void pressed(GLFWwindow* window, int button, int action, int) {
    const std::optional<MouseButton> which = button_of(button);
    if (!which) return;
    add(window, {.kind = WindowEvent::Kind::button,
                 .position = pointer(window),
                 .button = *which,
                 .is_down = action == GLFW_PRESS});
  }
  static void scrolled(GLFWwindow* window, double x, double y) {
    add(window, {.kind = WindowEvent::Kind::scroll, .position = pointer(window), .scroll = vec2(x, y)});
  }
  static void keyed(GLFWwindow* window, int key, int, int action, int) {
    add(window, {.kind = WindowEvent::Kind::key,
                 .is_down = action != GLFW_RELEASE,
                 .is_repeat = action == GLFW_REPEAT,
                 .key = key_of(key)});
  }
  static void typed(GLFWwindow* window, unsigned character) {
    add(window, {.kind = WindowEvent::Kind::text, .character = character});
  }
  static void dropped(GLFWwindow* window, int count, const char** paths) {
    add(window, {.kind = WindowEvent::Kind::drop, .position = pointer(window), .files = {paths, paths + count}});
  }
  static void focused(GLFWwindow* window, int has_it) {
    add(window, {.kind = WindowEvent::Kind::focus, .is_down = has_it == GLFW_TRUE});
  }
  static void resized(GLFWwindow* window, int, int) { add(window, {.kind = WindowEvent::Kind::changed}); }
  static void uncovered(GLFWwindow* window) { add(window, {.kind = WindowEvent::Kind::changed}); }
};

void Window::Deleter::operator()(GLFWwindow* window) const {
  Glfw::get().destroy_window(window);
  Glfw::get().terminate();
}

Window::Window(const std::string& title, ivec2 size) {
  if (!has_display()) throw Error("cannot open a window: no display; candela render --engine raster needs no display");
  if (Glfw::get().init() == GLFW_FALSE) fail("cannot open a window: no display");
  Glfw::get().window_hint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
  Glfw::get().window_hint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  Glfw::get().window_hint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  Glfw::get().window_hint(GLFW_CONTEXT_VERSION_MINOR, 0);
  GLFWwindow* window = Glfw::get().create_window(size.x, size.y, title.c_str(), nullptr, nullptr);
  if (window == nullptr) {
    const std::string reason = last_error();
    Glfw::get().terminate();
    throw Error("cannot open a window with OpenGL ES 3.0 (" + reason + ")");
  }
  window_.reset(window);
  Glfw::get().make_context_current(window);
  Glfw::get().swap_interval(1);
  Glfw::get().set_window_user_pointer(window, this);
  Glfw::get().set_cursor_pos_callback(window, Callbacks::moved);
  Glfw::get().set_mouse_button_callback(window, Callbacks::pressed);
  Glfw::get().set_scroll_callback(window, Callbacks::scrolled);
  Glfw::get().set_key_callback(window, Callbacks::keyed);
  Glfw::get().set_char_callback(window, Callbacks::typed);
  Glfw::get().set_drop_callback(window, Callbacks::dropped);
  Glfw::get().set_window_focus_callback(window, Callbacks::focused);
  Glfw::get().set_framebuffer_size_callback(window, Callbacks::resized);
  Glfw::get().set_window_refresh_callback(window, Callbacks::uncovered);
}

Window::~Window() = default;

std::vector<WindowEvent> Window::wait(double seconds) {
  Glfw::get().wait_events_timeout(std::max(seconds, 1e-4));  // GLFW refuses 0
  return std::exchange(events_, {});
}

void Window::wake() { Glfw::get().post_empty_event(); }

bool Window::wants_to_close() const { return Glfw::get().window_should_close(window_.get()) == GLFW_TRUE; }

ivec2 Window::size() const {
  ivec2 size(0);
  Glfw::get().get_framebuffer_size(window_.get(), &size.x, &size.y);
  return size;
}

void Window::resize(ivec2 size) {
  ivec2 pixels(1), units(1);
  Glfw::get().get_framebuffer_size(window_.get(), &pixels.x, &pixels.y);
  Glfw::get().get_window_size(window_.get(), &units.x, &units.y);
  const vec2 wanted = vec2(size) * vec2(units) / vec2(glm::max(pixels, ivec2(1)));
  Glfw::get().set_window_size(window_.get(), static_cast<int>(wanted.x), static_cast<int>(wanted.y));
}

void Window::hide() { Glfw::get().hide_window(window_.get()); }

float Window::scale() const {
  vec2 scale(1.0f);
  Glfw::get().get_window_content_scale(window_.get(), &scale.x, &scale.y);
  return std::clamp(scale.x, 1.0f, 4.0f);
}

void Window::swap() { Glfw::get().swap_buffers(window_.get()); }

void Window::set_title(const std::string& title) { Glfw::get().set_window_title(window_.get(), title.c_str()); }

std::string Window::clipboard() const {
  const char* text = Glfw::get().get_clipboard_string(window_.get());
  return text == nullptr ? "" : text;
}

void Window::set_clipboard(const std::string& text) { Glfw::get().set_clipboard_string(window_.get(), text.c_str()); }

}  // namespace candela::gl
