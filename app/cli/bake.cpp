#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "cli/bake_output.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_outputs.h"
#include "cli/threads.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "image/cube_file.h"
#include "image/cube_metrics.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

struct BakeOptions {
  BakeOrder order;
  std::string output;
  std::string report;
  std::optional<vec3> at;             ///< a point of the scene
  std::vector<std::string> compared;  ///< the two of --diff
  std::optional<int> size;
  std::optional<int> levels;
  std::optional<ibl::Mapping> mapping;
  bool has_format = false;
  bool tables = false;
  int table_size = 128;
  bool json = false;
  bool quiet = false;
  int threads = 0;
};

/// A share, plain or in per cent: "0.005" or "0.5%".
double parse_share(const std::string& text) {
  const bool percent = text.ends_with('%');
  const float value = parse_number(percent ? text.substr(0, text.size() - 1) : text, 1e-7f, percent ? 100.0f : 1.0f);
  return static_cast<double>(value) * (percent ? 0.01 : 1.0);
}

void add_cube(Command& command, BakeOptions& o) {
  using ibl::Mapping;
  using ibl::Method;
  constexpr int kMostSize = 4096;
  constexpr int kMostLevels = 13;
  constexpr int kMostSamples = 1 << 20;
  const std::string group = "Specular";
  add_value(command, "--size", "N", o.size, count_within(1, kMostSize), "Texels along a face of level 0 [256]")
      .group(group);
  add_value(command, "--levels", "N", o.levels, count_within(1, kMostLevels), "Each half the size of the last [6]")
      .group(group);
  constexpr Words<Mapping, 3> kMappings{
      {{"balanced", Mapping::balanced}, {"linear", Mapping::linear}, {"filament", Mapping::filament}}};
  constexpr Words<Method, 5> kMethods{{{"auto", Method::automatic},
                                       {"zonal", Method::zonal},
                                       {"hierarchical", Method::hierarchical},
                                       {"fis", Method::fis},
                                       {"montecarlo", Method::montecarlo}}};
  add_choice(command, "--mapping", "NAME", o.mapping, kMappings,
             "Roughness of the levels: balanced (its square halves as texels do), linear, filament [balanced]")
      .group(group);
  add_choice(command, "--method", "NAME", o.order.settings.specular.method, kMethods,
             "zonal, hierarchical; fis and montecarlo for comparison [auto: zonal where the lobe allows]")
      .group(group);
  add_value(command, "--samples", "N", o.order.settings.specular.samples, count_within(1, kMostSamples),
            "Of fis, montecarlo and riemann, per texel [1024]")
      .group(group);
  command.flag("--sheen", o.order.settings.sheen, "Also the levels of the sheen lobe").group(group);
}

void add_diffuse(Command& command, BakeOptions& o) {
  using ibl::IrradianceMethod;
  using ibl::Window;
  constexpr int kMostSize = 1024;
  const std::string group = "Diffuse";
  constexpr Words<IrradianceMethod, 3> kMethods{{{"exact", IrradianceMethod::exact},
                                                 {"riemann", IrradianceMethod::riemann},
                                                 {"montecarlo", IrradianceMethod::montecarlo}}};
  constexpr Words<Window, 4> kWindows{
      {{"none", Window::none}, {"hann", Window::hann}, {"lanczos", Window::lanczos}, {"auto", Window::automatic}}};
  add_choice(command, "--irradiance", "NAME", o.order.settings.irradiance_method, kMethods,
             "exact; riemann and montecarlo for comparison [exact]")
      .group(group);
  add_value(command, "--irradiance-size", "N", o.order.settings.irradiance_size, count_within(1, kMostSize),
            "Texels along a face [32]")
      .group(group);
  add_value(command, "--sh-order", "L", o.order.settings.sh_order, count_within(0, ibl::kMostShOrder),
            "Highest degree of the spherical harmonics [2: nine of them]")
      .group(group);
  add_choice(command, "--window", "NAME", o.order.settings.window, kWindows,
             "Damps their ringing: none, hann, lanczos, auto (as little as leaves nothing negative) [none]")
      .group(group);
}

Words<BakeFormat, 12> formats() {
  using Kind = BakeFormat::Kind;
  const auto texture = [](TextureContainer container, TexelFormat format) {
    return BakeFormat{Kind::texture, "", {.container = container, .format = format}};
  };
  return {{{"exr", {}},
           {"hdr", {Kind::faces, ".hdr", {}}},
           {"panorama", {Kind::panorama, "", {}}},
           {"rgbm", {Kind::rgbm, "", {}}},
           {"gltf", {Kind::gltf, "", {}}},
           {"ktx2", texture(TextureContainer::ktx2, TexelFormat::rgba16f)},
           {"ktx2-rgba32f", texture(TextureContainer::ktx2, TexelFormat::rgba32f)},
           {"ktx2-rgb9e5", texture(TextureContainer::ktx2, TexelFormat::rgb9e5)},
           {"ktx1", texture(TextureContainer::ktx1, TexelFormat::r11g11b10f)},
           {"ktx1-rgba16f", texture(TextureContainer::ktx1, TexelFormat::rgba16f)},
           {"dds", texture(TextureContainer::dds, TexelFormat::rgba16f)},
           {"dds-rgba32f", texture(TextureContainer::dds, TexelFormat::rgba32f)}}};
}

