#include "cli/render_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "candela/cache.h"
#include "cli/camera_options.h"
#include "cli/films.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/render_outputs.h"
#include "cli/scene_list.h"
#include "cli/threads.h"
#include "cli/values.h"
#include "raster/blocks.h"
#include "raster/quantity.h"
#include "scene/shading_model.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

constexpr float kHuge = 1e30f;  // far from where squares overflow a float
constexpr int kMostSamples = 1 << 20;
constexpr int kOpenEndedSamples = 1 << 16;  // where --time or --noise is meant to stop first

std::string joined(const std::vector<std::string>& names, std::string_view separator = ", ") {
  return fmt::format("{}", fmt::join(names, separator));
}

/// The names of presets, and of each term with each of its choices: "d=ggx", "d=beckmann".
std::vector<std::string> shading_words() {
  std::vector<std::string> words;
  for (const std::string& name : shading_model_names()) {
    const std::size_t equals = name.find('=');
    if (equals == std::string::npos) words.push_back(name);
    for (std::size_t begin = equals; begin != std::string::npos;) {
      const std::size_t end = name.find('|', begin + 1);
      words.push_back(name.substr(0, equals + 1) + name.substr(begin + 1, end - begin - 1));
      begin = end;
    }
  }
  return words;
}

std::vector<std::string> quantity_words() {
  std::vector<std::string> words{"light:"};
  for (int i = 0; i < raster::kQuantityCount; ++i) {
    words.emplace_back(raster::quantity_name(static_cast<raster::Quantity>(i)));
  }
  return words;
}

/// No name: all of them.
std::optional<std::vector<std::string>> names_or_all(const std::string& text) {
  return text == "all" ? std::vector<std::string>() : parse_names(text);
}

void add_picture(Command& command, RenderOptions& o) {
  const std::string group = "Picture";
  command
      .texts("-o,--output", o.outputs,
             "File to write, may be repeated; .exr and .hdr stay linear; - or exr:- is standard output; of several "
             "scenes a "
             "folder [SCENE's name .png]")
      .type("FILE.{png,jpg,webp,exr,hdr,mp4,webm,gif}|DIR")
      .repeated()
      .group(group);
  const auto variant = [](const std::string& value) {
    if (value.empty()) throw UsageError("the name is empty");
    return value;
  };
  add_scene_choice(command, o.shot.load.scene).group(group);
  add_measures(command, o.shot.load.measures, group);
  add_value(command, "--variant", "NAME", o.shot.load.variant, variant,
            "One of the file's material variants, as candela info lists them [its default look]")
      .group(group);
  add_value(command, "--variants", "LIST|all", o.shot.variants, names_or_all,
            "A picture of each of these variants, into -o NAME-{variant}.png")
      .group(group);
  add_value(command, "--size", "WxH", o.shot.size, parse_size, "Pixels, each side 1 to 16384 [1280x720]").group(group);
  add_value(command, "--fps", "N", o.frames_per_second, number_within(0.01f, 1000.0f),
            "Pictures per second of a film [a sequence's own time, else 24]")
      .group(group);
  add_look_options(command, o, group);
  add_value(command, "--aov", "LIST", o.shot.layers, parse_layers,
            "Layers beside the picture in the .exr, some of " + joined(names_of_rows(kLayers)))
      .choices_of_list(names_of_rows(kLayers))
      .group(group);
  add_value(command, "--cryptomatte", "object,material", o.shot.mattes, parse_mattes,
            "Soft masks of these in the .exr, as compositing programs read them")
      .choices_of_list(names_of_rows(kMatteKinds))
      .group(group);
  add_value(command, "--dataset", joined(names_of_rows(kDatasets), "|"), o.dataset, parse_dataset,
            "Pictures with what is known of them into -o DIR: masks and boxes, COCO, BOP, NeRF's transforms.json")
      .group(group);
  add_value(command, "--instances", "node|scene", o.instances, parse_instances,
            "What the data set calls an object [node; scene where several scenes are given]")
      .group(group);
}

