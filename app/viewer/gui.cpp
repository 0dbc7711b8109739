#include "viewer/gui.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "viewer/gui_font.h"

namespace candela::viewer {

namespace {

constexpr const char* kVertex = R"(#version 300 es
precision highp float;
uniform vec2 size;
layout(location = 0) in vec2 a_position;
layout(location = 1) in vec2 a_uv;
layout(location = 2) in vec4 a_color;
out vec2 v_uv;
out vec4 v_color;
void main() {
  v_uv = a_uv;
  v_color = a_color;
  gl_Position = vec4(2.0 * a_position.x / size.x - 1.0, 1.0 - 2.0 * a_position.y / size.y, 0.0, 1.0);
}
)";

constexpr const char* kFragment = R"(#version 300 es
precision mediump float;
uniform sampler2D picture;
in vec2 v_uv;
in vec4 v_color;
layout(location = 0) out vec4 o_color;
void main() { o_color = v_color * texture(picture, v_uv); }
)";

constexpr std::array<std::pair<gl::Key, ImGuiKey>, 21> kKeys{{
    {gl::Key::tab, ImGuiKey_Tab},
    {gl::Key::left, ImGuiKey_LeftArrow},
    {gl::Key::right, ImGuiKey_RightArrow},
    {gl::Key::up, ImGuiKey_UpArrow},
    {gl::Key::down, ImGuiKey_DownArrow},
    {gl::Key::page_up, ImGuiKey_PageUp},
    {gl::Key::page_down, ImGuiKey_PageDown},
    {gl::Key::home, ImGuiKey_Home},
    {gl::Key::end, ImGuiKey_End},
    {gl::Key::insert, ImGuiKey_Insert},
    {gl::Key::del, ImGuiKey_Delete},
    {gl::Key::backspace, ImGuiKey_Backspace},
    {gl::Key::space, ImGuiKey_Space},
    {gl::Key::enter, ImGuiKey_Enter},
    {gl::Key::escape, ImGuiKey_Escape},
    {static_cast<gl::Key>('A'), ImGuiKey_A},
    {static_cast<gl::Key>('C'), ImGuiKey_C},
    {static_cast<gl::Key>('V'), ImGuiKey_V},
    {static_cast<gl::Key>('X'), ImGuiKey_X},
    {static_cast<gl::Key>('Y'), ImGuiKey_Y},
    {static_cast<gl::Key>('Z'), ImGuiKey_Z},
}};

// Since 1.87 ImGui takes events, which it spreads over frames; before that it reads what is down.
#if IMGUI_VERSION_NUM >= 18700
void use_keys() {}

void add_key(ImGuiIO& io, gl::Key key, bool is_down) {
  for (const auto& [ours, theirs] : kKeys) {
    if (ours == key) io.AddKeyEvent(theirs, is_down);
  }
}

void add_modifiers(ImGuiIO& io, const gl::Modifiers& modifiers) {
  io.AddKeyEvent(ImGuiMod_Ctrl, modifiers.control);
  io.AddKeyEvent(ImGuiMod_Shift, modifiers.shift);
  io.AddKeyEvent(ImGuiMod_Alt, modifiers.alt);
}

void add_pointer(ImGuiIO& io, vec2 position) { io.AddMousePosEvent(position.x, position.y); }
void add_button(ImGuiIO& io, int button, bool is_down) { io.AddMouseButtonEvent(button, is_down); }
void add_scroll(ImGuiIO& io, vec2 scroll) { io.AddMouseWheelEvent(scroll.x, scroll.y); }
void add_focus(ImGuiIO& io, bool has_it) { io.AddFocusEvent(has_it); }
#else
void use_keys() {
  for (const auto& [ours, theirs] : kKeys) ImGui::GetIO().KeyMap[theirs] = static_cast<int>(ours);
}