CubeAxes parse_axes_option(const std::string& text) {
  if (const auto axes = parse_axes(text)) return *axes;
  throw UsageError("'" + text + "' is no three signed axes such as -x+y+z");
}

void add_files(Command& command, BakeOptions& o) {
  const std::string group = "Files";
  add_value(
      command, "--profile", "ENGINE", o.order.profile, [](const std::string& text) { return &ibl::find_profile(text); },
      "What an engine reads: filament, three, babylon, khronos, bevy, godot, unreal, unity")
      .choices(names_of_rows(ibl::profiles()))
      .group(group);
  add_choice(command, "--format", "NAME", o.order.format, formats(),
             "exr, hdr (six faces a level), panorama, rgbm, gltf (EXT_lights_image_based), ktx2, ktx2-rgba32f, "
             "ktx2-rgb9e5, ktx1, ktx1-rgba16f, dds, dds-rgba32f [exr]")
      .group(group);
  add_value(command, "--axes", "AXES", o.order.light.axes, parse_axes_option,
            "By which a cube map that is read is looked up, in terms of the world's: -x+y+z is as seen from inside")
      .group(group);
  command.texts("--diff", o.compared, "Compare two baked cube maps, level by level, and bake nothing")
      .type("OLD NEW")
      .values(2)
      .group(group);
}

void add_scene(Command& command, BakeOptions& o) {
  constexpr int kMostSpp = 1 << 20;
  add_value(
      command, "--from-scene", "SCENE", o.order.light.scene, [](const std::string& text) { return text; },
      "Bake what a point of a scene sees, path traced; ENV lights the scene [its own image-based light, else studio]")
      .choices(demo_words())
      .group("Light");
  add_root(command, o.order.light.load.root).group("Light");
  add_texture_memory(command, o.order.light.load.texture_memory).group("Light");
  add_scene_choice(command, o.order.light.load.scene).group("Light");
  add_measures(command, o.order.light.load.measures, "Light");
  add_value(command, "--at", "X,Y,Z", o.at, parse_vec3, "That point, metres").group("Light");
  add_value(command, "--spp", "N", o.order.light.samples, count_within(1, kMostSpp),
            "Samples per texel of what it sees [64]")
      .group("Light");
}

void add_rest(Command& command, BakeOptions& o) {
  constexpr int kMostDirections = 100000;
  constexpr float kMostIntensity = 1e30f;
  constexpr int kMostTable = 1024;
  add_value(
      command, "--env-rotation", "DEG", o.order.light.rotation,
      [](const std::string& text) { return candela::radians(parse_number(text, -36000.0f, 36000.0f)); },
      "Turns the environment about +y [0]")
      .group("Light");
  add_value(
      command, "--env-intensity", "X", o.order.light.intensity,
      [](const std::string& text) { return parse_number(text, 0.0f, kMostIntensity); },
      "Multiplies the environment [1]")
      .group("Light");
  command.flag("--extract-sun", o.order.extracts_suns, "Also the sun as numbers and the environment without it")
      .group("Light");
  add_value(command, "--proof", "N", o.order.settings.proof_directions, count_within(0, kMostDirections),
            "Directions per level that are compared with the exact integral [16]")
      .group("Proof");
  add_value(command, "--error", "X", o.order.settings.error, parse_share,
            "Refine until no level errs by more at its texels: 0.001 or 0.1%")
      .group("Proof");
  add_value(
      command, "--report", "FILE.html", o.report, [](const std::string& text) { return text; },
      "The errors as a page with pictures")
      .group("Proof");
  command.flag("--json", o.json, "The errors as one JSON object on standard output").group("Proof");
  command.flag("--tables", o.tables, "Also the split-sum tables; alone without an environment").group("Tables");
  add_value(command, "--table-size", "N", o.table_size, count_within(2, kMostTable), "Their width and height [128]")
      .group("Tables");
  add_value(command, "--threads", "N", o.threads, count_within(0, kMostThreads),
            "0 is all; the result does not depend on it [0]")
      .group("Running");
  command.flag("-q,--quiet", o.quiet, "Nothing on standard error but errors").group("Running");
}

