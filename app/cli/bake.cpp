#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "base/diagnostics.h"
#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "candela/candela.h"
#include "cli/bake_output.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_outputs.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "content/make_environment.h"
#include "ibl/cube.h"
#include "image/cube_file.h"
#include "image/cube_metrics.h"
#include "image/image_file.h"
#include "path/capture.h"
#include "scene/environment.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

struct BakeOptions {
  std::string environment;
  std::string output;
  std::string report;
  std::string scene;
  std::string root;
  std::string scene_choice;
  const ibl::Profile* profile = nullptr;
  std::optional<vec3> at;
  std::optional<CubeAxes> axes;
  std::vector<std::string> compared;  ///< the two of --diff
  BakeFormat format;
  ibl::BakeSettings bake;
  int spp = 64;
  bool has_size = false;
  bool has_levels = false;
  bool has_mapping = false;
  bool has_format = false;
  float rotation = 0.0f;
  float intensity = 1.0f;
  bool tables = false;
  int table_size = 128;
  bool extract_sun = false;
  bool json = false;
  bool quiet = false;
  int threads = 0;
};

template <class T, std::size_t n>
auto one_of(std::array<std::pair<std::string_view, T>, n> choices) {
  return [choices](const std::string& text) {
    std::string known;
    for (const auto& [name, value] : choices) {
      if (text == name) return value;
      known += (known.empty() ? "" : ", ") + std::string(name);
    }
    throw UsageError(fmt::format("'{}' is none of {}", text, known));
  };
}

/// A share, plain or in per cent: "0.005" or "0.5%".
double parse_share(const std::string& text) {
  const bool percent = text.ends_with('%');
  const float value = parse_number(percent ? text.substr(0, text.size() - 1) : text, 1e-7f, percent ? 100.0f : 1.0f);
  return static_cast<double>(value) * (percent ? 0.01 : 1.0);
}

void add_cube(CLI::App* verb, BakeOptions& o) {
  using ibl::Mapping;
  using ibl::Method;
  constexpr int kMostSize = 4096;
  constexpr int kMostLevels = 13;
  constexpr int kMostSamples = 1 << 20;
  const std::string group = "Specular";
  add_value(verb, "--size", "N", o.bake.size, count_within(1, kMostSize), "Texels along a face of level 0 [256]")
      ->group(group);
  add_value(verb, "--levels", "N", o.bake.levels, count_within(1, kMostLevels), "Each half the size of the last [6]")
      ->group(group);
  add_value(verb, "--mapping", "NAME", o.bake.mapping,
            one_of<Mapping, 3>(
                {{{"balanced", Mapping::balanced}, {"linear", Mapping::linear}, {"filament", Mapping::filament}}}),
            "Roughness of the levels: balanced (its square halves as texels do), linear, filament [balanced]")
      ->group(group);
  add_value(verb, "--method", "NAME", o.bake.specular.method,
            one_of<Method, 5>({{{"auto", Method::automatic},
                                {"zonal", Method::zonal},
                                {"hierarchical", Method::hierarchical},
                                {"fis", Method::fis},
                                {"montecarlo", Method::montecarlo}}}),
            "zonal, hierarchical; fis and montecarlo for comparison [auto: zonal where the lobe allows]")
      ->group(group);
  add_value(verb, "--samples", "N", o.bake.specular.samples, count_within(1, kMostSamples),
            "Of fis, montecarlo and riemann, per texel [1024]")
      ->group(group);
  verb->add_flag("--sheen", o.bake.sheen, "Also the levels of the sheen lobe")->group(group);
}