void add_key(ImGuiIO& io, gl::Key key, bool is_down) {
  const auto i = static_cast<std::size_t>(key);
  if (i > 0 && i < std::size(io.KeysDown)) io.KeysDown[i] = is_down;
}

void add_modifiers(ImGuiIO& io, const gl::Modifiers& modifiers) {
  io.KeyCtrl = modifiers.control, io.KeyShift = modifiers.shift, io.KeyAlt = modifiers.alt;
}

void add_pointer(ImGuiIO& io, vec2 position) { io.MousePos = ImVec2(position.x, position.y); }
void add_button(ImGuiIO& io, int button, bool is_down) { io.MouseDown[button] = is_down; }
void add_scroll(ImGuiIO& io, vec2 scroll) { io.MouseWheelH += scroll.x, io.MouseWheel += scroll.y; }
void add_focus(ImGuiIO& io, bool has_it) { io.AddFocusEvent(has_it); }
#endif

const char* clipboard_text(void* window) {
  static std::string text;
  text = static_cast<gl::Window*>(window)->clipboard();
  return text.c_str();
}

void set_clipboard_text(void* window, const char* text) { static_cast<gl::Window*>(window)->set_clipboard(text); }

void choose_style(float scale) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6.0f;
  style.FrameRounding = 3.0f;
  style.GrabRounding = 3.0f;
  style.WindowBorderSize = 0.0f;
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.09f, 0.095f, 0.105f, 0.94f);
  style.Colors[ImGuiCol_FrameBg] = ImVec4(0.19f, 0.20f, 0.22f, 1.0f);
  style.Colors[ImGuiCol_Header] = ImVec4(0.21f, 0.24f, 0.29f, 1.0f);
  style.ScaleAllSizes(scale);
}

}  // namespace

void GuiPicture::set(const DisplayImage& image) {
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (size_ == ivec2(image.width, image.height)) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  } else {
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  size_ = {image.width, image.height};
  gl::check("uploading a picture");
}

void* GuiPicture::id() const {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): ImGui hands it back as it is
  return reinterpret_cast<void*>(static_cast<std::uintptr_t>(static_cast<GLuint>(texture_)));
}

Gui::Gui(gl::Window& window) : context_(ImGui::CreateContext()) {
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // nothing is written that nobody asked for
  io.LogFilename = nullptr;
  io.BackendPlatformName = "candela::gl::Window";
  io.BackendRendererName = "OpenGL ES 3.0";
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  io.ClipboardUserData = &window;
  io.GetClipboardTextFn = clipboard_text;
  io.SetClipboardTextFn = set_clipboard_text;
  use_keys();
  const float scale = window.scale();
  choose_style(scale);
  add_font(15.0f * scale);
  upload_font();
  program_ = std::make_unique<gl::Program>(kVertex, kFragment);
}

Gui::~Gui() { ImGui::DestroyContext(context_); }

void Gui::upload_font() {
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.GetTexDataAsRGBA32(&pixels, &width, &height);
  DisplayImage image{width, height, {}};
  image.rgba.assign(pixels, pixels + static_cast<std::ptrdiff_t>(width) * height * 4);
  font_.set(image);
  fonts.SetTexID(font_.id());
  fonts.ClearTexData();
}

void Gui::add(const gl::WindowEvent& event) {
  using Kind = gl::WindowEvent::Kind;
  ImGuiIO& io = ImGui::GetIO();
  switch (event.kind) {
    case Kind::pointer:
      add_pointer(io, event.position);
      break;
    case Kind::button:
      add_pointer(io, event.position);
      add_button(io, static_cast<int>(event.button), event.is_down);
      break;
    case Kind::scroll:
      add_scroll(io, event.scroll);
      break;
    case Kind::key:
      add_modifiers(io, event.modifiers);
      add_key(io, event.key, event.is_down);
      break;
    case Kind::text:
      io.AddInputCharacter(event.character);
      break;
    case Kind::focus:
      add_focus(io, event.is_down);
      break;
    case Kind::drop:
    case Kind::changed:
      break;
  }
}

