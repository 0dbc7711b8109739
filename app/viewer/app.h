#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "gl/window.h"
#include "viewer/camera_control.h"
#include "viewer/drawing.h"
#include "viewer/gui.h"
#include "viewer/loading.h"
#include "viewer/model.h"
#include "viewer/tracing.h"
#include "viewer/viewer.h"
#include "viewer/watch.h"

namespace candela::viewer {

class Script;

inline constexpr double kShownFor = 6.0, kErrorsFor = 20.0;  // seconds that a message stays

/// One line for the user.
struct Message {
  std::string text;
  bool is_error = false;
  double at_s = 0.0;  ///< when it came
};

/// A place in the scene that a finding is about.
struct Marker {
  vec3 position{0.0f};
  std::size_t finding = 0;  ///< of the verdict
};

/// The window with all that is in it. It belongs to the main thread; what takes long is done by the threads of Loading,
/// Drawing and Tracing, whose results arrive through the mailbox.
class App {
 public:
  /// `script` may be null.
  App(const ViewOptions& options, std::unique_ptr<Script> script);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  void run();

  // ----- what a script may do and ask, beside input
  void handle(const gl::WindowEvent& event);
  void save_picture(ivec2 size, const std::filesystem::path& path);
  void save_window(const std::filesystem::path& path);
  void resize(ivec2 size) { window_.resize(size); }
  void close() { is_closing_ = true; }
  /// A line of JSON; the longest time without an answer is that since the last one.
  std::string state();
  /// Whether what a script may wait for is there, so often or with so many samples: "loaded", "lit", "drawn", "traced",
  /// "judged", "picked", "explained", "saved", "failed". Throws Error for anything else.
  bool has(const std::string& what, int count) const;

 private:
  // ----- app.cpp: what happens
  void attend();
  void frame();
  void open(const std::string& model);
  void open_light(const std::string& name);
  void reload();
  void drop(const std::vector<std::string>& files);
  void take_model(std::shared_ptr<Model> model);
  void take_light(std::shared_ptr<const FarLight> light);
  void take_shown(std::shared_ptr<const Shown> shown);
  void look_from(std::size_t viewpoint);
  void watch();
  void play();
  double animation_length() const;
  void write_picture(const std::filesystem::path& path, const Film& film, const DevelopSettings& develop);
  void save_traced();
  void say(std::string text, bool is_error = false);
  void warn(const std::vector<Diagnostic>& warnings);
  void set_title();
  Drawing::Told drawing_told();
  Tracing::Told tracing_told();
  Loading::Told loading_told();

  // ----- look.cpp: what is to be seen
  /// Something that pictures depend on has changed; by something that goes on, a drag or an animation.
  void change(bool is_moving = false);
  void ask();
  Look look() const;
  std::vector<std::pair<std::string, View>> views_of(const Scene& scene, const Extent& extent) const;
  std::optional<std::size_t> own_camera(const Scene& scene) const;
  float panel_width() const;
  ivec2 picture_size() const;
  float aspect() const;
  Edits& edit();
  void choose_views();
  std::shared_ptr<const Scene> scene() const;
  std::optional<vec3> on_screen(vec3 position) const;
  void pick(vec2 position);
  void judge();
  void place_markers();

  // ----- control.cpp: the pointer and the keyboard
  void press(const gl::WindowEvent& event);
  void move(const gl::WindowEvent& event);
  void act(const gl::WindowEvent& event);
  void next_quantity(int step);
  void free_camera();

  // ----- panels.cpp and panel_*.cpp: what ImGui draws
  void build();
  void build_picture();
  void build_panel();
  void build_overlay();
  void build_help();
  void build_markers();
  void panel_picture();
  void panel_light();
  void panel_scene();
  void panel_lamps();
  void panel_material();
  void panel_findings();
  void panel_pixel();
  void panel_saving();
  bool edit_row(std::size_t row, const Material& material, MaterialEdit& edit);
  void show_texture(const Scene& scene, const TextureSlot& slot, std::size_t slot_index);

  ViewOptions options_;
  Shot shot_;  ///< as it stands: with what the user has changed
  Stopwatch watch_;
  gl::Window window_;
  Gui gui_;
  Mailbox mailbox_;

  // ----- what is there
  std::shared_ptr<Model> model_;
  std::shared_ptr<const FarLight> light_;
  std::string light_name_;  ///< that is wanted; empty = the model's own
  std::shared_ptr<const Shown> shown_;
  GuiPicture drawn_picture_, traced_picture_;
  std::shared_ptr<const Traced> traced_;
  std::optional<Verdict> verdict_;
  std::vector<Marker> markers_;
  std::optional<Picked> picked_;
  std::string explained_;  ///< what there is to say of the pixel that was clicked on
  std::map<const TextureImage*, GuiPicture> thumbnails_;
  FileWatch watched_, watched_shaders_;

  // ----- what the user has chosen
  CameraControl camera_;
  bool is_own_camera_ = false;              ///< camera_ has been set for this model
  std::optional<std::size_t> camera_node_;  ///< that one looks through
  std::vector<std::pair<std::string, View>> viewpoints_;
  std::size_t viewpoint_ = 0;
  std::vector<std::pair<std::size_t, std::string>> camera_names_;  ///< of the file's, by their nodes
  Moment moment_;
  bool is_playing_ = false;
  float speed_ = 1.0f;
  std::shared_ptr<const Edits> edits_;
  std::uint64_t edit_count_ = 0;
  float rotation_ = 0.0f, intensity_ = 1.0f;
  float stops_ = 0.0f;                  ///< of exposure, beside what the scene or the meter says
  std::optional<float> base_exposure_;  ///< of the picture without these
  std::uint64_t light_since_ = 0;       ///< the look after which it is known
  int material_ = 0;                    ///< shown in the inspector, of the scene
  bool is_split_ = false, is_denoised_ = false;
  float split_ = 0.5f;
  ivec2 saved_size_{0};  ///< 0: the window's
  bool has_panels_ = true, has_help_ = false, has_markers_ = false;

  // ----- what goes on
  bool needs_picture_ = false, is_moving_ = false, is_closing_ = false;
  double moved_s_ = -1.0;
  double last_s_ = 0.0, slowest_s_ = 0.0;
  int lively_ = 3;  ///< frames of the window that follow without waiting
  std::string working_;
  std::deque<Message> messages_;
  std::optional<gl::MouseButton> held_;
  gl::Modifiers held_modifiers_;
  vec2 pressed_at_{0.0f}, pointer_{0.0f};
  bool is_dragging_ = false, is_at_divider_ = false;
  bool wants_trace_ = false;
  int loads_ = 0, saves_ = 0, picks_ = 0, explanations_ = 0, failures_ = 0;
  double play_lag_ = 0.0, framed_s_ = 0.0;
  DisplayImage last_window_;  ///< while a script plays
  int whole_frames_ = 0;
  std::uint64_t asked_ = 0, drawn_ = 0;  ///< counts of looks
  double first_frame_s_ = -1.0;
  bool has_outline_ = false, has_first_picture_ = false, has_first_light_ = false;
  std::unique_ptr<Script> script_;

  // ----- the threads, last, so that they end first
  std::unique_ptr<Tracing> tracing_;
  std::unique_ptr<Drawing> drawing_;
  std::unique_ptr<Loading> loading_;
};

}  // namespace candela::viewer
