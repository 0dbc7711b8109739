#include "gl/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>
#include <utility>

#include "base/error.h"

namespace candela::gl {

namespace {

std::string last_error() {
  const char* text = nullptr;
  return glfwGetError(&text) == GLFW_NO_ERROR || text == nullptr ? "no reason given" : text;
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
  glfwDestroyWindow(window);
  glfwTerminate();
}

Window::Window(const std::string& title, ivec2 size) {
  if (!has_display()) throw Error("cannot open a window: no display; candela render --engine raster needs no display");
  if (glfwInit() == GLFW_FALSE) fail("cannot open a window: no display");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 0);
  GLFWwindow* window = glfwCreateWindow(size.x, size.y, title.c_str(), nullptr, nullptr);
  if (window == nullptr) {
    const std::string reason = last_error();
    glfwTerminate();
    throw Error("cannot open a window with OpenGL ES 3.0 (" + reason + ")");
  }
  window_.reset(window);
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window, this);
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) {
    static_cast<Window*>(glfwGetWindowUserPointer(w))->input_.scroll += static_cast<float>(y);
  });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    const bool is_named = key == GLFW_KEY_SPACE || (key >= GLFW_KEY_A && key <= GLFW_KEY_Z);
    auto* self = static_cast<Window*>(glfwGetWindowUserPointer(w));
    if (action == GLFW_PRESS && is_named) self->input_.keys += static_cast<char>(key);
    if (action == GLFW_PRESS && key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(w, GLFW_TRUE);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    auto* self = static_cast<Window*>(glfwGetWindowUserPointer(w));
    const vec2 now(static_cast<float>(x), static_cast<float>(y));
    if (glfwGetMouseButton(w, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) self->input_.drag += now - self->pointer_;
    self->pointer_ = now;
  });
}

Window::~Window() = default;

Window::Input Window::poll() {
  glfwPollEvents();
  Input input = std::exchange(input_, {});
  input.wants_to_close = glfwWindowShouldClose(window_.get()) == GLFW_TRUE;
  return input;
}

ivec2 Window::size() const {
  ivec2 size(0);
  glfwGetFramebufferSize(window_.get(), &size.x, &size.y);
  return size;
}

void Window::swap() { glfwSwapBuffers(window_.get()); }

void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_.get(), title.c_str()); }

}  // namespace candela::gl
