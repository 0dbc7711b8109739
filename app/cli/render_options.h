#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "candela/dataset.h"
#include "candela/shot.h"
#include "cli/command_line.h"
#include "cli/values.h"

namespace candela::cli {

/// Everything `candela render` was asked for.
struct RenderOptions {
  Shot shot;                           ///< of the scene at hand
  std::string jobs;                    ///< a file of command lines, in place of all others
  std::string job_list = {};           ///< the file that this is a line of
  std::vector<std::string> scenes;     ///< files, folders replaced by what is below them
  std::vector<std::string> stems;      ///< what the picture of each is called in a folder, ListedScene::stem
  std::vector<std::string> outputs;    ///< with a turntable patterns of names; with several scenes one folder
  bool has_default_name = false;       ///< no output was given
  bool is_batch = false;               ///< a picture of each scene into outputs[0], a folder
  std::optional<int> samples;          ///< or frames
  bool keeps_cache = true;             ///< of the rasterizer
  std::optional<float> sun_elevation;  ///< degrees
  BackgroundChoice background;
  std::optional<float> ground_height;
  std::optional<Studio> studio;
  std::optional<Quality> quality;
  bool noise_given = false;              ///< --noise: a target that is not reached is worth a warning
  std::string denoiser = {};             ///< as --denoise has it
  bool develop_given = false;            ///< --exposure, --tonemap or --bloom
  std::optional<PictureRange> pictures;  ///< of a set, or of the pictures of several scenes
  int threads = 0;
  std::optional<std::filesystem::path> stats;            ///< "-" is standard output
  std::optional<std::filesystem::path> camera_file;      ///< --cameras
  std::optional<std::filesystem::path> written_cameras;  ///< --write-cameras
  std::optional<std::filesystem::path> checkpoint;
  bool resumes = false;
  std::optional<DatasetKind> dataset;
  std::filesystem::path dataset_folder;
  std::optional<InstanceKind> instances;   ///< of the data set
  std::optional<float> frames_per_second;  ///< of films
  bool quiet = false;
  bool strict = false;
};

/// Adds the options of `render`. They fill `options`, which must outlive the parsing.
void add_render_options(Command& command, RenderOptions& options);

/// Adds the options for light from far away and the falloff of lamps.
void add_light_options(Command& command, RenderOptions& options);
/// What follows from them. Throws UsageError, and Error for an environment that is not there.
void finish_light_options(RenderOptions& options);

/// Adds how pictures are exposed, and what is behind and under their subject.
void add_look_options(Command& command, RenderOptions& options, const std::string& group);
/// What follows from them, and from those of drawing. Throws UsageError.
void finish_look_options(const Command& command, RenderOptions& options);

/// Adds --shading.
void add_shading_option(Command& command, Shot& shot, const std::string& group);

/// Adds --view: what is shown in place of all light.
void add_quantity_option(Command& command, Shot& shot, const std::string& group);

/// Adds what is said of the rasterizer's frames, but for what they show.
void add_drawing_options(Command& command, Shot& shot, bool& keeps_cache, const std::string& group);

/// The name of its picture, or the pattern of its pictures, where none is given; a second attempt and later ones have a
/// number.
std::string default_output(const RenderOptions& options, int attempt);

/// The same for a name without extension: with a place for whatever distinguishes the pictures of a shot.
std::string default_pattern(const Shot& shot, const std::string& stem);

/// The words of a line of a list of jobs, without "candela render". Throws UsageError.
RenderOptions parse_job(const std::vector<std::string>& words, const std::string& job_list, bool quiet = false);

/// Fills what follows from several options together and refuses combinations that make no sense (UsageError).
void finish_options(const Command& command, RenderOptions& options);

}  // namespace candela::cli