void add_diffuse(CLI::App* verb, BakeOptions& o) {
  using ibl::IrradianceMethod;
  using ibl::Window;
  constexpr int kMostSize = 1024;
  const std::string group = "Diffuse";
  add_value(verb, "--irradiance", "NAME", o.bake.irradiance_method,
            one_of<IrradianceMethod, 3>({{{"exact", IrradianceMethod::exact},
                                          {"riemann", IrradianceMethod::riemann},
                                          {"montecarlo", IrradianceMethod::montecarlo}}}),
            "exact; riemann and montecarlo for comparison [exact]")
      ->group(group);
  add_value(verb, "--irradiance-size", "N", o.bake.irradiance_size, count_within(1, kMostSize),
            "Texels along a face [32]")
      ->group(group);
  add_value(verb, "--sh-order", "L", o.bake.sh_order, count_within(0, ibl::kMostShOrder),
            "Highest degree of the spherical harmonics [2: nine of them]")
      ->group(group);
  add_value(verb, "--window", "NAME", o.bake.window,
            one_of<Window, 4>({{{"none", Window::none},
                                {"hann", Window::hann},
                                {"lanczos", Window::lanczos},
                                {"auto", Window::automatic}}}),
            "Damps their ringing: none, hann, lanczos, auto (as little as leaves nothing negative) [none]")
      ->group(group);
}

BakeFormat parse_format(const std::string& text) {
  using Kind = BakeFormat::Kind;
  const auto texture = [](TextureContainer container, TexelFormat format) {
    return BakeFormat{Kind::texture, "", {.container = container, .format = format}};
  };
  return one_of<BakeFormat, 12>({{{"exr", {}},
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
                                  {"dds-rgba32f", texture(TextureContainer::dds, TexelFormat::rgba32f)}}})(text);
}

CubeAxes parse_axes_option(const std::string& text) {
  if (const auto axes = parse_axes(text)) return *axes;
  throw UsageError("'" + text + "' is no three signed axes such as -x+y+z");
}

void add_files(CLI::App* verb, BakeOptions& o) {
  const std::string group = "Files";
  add_value(
      verb, "--profile", "ENGINE", o.profile, [](const std::string& text) { return &ibl::find_profile(text); },
      "What an engine reads: filament, three, babylon, khronos, bevy, godot, unreal, unity")
      ->group(group);
  add_value(verb, "--format", "NAME", o.format, parse_format,
            "exr, hdr (six faces a level), panorama, rgbm, gltf (EXT_lights_image_based), ktx2, ktx2-rgba32f, "
            "ktx2-rgb9e5, ktx1, ktx1-rgba16f, dds, dds-rgba32f [exr]")
      ->group(group);
  add_value(verb, "--axes", "AXES", o.axes, parse_axes_option,
            "By which a cube map that is read is looked up, in terms of the world's: -x+y+z is as seen from inside")
      ->group(group);
  verb->add_option("--diff", o.compared, "Compare two baked cube maps, level by level, and bake nothing")
      ->type_name("FILE")
      ->expected(2)
      ->group(group);
}

void add_scene(CLI::App* verb, BakeOptions& o) {
  constexpr int kMostSpp = 1 << 20;
  add_value(
      verb, "--from-scene", "SCENE", o.scene, [](const std::string& text) { return text; },
      "Bake what a point of a scene sees, path traced; ENV lights the scene [its own image-based light, else studio]")
      ->group("Light");
  add_root(verb, o.root)->group("Light");
  add_scene_choice(verb, o.scene_choice)->group("Light");
  add_value(verb, "--at", "X,Y,Z", o.at, parse_vec3, "That point, metres")->group("Light");
  add_value(verb, "--spp", "N", o.spp, count_within(1, kMostSpp), "Samples per texel of what it sees [64]")
      ->group("Light");
}

