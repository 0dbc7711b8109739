#pragma once

#include <map>
#include <memory>
#include <vector>

#include "gl/gl.h"
#include "gl/window.h"
#include "image/develop.h"

struct ImGuiContext;

namespace candela::viewer {

/// A picture with the driver, for ImGui to show.
class GuiPicture {
 public:
  void set(const DisplayImage& image);
  bool empty() const { return size_.x == 0; }
  ivec2 size() const { return size_; }
  /// What ImGui calls it; void* of its versions here.
  void* id() const;

 private:
  gl::Texture texture_;
  ivec2 size_{0};
};

/// Dear ImGui on OpenGL ES 3.0 and a gl::Window: what happens to the window goes in, what ImGui drew comes out. (Its
/// own backends are for desktop OpenGL and for a GLFW that is linked.)
class Gui {
 public:
  explicit Gui(gl::Window& window);
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  void add(const gl::WindowEvent& event);
  /// Whether ImGui takes what the pointer, or the keyboard, does for its own.
  bool wants_pointer() const;
  bool wants_keyboard() const;

  /// ImGui's functions may be called from here on until draw().
  void begin(ivec2 size, double seconds);
  /// Draws into the window's framebuffer of that size.
  void draw(ivec2 size);
  /// What the window's framebuffer shows.
  static DisplayImage read(ivec2 size);

 private:
  void upload_font();

  ImGuiContext* context_;
  std::unique_ptr<gl::Program> program_;
  GuiPicture font_;
  gl::Buffer vertices_, indices_;
  gl::VertexArray attributes_;
};

}  // namespace candela::viewer
