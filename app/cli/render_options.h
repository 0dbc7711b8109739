#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/values.h"
#include "foreign/measures.h"
#include "image/develop.h"
#include "path/render.h"
#include "raster/render.h"
#include "scene/view.h"

namespace candela::cli {

/// Everything `candela render` was asked for. Empty optionals mean "as the scene wishes".
struct RenderOptions {
  std::vector<std::string> scenes;
  std::string scene;                 ///< the one at hand
  foreign::Measures measures;        ///< of a file that says none
  std::string scene_choice;          ///< of those in the file; empty = its default one
  std::string variant;               ///< empty = the file's default look
  std::string root;                  ///< where all files of a scene must lie; empty = anywhere
  std::vector<std::string> outputs;  ///< with a turntable patterns of names; with several scenes one folder
  bool has_default_name = false;     ///< no output was given
  bool is_batch = false;             ///< a picture of each scene into outputs[0], a folder
  std::optional<int> turntable;      ///< pictures all around
  std::optional<int> sequence;       ///< pictures over an animation
  std::optional<std::string> animation;
  std::optional<double> frame_time_s;
  double shutter_s = 0.0;  ///< how long a picture is exposed while the scene moves

  bool has_many_pictures() const { return turntable || sequence; }
  ivec2 size{1280, 720};
  std::optional<int> samples;
  path::Settings settings;
  std::string shading;  ///< as given; empty = the default
  Engine engine = Engine::path;
  int msaa = 4;             ///< raster
  bool keeps_cache = true;  ///< raster
  raster::Quantity quantity = raster::Quantity::light;
  int shown_light = 0;
  float occlusion_radius = raster::Settings{}.occlusion_radius;
  raster::Ambient ambient = raster::Ambient::baked;
  bool has_soft_shadows = false;
  float light_radius = 0.0f;
  int probes = 0;
  float bloom = 0.0f;
  std::string shader_folder;  ///< raster; empty = the shaders in the program
  int threads = 0;

  std::optional<std::string> camera;
  std::optional<Orbit> orbit;
  std::optional<vec3> eye;
  std::optional<vec3> target;
  bool ignores_planes = false;  ///< of the file's cameras
  std::optional<float> fov;
  std::optional<float> f_number;
  std::optional<float> focus_distance;
  bool focus_given = false;
  int blades = 0;
  float vignetting = 0.0f;

  std::optional<std::string> environment;
  std::optional<float> sun_elevation;  ///< degrees
  float environment_rotation = 0.0f;
  float environment_intensity = 1.0f;

  std::optional<FalloffChoice> light_falloff;

  std::optional<std::optional<float>> exposure;  ///< given, and then empty for "auto"
  ToneCurve tone_curve = ToneCurve::pbr_neutral;
  BackgroundChoice background;
  bool develop_given = false;  ///< --exposure or --tonemap

  std::optional<std::filesystem::path> stats;  ///< "-" is standard output
  bool quiet = false;
  bool strict = false;
};

/// Adds `render` with its options to `app`. They fill `options`, which must outlive the parsing.
CLI::App* add_render_options(CLI::App& app, RenderOptions& options);

/// Whether the rasterizer's picture is shown as it is, without exposure and tone curve.
bool shows_numbers(raster::Quantity quantity);

/// The name that a scene's picture has unless another is given: the file's, or that of a demo.
std::string default_stem(const std::string& scene);

/// The name of its picture, or the pattern of its pictures, where none is given; a second attempt and later ones have a
/// number.
std::string default_output(const RenderOptions& options, int attempt);

/// Fills what follows from several options together and refuses combinations that make no sense (UsageError).
void finish_options(const CLI::App& verb, RenderOptions& options);

}  // namespace candela::cli