void add_sampling(Command& command, RenderOptions& o) {
  const std::string group = "Sampling";
  add_value(command, "--quality", "draft|good|final", o.quality, parse_quality,
            "Samples, noise target and denoising by what is wanted; --spp, --noise and --denoise override it [none]")
      .group(group);
  add_value(command, "--spp", "N", o.samples, count_within(1, kMostSamples),
            "Samples per pixel, best a power of two [128; 65536 with --time or --noise; raster: frames to average, 1]")
      .group(group);
  add_value(command, "--time", "30s", o.shot.traced.time_limit_s, parse_duration,
            "Stop after about this long: 500ms, 30s, 5min, 1.5h")
      .group(group);
  add_value(command, "--noise", "X", o.shot.traced.noise, number_within(1e-6f, 1.0f),
            "Stop each pixel when its error as shown, from 0 black to 1 white, is estimated below X, e.g. 0.01")
      .group(group);
  command
      .flag_or_value("--denoise", "[=regression|oidn|none]", o.denoiser,
                     "Take out the noise that is left, by what is built in or by Open Image Denoise where installed")
      .group(group);
  add_value(command, "--bounces", "N", o.shot.traced.bounces, count_within(0, 1024),
            "Scattering events along a path; 1 is direct light only [8]")
      .group(group);
  add_value(command, "--seed", "N", o.shot.traced.seed, parse_seed, "Another seed is another noise pattern [0]")
      .group(group);
  add_choice(command, "--filter", "NAME", o.shot.traced.filter, kFilters, "box, gaussian or blackman-harris [box]")
      .group(group);
  add_choice(command, "--integrator", "NAME", o.shot.traced.integrator, kIntegrators,
             "full; minimal: the same mean by following the material alone; surfaces: likewise, without bodies [full]")
      .group(group);
  add_value(command, "--clamp", "X", o.shot.traced.clamp, number_within(1e-6f, 1e30f),
            "Cut a sample's indirect light at radiance X: fewer bright dots, some light lost [not at all]")
      .group(group);
  add_shading_option(command, o.shot, group);
}

void add_time(Command& command, RenderOptions& o) {
  const std::string group = "Time";
  const auto text = [](const std::string& value) { return value; };
  add_value(command, "--frame-time", "1.5s", o.shot.moment_s, parse_moment,
            "The moment of the animation that is shown [the file at rest; 0s with the options below]")
      .group(group);
  add_value(command, "--animation", "NAME|INDEX|all", o.shot.animation, text,
            "Which of the file's animations, as candela info lists them; all: every one together [the first]")
      .group(group);
  add_value(command, "--animations", "LIST|all", o.shot.animations, names_or_all,
            "Pictures of each of these animations, one after the other, into -o NAME-{animation}.png")
      .group(group);
  add_value(command, "--shutter", "20ms", o.shot.shutter_s, parse_duration,
            "Motion blur: how long the picture is exposed while the scene moves [not at all]")
      .group(group);
  add_value(command, "--sequence", "N", o.shot.sequence, count_within(1, 100000),
            "N pictures over the animation from --frame-time to its end, into -o NAME%03d.png")
      .group(group);
}

void add_running(Command& command, RenderOptions& o) {
  const std::string group = "Running";
  add_root(command, o.shot.load.root).group(group);
  add_texture_memory(command, o.shot.load.texture_memory).group(group);
  add_value(command, "--threads", "N", o.threads, count_within(0, kMostThreads),
            "0 is all; the picture does not depend on it [0]")
      .group(group);
  add_choice(command, "--engine", "path|raster", o.shot.engine, kEngines,
             "path, the path tracer; raster, OpenGL: a frame in a moment, with or without a GPU [path]")
      .group(group);
  const auto file_name = [](const std::string& value) {
    if (value.empty()) throw UsageError("the name is empty");
    return fs::path(value);
  };
  add_value(command, "--pictures", "A-B", o.pictures, parse_pictures,
            "Of a set only these, counted from 1, named and framed as in the whole set: 9-16 [all]")
      .group(group);
  add_value(command, "--part", "K/N", o.shot.part, parse_part,
            "The K-th of N parts of the samples, into -o FILE.part, for candela merge")
      .group(group);
  add_value(command, "--checkpoint", "FILE", o.checkpoint, file_name,
            "Keep the picture so far there every few seconds, until it is done")
      .group(group);
  command.flag("--resume", o.resumes, "Go on from --checkpoint's file where it is there").group(group);
  add_value(command, "--stats", "FILE.json", o.stats, file_name,
            "Times, rays, memory and warnings as JSON; - is standard output")
      .group(group);
  add_value(
      command, "--jobs", "FILE|-", o.jobs, [](const std::string& text) { return text; },
      "In place of all else: one command line after the other, a line each, models and environments loaded once")
      .group(group);
  command.flag("-q,--quiet", o.quiet, "Nothing on standard error but errors").group(group);
  command.flag("--strict", o.strict, "Warnings are errors").group(group);
  command.help().group(group);
}