void add_rest(CLI::App* verb, BakeOptions& o) {
  constexpr int kMostDirections = 100000;
  constexpr float kMostIntensity = 1e30f;
  constexpr int kMostTable = 1024;
  constexpr int kMostThreads = 1024;
  add_value(
      verb, "--env-rotation", "DEG", o.rotation,
      [](const std::string& text) { return candela::radians(parse_number(text, -36000.0f, 36000.0f)); },
      "Turns the environment about +y [0]")
      ->group("Light");
  add_value(
      verb, "--env-intensity", "X", o.intensity,
      [](const std::string& text) { return parse_number(text, 0.0f, kMostIntensity); },
      "Multiplies the environment [1]")
      ->group("Light");
  verb->add_flag("--extract-sun", o.extract_sun, "Also the sun as numbers and the environment without it")
      ->group("Light");
  add_value(verb, "--proof", "N", o.bake.proof_directions, count_within(0, kMostDirections),
            "Directions per level that are compared with the exact integral [16]")
      ->group("Proof");
  add_value(verb, "--error", "X", o.bake.error, parse_share,
            "Refine until no level errs by more at its texels: 0.001 or 0.1%")
      ->group("Proof");
  add_value(
      verb, "--report", "FILE.html", o.report, [](const std::string& text) { return text; },
      "The errors as a page with pictures")
      ->group("Proof");
  verb->add_flag("--json", o.json, "The errors as one JSON object on standard output")->group("Proof");
  verb->add_flag("--tables", o.tables, "Also the split-sum tables; alone without an environment")->group("Tables");
  add_value(verb, "--table-size", "N", o.table_size, count_within(2, kMostTable), "Their width and height [128]")
      ->group("Tables");
  add_value(verb, "--threads", "N", o.threads, count_within(0, kMostThreads),
            "0 is all; the result does not depend on it [0]")
      ->group("Running");
  verb->add_flag("-q,--quiet", o.quiet, "Nothing on standard error but errors")->group("Running");
}

/// A panorama of a file.
Environment make_panorama(Image image, const std::string& path, std::vector<Diagnostic>& warnings) {
  check_panorama(image, path);
  const ImageFormat format = sniff_image_format(read_head(parse_image_name(path).path, kSniffedBytes));
  if (is_display_format(format)) {
    warnings.push_back(
        {"8 or 16 bits per channel end at white: what is brighter, the sun above all, is missing", path});
  }
  Environment environment;
  environment.name = path;
  environment.map = std::make_shared<Image>(std::move(image));
  return environment;
}

CubeFaces make_faces(Cubemap cube, const BakeOptions& o) {
  CubeFaces faces = std::move(cube.levels.at(0));
  for (Image& face : faces)
    for (float& v : face.pixels) v *= o.intensity;
  return faces;
}

/// As --env-rotation and --env-intensity say.
Environment adjusted(Environment environment, const BakeOptions& o) {
  environment.rotation += o.rotation;
  environment.intensity *= o.intensity;
  return environment;
}

CubeFaces capture(const BakeOptions& o, ProgressLine& progress, std::vector<Diagnostic>& warnings) {
  Diagnostics diagnostics;
  const Scene scene = load(o.scene, &diagnostics, LoadOptions{.root = o.root, .scene = o.scene_choice});
  const Environment environment =
      adjusted(o.environment.empty() && scene.image_light
                   ? scene.image_light->environment
                   : make_environment(o.environment.empty() ? "studio" : o.environment, &diagnostics),
               o);
  warnings.insert(warnings.end(), diagnostics.warnings().begin(), diagnostics.warnings().end());
  path::Settings settings;
  settings.samples = o.spp;
  path::Callbacks callbacks;
  callbacks.progress = [&](const path::Progress& p) { progress.update(p); };
  callbacks.stop = &Interrupt::requested();
  path::Statistics statistics;
  const Cubemap seen =
      path::capture_environment(scene, environment, *o.at, o.bake.size, settings, &statistics, callbacks);
  if (statistics.interrupted) throw Interrupted("while the scene was captured");
  return seen.levels.at(0);
}

/// What is baked, and the cube that it came as where it did.
struct Light {
  ibl::Source source;
  std::optional<CubeFaces> faces;
  bool is_panorama = false;  ///< the source is a file's own panorama
};

Light load_light(const BakeOptions& o, ProgressLine& progress, std::vector<Diagnostic>& warnings) {
  Light light;
  if (!o.scene.empty()) {
    light.faces = capture(o, progress, warnings);
    light.source = ibl::make_source(*light.faces);
    return light;
  }
  const bool is_built_in = is_built_in_environment(o.environment);
  EnvironmentFile file;
  if (!is_built_in) file = read_clean_environment(o.environment, o.axes);
  warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
  if (!file.cube.empty()) {
    light.faces = make_faces(std::move(file.cube), o);
    light.source = ibl::make_source(*light.faces);
    light.source.rotation += static_cast<double>(o.rotation);
    if (o.rotation != 0.0f) light.faces.reset();
    return light;
  }
  if (o.axes) throw UsageError("--axes: " + o.environment + " is no cube map");
  const Environment environment = adjusted(
      is_built_in ? make_environment(o.environment) : make_panorama(std::move(file.panorama), o.environment, warnings),
      o);
  light.source = ibl::make_source(environment);
  light.is_panorama = environment.map != nullptr && environment.rotation == 0.0f && environment.suns.empty();
  return light;
}

