#include "cli/diff_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "base/memory.h"
#include "base/text.h"
#include "candela/cache.h"
#include "cli/camera_options.h"
#include "cli/option.h"
#include "cli/threads.h"
#include "cli/values.h"

namespace candela::cli {

namespace {

/// From all sides: what is lost at one of them shall be seen.
constexpr auto kViews = std::to_array<std::string_view>({"front", "right", "back", "left", "top", "bottom"});
constexpr ivec2 kSize{384, 384};
constexpr int kSamples = 32;

constexpr std::array kOptions = {"--views",     "--orbit", "--cameras", "--margin", "--size",           "--engine",
                                 "--spp",       "--seed",  "--env",     "--scene",  "--variant",        "--frame-time",
                                 "--animation", "--root",  "--unit",    "--up",     "--texture-memory", "--threads"};

void add_viewpoints(Command& command, SceneRecipe& r, const std::string& group) {
  Option views = add_value(command, "--views", "LIST", r.shot.views, parse_views,
                           "Some of " + names_of_views() + " [" + fmt::format("{}", fmt::join(kViews, ",")) + "]")
                     .choices_of_list(names_of_rows(kNamedViews));
  Option orbit = add_value(command, "--orbit", "AZ,EL[,DIST]", r.shot.orbit, parse_orbit,
                           "One view, degrees around and above the subject; DIST 1 fits it");
  const auto cameras = [&r](const std::string& value) {
    if (value.empty()) throw UsageError("the name is empty");
    r.shot.camera_sphere = parse_camera_sphere(value);
    return r.shot.camera_sphere ? std::nullopt : std::optional<std::filesystem::path>(value);
  };
  Option list = add_value(command, "--cameras", "FILE|sphere:N[,SEED]", r.camera_file, cameras,
                          "Through each camera of a file, or from N places all around");
  Option margin = add_value(command, "--margin", "8%", r.shot.margin, parse_margin,
                            "What stays free at either side of what both files show [8%]");
  views.excludes(orbit).excludes(list);
  orbit.excludes(list);
  for (Option option : {views, orbit, list, margin}) option.group(group);
}

}  // namespace

void add_scene_recipe(Command& command, SceneRecipe& r) {
  const std::string group = "Of two scenes";
  const auto text = [](const std::string& value) { return value; };
  constexpr int kMostSamples = 1 << 20;
  r.shot.size = kSize;
  add_viewpoints(command, r, group);
  add_value(command, "--size", "WxH", r.shot.size, parse_size, "Of each picture, pixels [384x384]").group(group);
  add_choice(command, "--engine", "path|raster", r.shot.engine, kEngines, "What makes the pictures [path]")
      .group(group);
  add_value(command, "--spp", "N", r.samples, count_within(1, kMostSamples),
            "Samples per pixel [32; raster: frames to average, 1]")
      .group(group);
  add_value(command, "--seed", "N", r.shot.traced.seed, parse_seed, "Of the noise, the same in both [0]").group(group);
  add_value(command, "--env", "FILE|NAME", r.shot.environment, text,
            "What lights both [their own image-based light, else the wish of FIRST, else studio]")
      .choices(environment_words())
      .group(group);
  add_scene_choice(command, r.shot.load.scene).group(group);
  add_value(command, "--variant", "NAME", r.shot.load.variant, text, "The material variant that both wear")
      .group(group);
  add_value(command, "--frame-time", "1.5s", r.shot.moment_s, parse_moment, "The moment of the animation [at rest]")
      .group(group);
  add_value(command, "--animation", "NAME|INDEX|all", r.shot.animation, text, "Which animation [the first]")
      .group(group);
  add_root(command, r.shot.load.root).group(group);
  add_measures(command, r.shot.load.measures, group);
  add_texture_memory(command, r.shot.load.texture_memory).group(group);
  add_value(command, "--threads", "N", r.threads, count_within(0, kMostThreads),
            "0 is all; the result does not depend on it [0]")
      .group(group);
}

void finish_scene_recipe(const Command& command, SceneRecipe& r) {
  const bool is_raster = r.shot.engine == Engine::raster;
  if (is_raster && command.has("--seed")) throw UsageError("--seed: only for --engine path");
  if (r.camera_file && command.has("--margin")) throw UsageError("--margin: not for the cameras of a file");
  r.shot.background = Background::transparent;
  r.shot.traced.samples = r.samples.value_or(kSamples);
  r.shot.drawn.frames = r.samples.value_or(1);
  r.shot.drawn.cache = cache_folder();
  if (r.camera_file) {
    read_cameras_of_shot(*r.camera_file, command.has("--size"), r.shot);
  } else if (r.shot.views.empty() && !r.shot.orbit && !r.shot.camera_sphere) {
    r.shot.views.assign(kViews.begin(), kViews.end());
  }
}

void refuse_scene_recipe(const Command& command) {
  for (const std::string& name : command.given()) {
    const bool is_of_scenes = std::find(kOptions.begin(), kOptions.end(), name) != kOptions.end();
    if (is_of_scenes) throw UsageError(name + ": only for two scenes");
  }
}

namespace {

/// The formats that say neither unit nor upward axis.
bool takes_measures(const std::string& name) {
  const std::string extension = lower_extension(name);
  return extension == ".obj" || extension == ".stl" || extension == ".ply";
}

}  // namespace

std::pair<Shot, Shot> shots_of(const SceneRecipe& r, const std::string& first, const std::string& second) {
  std::pair<Shot, Shot> shots{r.shot, r.shot};
  shots.first.scene = first, shots.second.scene = second;
  // They are for the one that takes them, or else to be refused.
  if (takes_measures(first) && !takes_measures(second)) shots.second.load.measures = {};
  if (takes_measures(second) && !takes_measures(first)) shots.first.load.measures = {};
  return shots;
}

void check_memory(const SceneRecipe& r) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(r.shot.size.x) * static_cast<std::uint64_t>(r.shot.size.y);
  const std::size_t listed = std::max({r.shot.views.size(), r.shot.cameras.size(), std::size_t{1}});
  const std::size_t count = r.shot.camera_sphere ? static_cast<std::size_t>(r.shot.camera_sphere->count) : listed;
  constexpr std::uint64_t kBytesPerPixel = 8 * sizeof(float);  // the picture, and what glass lets through
  require_memory(picture_bytes(r.shot) + count * pixels * kBytesPerPixel, available_memory(),
                 fmt::format("{} of {}x{}", counted(count, "picture"), r.shot.size.x, r.shot.size.y), "--size");
}

}  // namespace candela::cli