void add_raster(Command& command, RenderOptions& o) {
  const std::string group = "With --engine raster";
  add_quantity_option(command, o.shot, group);
  add_drawing_options(command, o.shot, o.keeps_cache, group);
}

constexpr const char* kStops = R"(
A long render refreshes its output files every few seconds. Ctrl-C stops early and keeps the picture with the samples
or frames it has (exit code 0; 130 where pictures of a set are missing); a second Ctrl-C ends at once.
Exit codes: 0 done, 1 bad input or failed work, 2 wrong usage, 130 stopped by Ctrl-C or SIGTERM with work left.)";

constexpr const char* kExamples = R"(Examples:
  candela render demo:materials -o materials.png
  candela render helmet.glb -o helmet.png -o helmet.exr --env sky --aov albedo,normal,depth
  candela render helmet.glb -o close.png --orbit -30,15,0.6 --fov 30deg --f-number 4 --noise 0.02
  candela render helmet.glb -o logo.png --background transparent --exposure 1.5 --tonemap agx
  candela render shoe.glb -o shop.png --studio white
  candela render shoe.glb -o page.png --ground shadow --background transparent
  candela render helmet.glb -o frame.png --engine raster
  candela render helmet.glb -o frames/%03d.png --engine raster --turntable 48
  candela render helmet.glb -o turn.webp --engine raster --turntable 48
  candela render shoe.glb -o shoe-{variant}-{view}.png --variants all --views front,right,top,iso
  candela render helmet.glb -o train/{camera}.png --cameras sphere:100 --write-cameras transforms.json
  candela render shoe.glb --dataset coco -o train --cameras sphere:200,1 --engine raster --size 512x512
  candela render fox.glb -o run.png --animation Run --frame-time 0.4s --shutter 20ms
  candela render fox.glb -o run/%03d.png --engine raster --animation Run --sequence 30
  candela render a.glb b.glb models/ -o pictures/ --engine raster --size 256x256
  candela render city.gltf -o city.jpg --size 3840x2160 --time 10min --stats city.json
  candela render city.gltf -o city.exr --spp 4096 --checkpoint city.checkpoint --resume
  candela render city.gltf -o city-3.part --spp 4096 --part 3/8
)";

/// What most pictures need.
void add_short_help(Command& command) {
  command.short_help(
      {"--output", "--size", "--background", "--studio", "--ground", "--quality", "--time", "--camera", "--orbit",
       "--turntable", "--env", "--env-rotation", "--exposure", "--engine", "--quiet", "--help"},
      R"(`candela render --help all` lists every option, `candela help demos` the built-in scenes.

Examples:
  candela render helmet.glb
  candela render helmet.glb -o helmet.png --size 1920x1080 --quality good
  candela render helmet.glb -o logo.png --background transparent --env sky
  candela render helmet.glb -o frames/%03d.png --engine raster --turntable 48
  candela render models/ -o pictures/ --engine raster --size 256x256

Exit codes: 0 done, 1 bad input or failed work, 2 wrong usage, 130 stopped by Ctrl-C or SIGTERM with work left.)");
}

/// Replaces folders by the scenes below them.
void list_scenes_of(RenderOptions& o) {
  const std::vector<std::string> names = std::exchange(o.scenes, {});
  if (names.empty()) throw UsageError("SCENE is missing: what to render");
  for (ListedScene& scene : list_scenes(names)) {
    o.scenes.push_back(std::move(scene.name));
    o.stems.push_back(std::move(scene.stem));
  }
  o.is_batch = o.scenes != names || o.scenes.size() > 1;
}

