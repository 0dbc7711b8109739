#include "gl/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <dlfcn.h>

#include <cstdlib>
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
  decltype(&::glfwGetError) get_error = find<decltype(&::glfwGetError)>("glfwGetError");
  decltype(&::glfwGetFramebufferSize) get_framebuffer_size =
      find<decltype(&::glfwGetFramebufferSize)>("glfwGetFramebufferSize");
  decltype(&::glfwGetMouseButton) get_mouse_button = find<decltype(&::glfwGetMouseButton)>("glfwGetMouseButton");
  decltype(&::glfwGetWindowUserPointer) get_window_user_pointer =
      find<decltype(&::glfwGetWindowUserPointer)>("glfwGetWindowUserPointer");
  decltype(&::glfwInit) init = find<decltype(&::glfwInit)>("glfwInit");
  decltype(&::glfwMakeContextCurrent) make_context_current =
      find<decltype(&::glfwMakeContextCurrent)>("glfwMakeContextCurrent");
  decltype(&::glfwPollEvents) poll_events = find<decltype(&::glfwPollEvents)>("glfwPollEvents");
  decltype(&::glfwSetCursorPosCallback) set_cursor_pos_callback =
      find<decltype(&::glfwSetCursorPosCallback)>("glfwSetCursorPosCallback");
  decltype(&::glfwSetKeyCallback) set_key_callback = find<decltype(&::glfwSetKeyCallback)>("glfwSetKeyCallback");
  decltype(&::glfwSetScrollCallback) set_scroll_callback =
      find<decltype(&::glfwSetScrollCallback)>("glfwSetScrollCallback");
  decltype(&::glfwSetWindowShouldClose) set_window_should_close =
      find<decltype(&::glfwSetWindowShouldClose)>("glfwSetWindowShouldClose");
  decltype(&::glfwSetWindowTitle) set_window_title = find<decltype(&::glfwSetWindowTitle)>("glfwSetWindowTitle");
  decltype(&::glfwSetWindowUserPointer) set_window_user_pointer =
      find<decltype(&::glfwSetWindowUserPointer)>("glfwSetWindowUserPointer");
  decltype(&::glfwSwapBuffers) swap_buffers = find<decltype(&::glfwSwapBuffers)>("glfwSwapBuffers");
  decltype(&::glfwSwapInterval) swap_interval = find<decltype(&::glfwSwapInterval)>("glfwSwapInterval");
  decltype(&::glfwTerminate) terminate = find<decltype(&::glfwTerminate)>("glfwTerminate");
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

}  // namespace

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
  Glfw::get().set_scroll_callback(window, [](GLFWwindow* w, double, double y) {
    static_cast<Window*>(Glfw::get().get_window_user_pointer(w))->input_.scroll += static_cast<float>(y);
  });
  Glfw::get().set_key_callback(window, [](GLFWwindow* w, int key, int, int action, int) {
    const bool is_named = key == GLFW_KEY_SPACE || (key >= GLFW_KEY_A && key <= GLFW_KEY_Z);
    auto* self = static_cast<Window*>(Glfw::get().get_window_user_pointer(w));
    if (action == GLFW_PRESS && is_named) self->input_.keys += static_cast<char>(key);
    if (action == GLFW_PRESS && key == GLFW_KEY_ESCAPE) Glfw::get().set_window_should_close(w, GLFW_TRUE);
  });
  Glfw::get().set_cursor_pos_callback(window, [](GLFWwindow* w, double x, double y) {
    auto* self = static_cast<Window*>(Glfw::get().get_window_user_pointer(w));
    const vec2 now(static_cast<float>(x), static_cast<float>(y));
    if (Glfw::get().get_mouse_button(w, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS)
      self->input_.drag += now - self->pointer_;
    self->pointer_ = now;
  });
}

Window::~Window() = default;

Window::Input Window::poll() {
  Glfw::get().poll_events();
  Input input = std::exchange(input_, {});
  input.wants_to_close = Glfw::get().window_should_close(window_.get()) == GLFW_TRUE;
  return input;
}

ivec2 Window::size() const {
  ivec2 size(0);
  Glfw::get().get_framebuffer_size(window_.get(), &size.x, &size.y);
  return size;
}

void Window::swap() { Glfw::get().swap_buffers(window_.get()); }

void Window::set_title(const std::string& title) { Glfw::get().set_window_title(window_.get(), title.c_str()); }

}  // namespace candela::gl