/// A mirror shows a cube's own texels where the sizes allow, not what a panorama between made of them.
void keep_texels(const CubeFaces& faces, ibl::Bake& bake) {
  if (bake.levels.at(0).roughness != 0.0) return;
  int size = faces[0].width;
  if (size % bake.specular.size() != 0 || (size & (size - 1)) != 0) return;
  const Cubemap halved = ibl::cube_mips(faces);
  std::size_t level = 0;
  for (; size > bake.specular.size(); size /= 2) ++level;
  bake.specular.levels[0] = halved.levels.at(level);
}

/// What the baker holds at once: the panorama, its sums and its harmonics, and directions and values of the faces.
void check_memory(const BakeOptions& o, const ibl::Source& source) {
  constexpr std::uint64_t kPerTexel = 96, kPerFaceTexel = 160, kAlways = std::uint64_t{1} << 28;
  const auto texels = static_cast<std::uint64_t>(source.map.width) * static_cast<std::uint64_t>(source.map.height);
  const auto size = static_cast<std::uint64_t>(o.bake.size);
  require_memory(kAlways + texels * kPerTexel + 6 * size * size * kPerFaceTexel, available_memory(),
                 fmt::format("a bake of {0}x{0} texels", o.bake.size), "--size");
}

bool has_light(const BakeOptions& o) { return !o.environment.empty() || !o.scene.empty(); }

void check_usage(const BakeOptions& o) {
  if (!has_light(o) && !o.tables) throw UsageError("what to bake is missing: an environment, a scene, or --tables");
  if (o.output.empty()) throw UsageError("where to is missing: -o DIR");
  if (!has_light(o) && !o.report.empty()) throw UsageError("--report: there is no environment to report on");
  if (!has_light(o) && o.extract_sun) throw UsageError("--extract-sun: there is no environment");
  if (!o.scene.empty() && !o.at) throw UsageError("--from-scene: from where is missing: --at X,Y,Z");
  if (o.scene.empty() && o.at) throw UsageError("--at: there is no scene, see --from-scene");
  if (o.profile != nullptr && (o.has_mapping || o.has_format)) {
    throw UsageError("--profile: " + std::string(o.profile->name) + " has its own --mapping and --format");
  }
  if (o.bake.error > 0.0 && o.bake.proof_directions == 0)
    throw UsageError("--error: nothing is measured with --proof 0");
  if (o.bake.size % (1 << (o.bake.levels - 1)) != 0) {
    throw UsageError(
        fmt::format("--levels: {} do not halve a face of {} texels without rest", o.bake.levels, o.bake.size));
  }
  if (o.bake.specular.method == ibl::Method::fis && (o.bake.size & (o.bake.size - 1)) != 0) {
    throw UsageError("--method: fis needs a --size that is a power of two");
  }
}