/// Its pictures have the names that the format wants, in a folder that is given.
void check_dataset(const Command& command, RenderOptions& o) {
  if (!o.dataset) {
    if (o.instances) throw UsageError("--instances: only with --dataset");
    return;
  }
  if (o.outputs.size() != 1) throw UsageError("--dataset: needs the folder that it goes to: -o DIR");
  if (!fs::path(o.outputs[0]).extension().empty() && !fs::is_directory(o.outputs[0])) {
    throw UsageError("--output: a data set is a folder: " + o.outputs[0]);
  }
  for (const char* option : {"--aov", "--cryptomatte"}) {
    if (command.has(option))
      throw UsageError(std::string(option) + ": only an .exr holds it, and --dataset writes .png");
  }
  const bool has_objects = kDatasets[static_cast<std::size_t>(*o.dataset)].has_objects;
  if (o.instances && !has_objects) throw UsageError("--instances: transforms.json tells no objects apart");
  if (o.is_batch && !has_objects) throw UsageError("--dataset: transforms.json is of one scene");
  if (o.is_batch && (o.shot.turntable || o.shot.sequence)) {
    throw UsageError("--dataset: of several scenes the pictures come from --cameras or --views");
  }
  try {
    set_dataset(*o.dataset, o.shot);
  } catch (const Error& error) {
    throw UsageError(error.where() + ": " + error.message());
  }
  if (!o.instances) o.instances = o.is_batch ? InstanceKind::scene : InstanceKind::node;
  o.dataset_folder = o.outputs[0];
  if (o.is_batch) return;
  const Dataset names(*o.dataset, o.dataset_folder, *o.instances);
  o.outputs = {names.pattern(0, 1, o.stems[0], o.shot.has_many_pictures()).string()};
}

/// Some of the pictures of a set, or of several scenes.
void check_pictures(RenderOptions& o) {
  if (!o.pictures) return;
  if (o.dataset) throw UsageError("--pictures: a data set is made as a whole");
  const bool is_set = o.shot.has_many_pictures();
  if (o.is_batch && is_set) throw UsageError("--pictures: of several scenes with one picture each, or of one scene");
  if (!o.is_batch && !is_set) throw UsageError("--pictures: there is only one");
  if (!o.is_batch) o.shot.pictures = o.pictures;
  if (o.is_batch && o.pictures->last > o.scenes.size()) {
    throw Error(o.scenes.size() == 1 ? "there is one scene" : fmt::format("there are {} scenes", o.scenes.size()),
                "--pictures");
  }
  for (const std::string& output : o.outputs) {
    if (is_film(o, output)) throw UsageError("--pictures: a film has all of them: " + output);
  }
}

/// A part is one traced picture's, and goes into files that only merge reads.
void check_part(const Command& command, const RenderOptions& o) {
  const Shot& shot = o.shot;
  if (o.resumes && !o.checkpoint) throw UsageError("--resume: from which --checkpoint?");
  const bool is_one = shot.makes_one_picture() && !o.is_batch && shot.shutter_s == 0.0 && !o.dataset;
  for (const auto& [option, is_given] :
       {std::pair{"--part", shot.part.has_value()}, {"--checkpoint", o.checkpoint.has_value()}}) {
    if (is_given && !is_one) throw UsageError(std::string(option) + ": one picture without motion blur at a time");
  }
  for (const std::string& output : o.outputs) {
    if (has_extension(output, ".part") != shot.part.has_value()) {
      throw UsageError(shot.part ? "--output: a part of a picture is a .part: " + output
                                 : "--output: a .part is for --part: " + output);
    }
  }
  if (!shot.part) return;
  if (o.outputs.empty()) throw UsageError("--part: where to is missing: -o FILE.part");
  for (const char* option : {"--time", "--noise"}) {
    if (command.has(option)) throw UsageError(std::string(option) + ": parts have their numbers of samples: --spp");
  }
  if (shot.traced.noise) throw UsageError("--quality: it stops by noise, and a part has its number of samples: --spp");
}