bool Gui::wants_pointer() const { return ImGui::GetIO().WantCaptureMouse; }
bool Gui::wants_keyboard() const { return ImGui::GetIO().WantTextInput; }

void Gui::begin(ivec2 size, double seconds) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(size.x), static_cast<float>(size.y));
  io.DeltaTime = static_cast<float>(std::clamp(seconds, 1e-4, 1.0));
  ImGui::NewFrame();
}

void Gui::draw(ivec2 size) {
  ImGui::Render();
  const ImDrawData& data = *ImGui::GetDrawData();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, size.x, size.y);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glClearColor(0.1f, 0.1f, 0.11f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  glEnable(GL_BLEND);
  // The window itself stays opaque.
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_SCISSOR_TEST);
  glUseProgram(program_->id());
  glUniform2f(program_->uniform("size"), static_cast<float>(size.x), static_cast<float>(size.y));
  glUniform1i(program_->uniform("picture"), 0);
  glActiveTexture(GL_TEXTURE0);
  glBindVertexArray(attributes_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  for (int n = 0; n < data.CmdListsCount; ++n) {
    const ImDrawList& list = *data.CmdLists[n];
    glBufferData(GL_ARRAY_BUFFER, list.VtxBuffer.Size * static_cast<GLsizeiptr>(sizeof(ImDrawVert)),
                 list.VtxBuffer.Data, GL_STREAM_DRAW);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, list.IdxBuffer.Size * static_cast<GLsizeiptr>(sizeof(ImDrawIdx)),
                 list.IdxBuffer.Data, GL_STREAM_DRAW);
    for (const ImDrawCmd& command : list.CmdBuffer) {
      if (command.UserCallback != nullptr) {
        if (command.UserCallback != ImDrawCallback_ResetRenderState) command.UserCallback(&list, &command);
        continue;
      }
      const ImVec4 clip = command.ClipRect;
      if (clip.z <= clip.x || clip.w <= clip.y) continue;
      glScissor(static_cast<GLint>(clip.x), size.y - static_cast<GLint>(clip.w), static_cast<GLsizei>(clip.z - clip.x),
                static_cast<GLsizei>(clip.w - clip.y));
      glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(reinterpret_cast<std::uintptr_t>(command.GetTexID())));
      const std::size_t base = command.VtxOffset * sizeof(ImDrawVert);
      const auto attribute = [base](GLuint index, GLint count, GLenum type, GLboolean is_unit, std::size_t offset) {
        glEnableVertexAttribArray(index);
        // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset, as OpenGL has it
        const auto* place = reinterpret_cast<const void*>(base + offset);
        glVertexAttribPointer(index, count, type, is_unit, sizeof(ImDrawVert), place);
      };
      attribute(0, 2, GL_FLOAT, GL_FALSE, offsetof(ImDrawVert, pos));
      attribute(1, 2, GL_FLOAT, GL_FALSE, offsetof(ImDrawVert, uv));
      attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(ImDrawVert, col));
      // NOLINTNEXTLINE(performance-no-int-to-ptr): likewise
      const auto* first = reinterpret_cast<const void*>(command.IdxOffset * sizeof(ImDrawIdx));
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount),
                     sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT, first);
    }
  }
  glBindVertexArray(0);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  gl::check("drawing the window");
}

DisplayImage Gui::read(ivec2 size) {
  DisplayImage image{size.x, size.y, {}};
  const std::size_t stride = static_cast<std::size_t>(size.x) * 4;
  std::vector<std::uint8_t> all(stride * static_cast<std::size_t>(size.y));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, all.data());
  gl::check("reading the window");
  image.rgba.resize(all.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(size.y); ++y) {
    std::copy_n(all.data() + (static_cast<std::size_t>(size.y) - 1 - y) * stride, stride,
                image.rgba.data() + y * stride);
  }
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

}  // namespace candela::viewer