/// What has no effect beside other options is not silently ignored.
void check_combinations(const CLI::App& verb, const BakeOptions& o) {
  const auto refuse = [&](std::initializer_list<const char*> options, const std::string& why) {
    for (const char* option : options) {
      if (verb.count(option) > 0) throw UsageError(std::string(option) + ": " + why);
    }
  };
  if (!o.compared.empty()) {
    for (const CLI::Option* option : verb.get_options()) {
      const std::string name = option->get_name();
      const bool counts = name == "--diff" || name == "--axes" || name == "--json" || name == "--threads" ||
                          name == "--quiet" || name == "--help";
      if (option->count() > 0 && !counts) throw UsageError(name + ": --diff compares two files and bakes nothing");
    }
    return;
  }
  if (!has_light(o) && o.tables) {
    refuse({"--size", "--levels", "--mapping", "--method", "--samples", "--sheen", "--irradiance", "--irradiance-size",
            "--sh-order", "--window", "--env-rotation", "--env-intensity", "--proof", "--error", "--axes"},
           "there is no environment");
  }
  using ibl::IrradianceMethod;
  using ibl::Method;
  const Method method = o.bake.specular.method;
  if (method != Method::fis && method != Method::montecarlo && o.bake.irradiance_method == IrradianceMethod::exact) {
    refuse({"--samples"}, "only for --method fis or montecarlo and --irradiance riemann or montecarlo");
  }
  if (!o.tables) refuse({"--table-size"}, "only with --tables");
  if (o.scene.empty()) refuse({"--spp", "--root", "--scene"}, "only with --from-scene");
  if (!o.scene.empty()) refuse({"--axes"}, "only for cube maps that are read");
  if (o.format.kind == BakeFormat::Kind::gltf) refuse({"--sheen"}, "--format gltf has no levels of the sheen lobe");
  if (o.profile != nullptr) refuse({"--sheen"}, std::string(o.profile->name) + " has no levels of the sheen lobe");
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
  inputs.add_environment(o.environment);
  if (!o.scene.empty()) {
    inputs.add(o.scene, "the scene " + o.scene);
    add_scene_files({o.scene}, o.root, inputs);
  }
  return inputs;
}

/// What the engine expects, where nothing else is asked for.
void follow_profile(const ibl::Profile& profile, BakeOptions& o) {
  if (!o.has_size) o.bake.size = profile.size;
  if (!o.has_levels) o.bake.levels = profile.levels;
  o.bake.roughness.clear();
  for (int level = 0; level < o.bake.levels; ++level) {
    o.bake.roughness.push_back(
        static_cast<double>(ibl::roughness_of_level(profile, level, o.bake.levels, o.bake.size)));
  }
}

/// EXT_lights_image_based: roughness grows evenly with the levels, of which the last is about 16 x 16.
void follow_gltf(BakeOptions& o) {
  constexpr int kLevels = 5;
  if (!o.has_levels) o.bake.levels = kLevels;
  if (!o.has_mapping) o.bake.mapping = ibl::Mapping::linear;
  if (o.bake.mapping != ibl::Mapping::linear) throw UsageError("--mapping: --format gltf has linear levels");
  if ((o.bake.size & (o.bake.size - 1)) != 0) throw UsageError("--size: --format gltf needs a power of two");
  if (o.bake.sh_order < 2) throw UsageError("--sh-order: --format gltf needs degree 2");
}

double since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check_bound(const ibl::Bake& bake, double error) {
  const auto look = [&](const std::string& name, const ibl::Level& level) {
    if (level.holds) return;
    throw Error(fmt::format("{} errs by {:.2g} %, which {} refinements did not bring below {:.2g} %", name,
                            100.0 * level.proof.at_texels.max, level.refinements, 100.0 * error),
                "--error");
  };
  for (const ibl::Level& level : bake.levels) look(fmt::format("roughness {:.4g}", level.roughness), level);
  for (const ibl::Level& level : bake.sheen_levels) look(fmt::format("sheen {:.4g}", level.roughness), level);
  look("irradiance", bake.irradiance_level);
}

void run_diff(const BakeOptions& o) {
  const std::string& a = o.compared[0];
  const std::string& b = o.compared[1];
  const std::vector<CubeLevelDifference> levels = diff_cubemaps(read_cubemap(a, o.axes), read_cubemap(b, o.axes));
  print(o.json ? diff_json(levels) : diff_text(levels));
}