/// Several scenes, or one into a folder.
void check_batch(const Command& command, RenderOptions& o) {
  // A folder named like a picture is more likely in the way than meant.
  const auto is_named_as_folder = [](const std::string& name) {
    return name.ends_with('/') || (fs::is_directory(name) && fs::path(name).extension().empty());
  };
  const bool is_folder = o.outputs.size() == 1 && (o.dataset || is_named_as_folder(o.outputs[0]));
  if (o.dataset && !o.is_batch) return;
  if (!o.is_batch && !is_folder) return;
  if (!is_folder) throw UsageError("--output: of several scenes it is one folder: -o DIR/");
  if (o.shot.turntable) throw UsageError("--turntable: one scene at a time");
  if (o.shot.sequence) throw UsageError("--sequence: one scene at a time");
  if (o.written_cameras) throw UsageError("--write-cameras: one scene at a time");
  if (o.stats) throw UsageError("--stats: one scene at a time");
  for (const char* option : {"--aov", "--cryptomatte"}) {
    if (command.has(option)) {
      throw UsageError(std::string(option) + ": only an .exr holds layers; give one scene and -o FILE.exr");
    }
  }
  o.is_batch = true;
}

void check_outputs(const Command& command, RenderOptions& o) {
  for (const auto& [one, many] : {std::pair{"--variant", "--variants"}, std::pair{"--animation", "--animations"}}) {
    if (command.has(one) && command.has(many)) throw UsageError(fmt::format("{} excludes {}", one, many));
  }
  check_pictures(o);
  check_part(command, o);
  check_dataset(command, o);
  check_batch(command, o);
  if (o.is_batch) return;
  if (o.shot.turntable && o.shot.sequence) throw UsageError("--sequence: not together with --turntable");
  if (o.outputs.empty()) {
    o.has_default_name = true;
    o.outputs.push_back(default_output(o, 1));
  }
  check_patterns(o);
  std::set<std::string> seen;
  bool any_exr = false;
  for (const std::string& output : o.outputs) {
    const std::string piped = standard_output_format(output);
    any_exr |= piped == ".exr";
    if (!piped.empty() && o.outputs.size() + (o.stats == "-" ? 1 : 0) > 1) {
      throw UsageError("--output: what goes to standard output goes there alone: " + output);
    }
    if (!piped.empty()) continue;
    try {
      if (!is_film(o, output) && !o.shot.part) check_output_extension(output);
    } catch (const Error& error) {
      throw UsageError(std::string("--output: ") + error.what());
    }
    if (!seen.insert(fs::path(output).lexically_normal().string()).second) {
      throw UsageError("--output: " + output + " is given twice");
    }
    any_exr |= has_extension(output, ".exr");
  }
  if (o.stats && seen.contains(o.stats->lexically_normal().string())) {
    throw UsageError("--stats: " + o.stats->string() + " is a picture's name");
  }
  const auto is_a_film = [&](const std::string& output) { return is_film(o, output); };
  if (o.frames_per_second && std::none_of(o.outputs.begin(), o.outputs.end(), is_a_film)) {
    throw UsageError("--fps: only for a film: -o FILE.mp4, .webm, .webp or .gif");
  }
  for (const char* option : {"--aov", "--cryptomatte"}) {
    if (command.has(option) && !any_exr && !o.shot.part) {
      throw UsageError(std::string(option) + ": only an .exr holds layers; add -o FILE.exr");
    }
  }
}

std::optional<denoise::Method> parse_denoiser(const std::string& text, path::Integrator integrator) {
  if (text == "none") return std::nullopt;
  if (integrator != path::Integrator::full) throw UsageError("--denoise: only for --integrator full");
  try {
    return text == "true" ? denoise::Method::regression : denoise::parse_method(text);
  } catch (const Error& error) {
    throw UsageError("--denoise: " + std::string(error.what()));
  }
}

/// Samples, noise target and denoiser. What is given stands before what a quality means: of samples and noise target
/// either stands for both.
void choose_sampling(const Command& command, RenderOptions& o) {
  constexpr int kDefaultSamples = 128;
  constexpr int kBlurFrames = 32;
  Shot& shot = o.shot;
  const std::optional<float> noise = shot.traced.noise;
  o.noise_given = noise.has_value();
  const bool is_open_ended = shot.traced.time_limit_s || noise;
  const int default_frames = shot.shutter_s > 0.0 || shot.f_number ? kBlurFrames : 1;
  if (o.quality) set_quality(*o.quality, shot);
  if (!o.quality || o.samples || noise) {
    shot.traced.samples = o.samples.value_or(is_open_ended ? kOpenEndedSamples : kDefaultSamples);
    shot.traced.noise = noise;
  }
  shot.drawn.frames = o.samples.value_or(std::max(o.quality ? shot.drawn.frames : 1, default_frames));
  if (command.has("--denoise")) shot.denoiser = parse_denoiser(o.denoiser, shot.traced.integrator);
  if (shot.engine == Engine::raster) shot.denoiser.reset();
  if (shot.denoiser && shot.traced.integrator != path::Integrator::full) {
    throw UsageError("--quality: it denoises, only for --integrator full (or --denoise=none)");
  }
}