void check_usage(const BakeOptions& o) {
  if (!o.order.has_light() && !o.tables)
    throw UsageError("what to bake is missing: an environment, a scene, or --tables");
  if (o.output.empty()) throw UsageError("where to is missing: -o DIR");
  if (!o.order.has_light() && !o.report.empty()) throw UsageError("--report: there is no environment to report on");
  if (!o.order.has_light() && o.order.extracts_suns) throw UsageError("--extract-sun: there is no environment");
  if (!o.order.light.scene.empty() && !o.at) throw UsageError("--from-scene: from where is missing: --at X,Y,Z");
  if (o.order.light.axes && o.order.light.scene.empty() && is_built_in_environment(o.order.light.environment)) {
    throw UsageError("--axes: " + o.order.light.environment + " is no cube map");
  }
  if (o.order.light.scene.empty() && o.at) throw UsageError("--at: there is no scene, see --from-scene");
  if (o.order.profile != nullptr && (o.mapping || o.has_format)) {
    throw UsageError("--profile: " + std::string(o.order.profile->name) + " has its own --mapping and --format");
  }
}

/// What nothing that the engine takes depends on.
template <class Refuse>
void check_profile(const ibl::Profile& profile, const Refuse& refuse) {
  const std::string name(profile.name);
  const bool has_diffuse_map = profile.diffuse_map != ibl::DiffuseUnit::none;
  refuse({"--sheen"}, name + " has no levels of the sheen lobe");
  if (!profile.is_filtered) refuse({"--levels", "--method", "--error"}, name + " filters level 0 itself");
  if (!has_diffuse_map) refuse({"--irradiance", "--irradiance-size"}, name + " takes no cube of diffuse light");
  if (profile.diffuse_sh == ibl::DiffuseUnit::none) {
    refuse({"--sh-order", "--window"}, name + " takes no harmonics");
  } else {
    refuse({"--sh-order"}, name + " takes three bands of harmonics");
  }
  if (!profile.table) refuse({"--tables", "--table-size"}, name + " has its own table");
}

/// What has no effect beside other options is not silently ignored.
void check_combinations(const Command& command, const BakeOptions& o) {
  const auto refuse = [&](std::initializer_list<const char*> options, const std::string& why) {
    for (const char* option : options) {
      if (command.has(option)) throw UsageError(std::string(option) + ": " + why);
    }
  };
  if (!o.compared.empty()) {
    for (const std::string& name : command.given()) {
      const bool counts = name == "--diff" || name == "--axes" || name == "--json" || name == "--threads" ||
                          name == "--quiet" || name == "--help";
      if (!counts) throw UsageError(name + ": --diff compares two files and bakes nothing");
    }
    return;
  }
  if (!o.order.has_light() && o.tables) {
    refuse({"--size", "--levels", "--mapping", "--method", "--samples", "--sheen", "--irradiance", "--irradiance-size",
            "--sh-order", "--window", "--env-rotation", "--env-intensity", "--proof", "--error", "--axes"},
           "there is no environment");
  }
  using ibl::IrradianceMethod;
  using ibl::Method;
  const Method method = o.order.settings.specular.method;
  if (method != Method::fis && method != Method::montecarlo &&
      o.order.settings.irradiance_method == IrradianceMethod::exact) {
    refuse({"--samples"}, "only for --method fis or montecarlo and --irradiance riemann or montecarlo");
  }
  if (!o.tables) refuse({"--table-size"}, "only with --tables");
  if (o.order.light.scene.empty())
    refuse({"--spp", "--root", "--texture-memory", "--scene", "--unit", "--up"}, "only with --from-scene");
  if (!o.order.light.scene.empty()) refuse({"--axes"}, "only for cube maps that are read");
  if (o.order.profile != nullptr) check_profile(*o.order.profile, refuse);
}

void check_paths(const BakeOptions& o) {
  std::error_code code;
  if (fs::exists(o.output, code) && !fs::is_directory(o.output, code)) throw Error("is not a folder", o.output);
  check_writable(fs::is_directory(o.output, code) ? fs::path(o.output) / "bake.json" : fs::path(o.output));
  if (o.report.empty()) return;
  check_writable(o.report);
}

/// The files that it is made of.
Inputs inputs_of(const BakeOptions& o) {
  Inputs inputs;
  inputs.add_environment(o.order.light.environment);
  if (!o.order.light.scene.empty()) {
    inputs.add(o.order.light.scene, "the scene " + o.order.light.scene);
    add_scene_files({o.order.light.scene}, o.order.light.load.root, inputs);
  }
  return inputs;
}