/// All of the work, up to whole files in their place. Throws Interrupted before any is.
void make_bake(BakeOptions& o, const Inputs& inputs, ProgressLine& progress, BakeResult& result) {
  const StopScope stop(&Interrupt::requested());
  o.bake.irradiance_samples = o.bake.specular.samples;
  o.bake.specular.fis_size = o.bake.size;
  const std::string& from = o.scene.empty() ? o.environment : o.scene;
  result.name = !has_light(o) ? "tables" : is_built_in_environment(from) ? from : fs::path(from).filename().string();
  result.settings = o.bake;
  result.format = o.format;
  result.profile = o.profile;
  if (has_light(o)) {
    progress.phase((o.scene.empty() ? "loading " : "capturing ") + from);
    const Light light = load_light(o, progress, result.warnings);
    const ibl::Source& source = light.source;
    for (const Diagnostic& warning : result.warnings) progress.warn(warning);
    check_memory(o, source);
    const auto start = std::chrono::steady_clock::now();
    result.bake = ibl::bake(source, o.bake, [&](const ibl::BakeProgress& p) { progress.update(p.fraction, p.what); });
    result.bake_s = since(start);
    if (light.faces) keep_texels(*light.faces, *result.bake);
    if (light.is_panorama) result.panorama = source.map;
    check_bound(*result.bake, o.bake.error);
    if (o.extract_sun) result.suns = ibl::extract_suns(source);
  }
  if (o.tables) {
    progress.phase("tables");
    const auto start = std::chrono::steady_clock::now();
    result.tables = ibl::make_tables(o.table_size);
    result.tables_s = since(start);
  }
  progress.phase("writing");
  const std::size_t told = result.warnings.size();
  write_bake(o.output, inputs, o.report, result);
  for (std::size_t i = told; i < result.warnings.size(); ++i) progress.warn(result.warnings[i]);
}

void run_bake(BakeOptions& o) {
  if (!o.compared.empty()) return run_diff(o);
  if (o.profile != nullptr) follow_profile(*o.profile, o);
  if (o.format.kind == BakeFormat::Kind::gltf) follow_gltf(o);
  check_usage(o);
  check_paths(o);
  const Inputs inputs = inputs_of(o);
  if (!o.report.empty()) inputs.refuse(o.report);
  const ThreadLimit threads(o.threads);
  ProgressLine progress(o.quiet);
  const Interrupt interrupt;
  BakeResult result;
  try {
    make_bake(o, inputs, progress, result);
  } catch (const Interrupted&) {
    throw Interrupted("the bake is not done, and no file of it is written");
  }
  progress.clear();
  if (!o.report.empty()) write_file(o.report, bake_html(result));
  print(o.json ? bake_json(result) : bake_text(result));
}

}  // namespace

Verb add_bake(CLI::App& app) {
  const auto options = std::make_shared<BakeOptions>();
  CLI::App* verb = app.add_subcommand("bake", "Image-based light for engines, with its error measured")->group("Verbs");
  verb->add_option("ENV", options->environment,
                   "An equirectangular .exr (:LAYER), .hdr or .png; a cube map: .ktx2, .ktx, .dds, a cross or strip, a "
                   "folder of "
                   "six faces or a pattern with %s; or studio, sky, sky:DEG, furnace")
      ->type_name("");
  verb->add_option("-o,--output", options->output, "Folder to write to; it is made where it is absent")
      ->type_name("DIR");
  add_cube(verb, *options);
  add_diffuse(verb, *options);
  add_files(verb, *options);
  add_scene(verb, *options);
  add_rest(verb, *options);
  verb->footer(
      "Examples:\n  candela bake street.hdr -o street\n  candela bake street.hdr -o street --error 0.1% --report "
      "street.html\n  candela bake sky:20 -o dusk --extract-sun --sh-order 4 --window auto\n  candela bake street.hdr "
      "-o app/public --profile three --tables\n  candela bake --from-scene room.glb --at 0,1.6,0 sky -o probe --format "
      "ktx2\n  candela bake --diff old/specular.ktx2 new/specular.ktx2\n  candela bake --tables -o tables");
  return [options, verb] {
    options->has_size = verb->count("--size") > 0;
    options->has_levels = verb->count("--levels") > 0;
    options->has_mapping = verb->count("--mapping") > 0;
    options->has_format = verb->count("--format") > 0;
    check_combinations(*verb, *options);
    run_bake(*options);
  };
}

}  // namespace candela::cli