/// What only one of the engines knows is not silently ignored by the other.
void check_engine(const Command& command, const RenderOptions& o) {
  const bool is_raster = o.shot.engine == Engine::raster;
  const auto refuse = [&](std::initializer_list<const char*> options, const std::string& why) {
    for (const char* option : options) {
      if (command.has(option)) throw UsageError(std::string(option) + ": " + why);
    }
  };
  if (is_raster) {
    refuse({"--time", "--noise", "--denoise", "--bounces", "--seed", "--filter", "--integrator", "--clamp", "--part",
            "--checkpoint"},
           "only for --engine path");
  } else {
    refuse({"--msaa", "--no-cache", "--shaders", "--view", "--ao", "--soft-shadows", "--light-radius", "--ambient",
            "--probes", "--texture-anisotropy"},
           "only for --engine raster");
    if (o.shot.traced.integrator != path::Integrator::full) refuse({"--clamp"}, "only for --integrator full");
    return;
  }
  if (raster::shows_numbers(o.shot.drawn.quantity)) {
    const std::string why = "--view shows numbers, which are left as they are";
    refuse({"--exposure", "--tonemap", "--bloom"}, why);
    if (raster::is_of_surface(o.shot.drawn.quantity)) {
      refuse({"--msaa"}, why);
      refuse({"--ao", "--soft-shadows", "--light-radius", "--ambient", "--probes", "--vignetting"},
             "--view shows a number of the surface, which no light changes");
    }
  }
  const raster::Quantity shown = o.shot.drawn.quantity;
  if (shown != raster::Quantity::light && shown != raster::Quantity::luminance) {
    refuse({"--ground"}, "only all light shows a ground, and --view is a part of it");
  }
  if (o.shot.probes > 0) refuse({"--ambient"}, "without effect on light from --probes");
  if (o.shot.f_number && o.samples.value_or(2) == 1) {
    throw UsageError("--f-number: of one frame everything is sharp: --spp 2 or more");
  }
}

}  // namespace

std::string default_pattern(const Shot& shot, const std::string& stem) {
  const std::string name = without_placeholders(stem);
  if (!shot.has_many_pictures()) return name + ".png";
  std::string pattern = literal_in_pattern(name);
  if (shot.variants) pattern += "-{variant}";
  if (shot.animations) pattern += "-{animation}";
  if (!shot.views.empty()) pattern += "-{view}";
  if (shot.camera_sphere || !shot.cameras.empty()) pattern += "-{camera}";
  return pattern + (shot.turntable || shot.sequence ? "-%03d.png" : ".png");
}

std::string default_output(const RenderOptions& o, int attempt) {
  return default_pattern(o.shot, default_stem(o.shot.scene) + (attempt > 1 ? fmt::format("-{}", attempt) : ""));
}

void add_look_options(Command& command, RenderOptions& o, const std::string& group) {
  add_value(command, "--exposure", "auto|EV|f/N,1/T,ISO", o.shot.exposure, parse_exposure,
            "Metered, in stops, or as on a camera [the scene's wish; studio 0 unless outshone; else auto]")
      .group(group);
  add_value(command, "--tonemap", "CURVE", o.shot.tone_curve, parse_tone_curve,
            "One of " + joined(names_of_rows(kToneCurves)) + " [pbr-neutral]")
      .choices(names_of_rows(kToneCurves))
      .group(group);
  add_value(command, "--bloom", "X", o.shot.bloom, number_within(0.0f, 1.0f),
            "Share of the light that the lens scatters around bright spots, e.g. 0.05 [0]")
      .group(group);
  add_value(command, "--background", "env|transparent|COLOUR", o.background, parse_background,
            "Behind it all: #rgb, #rrggbb or #rrggbbaa (sRGB), r,g,b (linear), or a CSS name: rebeccapurple [env]")
      .group(group);
  add_value(command, "--studio", joined(names_of_rows(kStudios), "|"), o.studio, parse_studio,
            "Light, paper and exposure of a product shot; --env, --ground and --background override it [none]")
      .group(group);
  add_value(command, "--ground", "shadow|mirror:X|COLOUR", o.shot.ground, parse_ground,
            "Under the subject: its shadow alone; with a mirror image; paper: white, grey+mirror:0.1 [nothing]")
      .group(group);
  add_value(command, "--ground-height", "Y", o.ground_height, number_within(-kHuge, kHuge),
            "Of the ground, metres [the subject's lowest point]")
      .group(group);
  add_value(command, "--glass", "background|env", o.shot.environment_in_glass, parse_glass,
            "What clear glass before such a background shows through it [background]")
      .group(group);
}