/// What follows from several options together.
void finish_order(BakeOptions& o) {
  BakeOrder& order = o.order;
  ibl::BakeSettings& settings = order.settings;
  settings.size = o.size.value_or(settings.size);
  settings.levels = o.levels.value_or(settings.levels);
  settings.mapping = o.mapping.value_or(settings.mapping);
  settings.irradiance_samples = settings.specular.samples;
  if (o.at) order.light.position = *o.at;
  if (o.tables) order.table_size = o.table_size;
  if (order.profile != nullptr) follow_profile(o.size, o.levels, order);
  if (order.format.kind == BakeFormat::Kind::gltf) follow_gltf(o.levels, o.mapping, order);
  check_usage(o);
  try {
    check_order(order);
  } catch (const Error& error) {
    throw UsageError(error.what());
  }
}

void run_diff(const BakeOptions& o) {
  const std::string& a = o.compared[0];
  const std::string& b = o.compared[1];
  const std::vector<CubeLevelDifference> levels =
      diff_cubemaps(read_cubemap(a, o.order.light.axes), read_cubemap(b, o.order.light.axes));
  print(o.json ? diff_json(levels) : diff_text(levels));
}

/// What it makes, up to whole files in their place; returns these. Throws Interrupted before any is.
std::vector<BakeFile> make_bake(const BakeOptions& o, const Inputs& inputs, ProgressLine& progress,
                                BakeResult& result) {
  Job job = progress.job();
  const StopScope stop(job.stop);
  const LightChoice& choice = o.order.light;
  Diagnostics diagnostics;
  job.diagnostics = &diagnostics;
  std::optional<LoadedLight> light;
  if (o.order.has_light()) {
    progress.phase(choice.scene.empty() ? "loading " + choice.environment : "capturing " + choice.scene);
    light = load_light(choice, o.order.settings.size, job);
  }
  for (const Diagnostic& warning : diagnostics.warnings()) progress.warn(warning);
  result = bake(o.order, light ? &*light : nullptr, job);
  result.warnings = diagnostics.warnings();
  progress.phase("writing");
  const std::size_t told = result.warnings.size();
  std::vector<BakeFile> files = write_bake(o.output, inputs, o.report, result);
  for (std::size_t i = told; i < result.warnings.size(); ++i) progress.warn(result.warnings[i]);
  return files;
}

void run_bake(const BakeOptions& o) {
  check_paths(o);
  const Inputs inputs = inputs_of(o);
  if (!o.report.empty()) inputs.refuse(o.report);
  const ThreadLimit threads(o.threads);
  ProgressLine progress(o.quiet);
  const Interrupt interrupt;
  BakeResult result;
  std::vector<BakeFile> files;
  try {
    files = make_bake(o, inputs, progress, result);
  } catch (const Interrupted&) {
    throw Interrupted("the bake is not done, and no file of it is written");
  }
  progress.clear();
  if (!o.report.empty()) {
    const FolderFor folder(o.report);
    write_file(o.report, bake_html(result));
  }
  if (o.json) return print(bake_json(result, files));
  print(bake_text(result) + (o.order.profile != nullptr && o.order.has_light() ? profile_text(*o.order.profile) : ""));
}

}  // namespace

Verb add_bake(Command& command) {
  const auto options = std::make_shared<BakeOptions>();
  command
      .text("ENV", options->order.light.environment,
            "An equirectangular .exr (:LAYER), .hdr, .png, .jpg, .webp or .avif; a cube map: .ktx2, .ktx, .dds, a "
            "cross or strip, a folder of six faces or a pattern with %s; or studio, sky, sky:DEG, furnace")
      .choices(environment_words());
  command.text("-o,--output", options->output, "Folder to write to; it is made where it is absent").type("DIR");
  add_cube(command, *options);
  add_diffuse(command, *options);
  add_files(command, *options);
  add_scene(command, *options);
  add_rest(command, *options);
  command.footer(
      "Examples:\n  candela bake street.hdr -o street\n  candela bake street.hdr -o street --error 0.1% --report "
      "street.html\n  candela bake sky:20 -o dusk --extract-sun --sh-order 4 --window auto\n  candela bake street.hdr "
      "-o app/public --profile three --tables\n  candela bake --from-scene room.glb --at 0,1.6,0 sky -o probe --format "
      "ktx2\n  candela bake --diff old/specular.ktx2 new/specular.ktx2\n  candela bake --tables -o tables");
  command.short_help(
      {"--output", "--profile", "--size", "--levels", "--format", "--from-scene", "--at", "--error", "--tables",
       "--report", "--quiet", "--help"},
      "`candela bake --help all` lists every option.\n\nExamples:\n  candela bake street.hdr -o street\n  "
      "candela bake street.hdr -o app/public --profile three\n  candela bake street.hdr -o street --error "
      "0.1% --report street.html\n  candela bake --from-scene room.glb --at 0,1.6,0 sky -o probe");
  return [options, &command] {
    options->has_format = command.has("--format");
    check_combinations(command, *options);
    if (!options->compared.empty()) return run_diff(*options);
    finish_order(*options);
    run_bake(*options);
  };
}

}  // namespace candela::cli