void add_shading_option(Command& command, Shot& shot, const std::string& group) {
  const auto shading = [&shot](const std::string& text) {
    shot.shading = parse_shading(text);
    return text;
  };
  add_value(command, "--shading", "MODEL", shot.shading_name, shading,
            "candela, gltf, ue4, learnopengl, thesis or blinn-phong, and terms: ue4,d=beckmann,diffuse=eon [candela]")
      .choices_of_list(shading_words())
      .group(group);
}

void add_quantity_option(Command& command, Shot& shot, const std::string& group) {
  const auto quantity = [&shot](const std::string& text) {
    constexpr std::string_view kLight = "light:";
    if (text.starts_with(kLight)) {
      shot.drawn.shown_light = count_within(0, raster::kMostLights - 1)(text.substr(kLight.size()));
      return raster::Quantity::one_light;
    }
    try {
      return raster::parse_quantity(text);
    } catch (const Error& error) {
      throw UsageError(error.message());
    }
  };
  add_value(command, "--view", "NAME", shot.drawn.quantity, quantity,
            "One quantity in place of all light: normal, base-color, roughness, specular, light:0, … [light]")
      .choices(quantity_words())
      .group(group);
}

void add_drawing_options(Command& command, Shot& shot, bool& keeps_cache, const std::string& group) {
  add_value(command, "--msaa", "N", shot.drawn.msaa, count_within(1, 16),
            "Samples of each frame at edges, 1 to what the driver has [4]")
      .group(group);
  add_value(
      command, "--texture-anisotropy", "N", shot.drawn.texture_anisotropy, count_within(1, 64),
      "How often a texture is read along the longer side of a pixel's footprint, at most; 1 is blurred at grazing "
      "angles, and faster without a GPU [8; 1 without a GPU]")
      .group(group);
  add_value(
      command, "--ao", "X", shot.drawn.occlusion_radius, number_within(0.0f, 1.0f),
      "How far surfaces take the environment's light from each other, over the scene's size, e.g. 0.05 [0: not at all]")
      .group(group);
  command
      .flag("--soft-shadows", shot.drawn.has_soft_shadows,
            "Shadows of suns soften with the distance from what casts them (those of glowing surfaces always do)")
      .group(group);
  add_value(command, "--light-radius", "M", shot.drawn.light_radius, number_within(0.0f, 1e6f),
            "The same for points and spots, as if they were balls so large [0: hard]")
      .group(group);
  add_choice(command, "--ambient", "KIND", shot.drawn.ambient, kAmbients,
             "Light from far away: baked, or for comparison harmonics, mips, constant, none [baked]")
      .group(group);
  add_value(command, "--probes", "N", shot.probes, count_within(0, 64),
            "Light from within the scene, path traced at N places, in place of that from far away [0]")
      .group(group);
  command.flag("!--no-cache", keeps_cache, "Bake the environment anew, and keep nothing of it").group(group);
  const auto folder = [](const std::string& value) {
    if (!fs::is_directory(value)) throw UsageError("is no folder: " + value);
    return value;
  };
  add_value(command, "--shaders", "DIR", shot.drawn.shader_folder, folder,
            "For development: read shaders from there in place of those in the program")
      .group(group);
}

void add_light_options(Command& command, RenderOptions& o) {
  const std::string group = "Light";
  const auto text = [](const std::string& value) { return value; };
  const auto degrees_within = [](float low, float high) {
    return [=](const std::string& value) { return candela::radians(parse_number(value, low, high)); };
  };
  add_value(command, "--env", "FILE|NAME", o.shot.environment, text,
            "An .exr (:LAYER) or .hdr, a cube map, or studio, studio:dark, studio:three-point, sky, sky:DEG, furnace, "
            "none [the scene's wish, else studio]")
      .choices(environment_words())
      .group(group);
  add_value(command, "--sun-elevation", "DEG", o.sun_elevation, number_within(-5.0f, 90.0f),
            "Height of the sun: short for --env sky:DEG")
      .group(group);
  add_value(command, "--env-rotation", "DEG", o.shot.environment_rotation, degrees_within(-36000.0f, 36000.0f),
            "Turns the environment about +y [0]")
      .group(group);
  add_value(command, "--env-intensity", "X", o.shot.environment_intensity, number_within(0.0f, kHuge),
            "Multiplies the environment [1]")
      .group(group);
  add_value(command, "--light-falloff", "KIND", o.shot.falloff, parse_falloff,
            "Of every point and spot: gltf, inverse-square, ue4 or polynomial[:A0,A1,A2] [each light's own]")
      .choices(names_of(kFalloffs))
      .group(group);
}

void finish_look_options(const Command& command, RenderOptions& o) {
  if (o.keeps_cache) o.shot.drawn.cache = cache_folder();
  o.shot.background = o.background.kind;
  o.shot.background_color = o.background.color;
  o.shot.background_opacity = o.background.opacity;
  if (o.studio) {
    Shot shot;
    set_studio(*o.studio, shot);
    if (!o.shot.environment && !o.sun_elevation) o.shot.environment = shot.environment;
    if (!o.shot.ground) o.shot.ground = shot.ground;
  }
  if (o.shot.ground) o.shot.ground->height = o.ground_height;
  if (o.ground_height && !o.shot.ground) throw UsageError("--ground-height: only with --ground");
  const bool is_paper = o.shot.ground && o.shot.ground->color;
  if (is_paper && command.has("--background") && o.background.kind == Background::environment) {
    throw UsageError("--ground: paper is the background too; --ground shadow lies in the environment");
  }
  if (command.has("--glass") && o.background.kind == Background::environment && !is_paper) {
    throw UsageError("--glass: without another --background glass shows the environment");
  }
  if (o.shot.drawn.light_radius > 0.0f) o.shot.drawn.has_soft_shadows = true;
  o.shot.focuses_on_target = command.has("--focus-distance");
}

void finish_light_options(RenderOptions& o) {
  if (o.sun_elevation) {
    if (o.shot.environment.value_or("sky") != "sky") throw UsageError("--sun-elevation: only for --env sky");
    o.shot.environment = fmt::format("sky:{}", *o.sun_elevation);
  }
  check_environment_name(o.shot.environment.value_or("none"));
}

void add_render_options(Command& command, RenderOptions& options) {
  command
      .texts("SCENE", options.scenes,
             "A file (" + kSceneFiles + ") or a built-in demo:NAME; several, or folders to search, with -o DIR")
      .choices(demo_words());
  add_picture(command, options);
  add_sampling(command, options);
  add_camera_options(command, options);
  add_time(command, options);
  add_light_options(command, options);
  add_running(command, options);
  add_raster(command, options);
  command.footer(std::string(kExamples) + kStops);
  add_short_help(command);
}

RenderOptions parse_job(const std::vector<std::string>& words, const std::string& job_list, bool quiet) {
  CommandLine line("candela", "a job", version());
  Command command = line.add_verb("render", "a job");
  RenderOptions options;
  options.job_list = job_list;
  add_render_options(command, options);
  std::vector<std::string> arguments{"render"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  if (!line.parse(arguments).text.empty()) throw UsageError("--help: is no job");
  if (!options.jobs.empty()) throw UsageError("--jobs: not within a job");
  options.quiet |= quiet;
  finish_options(command, options);
  for (const std::string& output : options.outputs) {
    if (!standard_output_format(output).empty()) throw UsageError("--output: a job writes to a file: " + output);
  }
  return options;
}

void finish_options(const Command& command, RenderOptions& o) {
  list_scenes_of(o);
  o.shot.scene = o.scenes.front();
  check_engine(command, o);
  choose_sampling(command, o);
  finish_look_options(command, o);
  o.develop_given = command.has("--exposure") || command.has("--tonemap") || command.has("--bloom");
  finish_camera_options(command, o);

  finish_light_options(o);
  check_outputs(command, o);
}

}  // namespace candela::cli
