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
#include "base/memory.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "candela/light.h"
#include "cli/bake_output.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_outputs.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "image/cube_file.h"
#include "image/cube_metrics.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

struct BakeOptions {
  LightChoice light;
  std::string output;
  std::string report;
  const ibl::Profile* profile = nullptr;
  std::optional<vec3> at;             ///< a point of the scene
  std::vector<std::string> compared;  ///< the two of --diff
  BakeFormat format;
  ibl::BakeSettings bake;
  bool has_size = false;
  bool has_levels = false;
  bool has_mapping = false;
  bool has_format = false;
  bool tables = false;
  int table_size = 128;
  bool extract_sun = false;
  bool json = false;
  bool quiet = false;
  int threads = 0;
};

template <class T, std::size_t n>
auto one_of(const std::array<std::pair<std::string_view, T>, n>& choices) {
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

void add_cube(Command& command, BakeOptions& o) {
  using ibl::Mapping;
  using ibl::Method;
  constexpr int kMostSize = 4096;
  constexpr int kMostLevels = 13;
  constexpr int kMostSamples = 1 << 20;
  const std::string group = "Specular";
  add_value(command, "--size", "N", o.bake.size, count_within(1, kMostSize), "Texels along a face of level 0 [256]")
      .group(group);
  add_value(command, "--levels", "N", o.bake.levels, count_within(1, kMostLevels), "Each half the size of the last [6]")
      .group(group);
  add_value(command, "--mapping", "NAME", o.bake.mapping,
            one_of<Mapping, 3>(
                {{{"balanced", Mapping::balanced}, {"linear", Mapping::linear}, {"filament", Mapping::filament}}}),
            "Roughness of the levels: balanced (its square halves as texels do), linear, filament [balanced]")
      .group(group);
  add_value(command, "--method", "NAME", o.bake.specular.method,
            one_of<Method, 5>({{{"auto", Method::automatic},
                                {"zonal", Method::zonal},
                                {"hierarchical", Method::hierarchical},
                                {"fis", Method::fis},
                                {"montecarlo", Method::montecarlo}}}),
            "zonal, hierarchical; fis and montecarlo for comparison [auto: zonal where the lobe allows]")
      .group(group);
  add_value(command, "--samples", "N", o.bake.specular.samples, count_within(1, kMostSamples),
            "Of fis, montecarlo and riemann, per texel [1024]")
      .group(group);
  command.flag("--sheen", o.bake.sheen, "Also the levels of the sheen lobe").group(group);
}

void add_diffuse(Command& command, BakeOptions& o) {
  using ibl::IrradianceMethod;
  using ibl::Window;
  constexpr int kMostSize = 1024;
  const std::string group = "Diffuse";
  add_value(command, "--irradiance", "NAME", o.bake.irradiance_method,
            one_of<IrradianceMethod, 3>({{{"exact", IrradianceMethod::exact},
                                          {"riemann", IrradianceMethod::riemann},
                                          {"montecarlo", IrradianceMethod::montecarlo}}}),
            "exact; riemann and montecarlo for comparison [exact]")
      .group(group);
  add_value(command, "--irradiance-size", "N", o.bake.irradiance_size, count_within(1, kMostSize),
            "Texels along a face [32]")
      .group(group);
  add_value(command, "--sh-order", "L", o.bake.sh_order, count_within(0, ibl::kMostShOrder),
            "Highest degree of the spherical harmonics [2: nine of them]")
      .group(group);
  add_value(command, "--window", "NAME", o.bake.window,
            one_of<Window, 4>({{{"none", Window::none},
                                {"hann", Window::hann},
                                {"lanczos", Window::lanczos},
                                {"auto", Window::automatic}}}),
            "Damps their ringing: none, hann, lanczos, auto (as little as leaves nothing negative) [none]")
      .group(group);
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

void add_files(Command& command, BakeOptions& o) {
  const std::string group = "Files";
  add_value(
      command, "--profile", "ENGINE", o.profile, [](const std::string& text) { return &ibl::find_profile(text); },
      "What an engine reads: filament, three, babylon, khronos, bevy, godot, unreal, unity")
      .group(group);
  add_value(command, "--format", "NAME", o.format, parse_format,
            "exr, hdr (six faces a level), panorama, rgbm, gltf (EXT_lights_image_based), ktx2, ktx2-rgba32f, "
            "ktx2-rgb9e5, ktx1, ktx1-rgba16f, dds, dds-rgba32f [exr]")
      .group(group);
  add_value(command, "--axes", "AXES", o.light.axes, parse_axes_option,
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
      command, "--from-scene", "SCENE", o.light.scene, [](const std::string& text) { return text; },
      "Bake what a point of a scene sees, path traced; ENV lights the scene [its own image-based light, else studio]")
      .group("Light");
  add_root(command, o.light.load.root).group("Light");
  add_texture_memory(command, o.light.load.texture_memory).group("Light");
  add_scene_choice(command, o.light.load.scene).group("Light");
  add_measures(command, o.light.load.measures, "Light");
  add_value(command, "--at", "X,Y,Z", o.at, parse_vec3, "That point, metres").group("Light");
  add_value(command, "--spp", "N", o.light.samples, count_within(1, kMostSpp), "Samples per texel of what it sees [64]")
      .group("Light");
}

void add_rest(Command& command, BakeOptions& o) {
  constexpr int kMostDirections = 100000;
  constexpr float kMostIntensity = 1e30f;
  constexpr int kMostTable = 1024;
  constexpr int kMostThreads = 1024;
  add_value(
      command, "--env-rotation", "DEG", o.light.rotation,
      [](const std::string& text) { return candela::radians(parse_number(text, -36000.0f, 36000.0f)); },
      "Turns the environment about +y [0]")
      .group("Light");
  add_value(
      command, "--env-intensity", "X", o.light.intensity,
      [](const std::string& text) { return parse_number(text, 0.0f, kMostIntensity); },
      "Multiplies the environment [1]")
      .group("Light");
  command.flag("--extract-sun", o.extract_sun, "Also the sun as numbers and the environment without it").group("Light");
  add_value(command, "--proof", "N", o.bake.proof_directions, count_within(0, kMostDirections),
            "Directions per level that are compared with the exact integral [16]")
      .group("Proof");
  add_value(command, "--error", "X", o.bake.error, parse_share,
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

/// What the baker holds at once: the panorama, its sums and its harmonics, and directions and values of the faces.
void check_memory(const BakeOptions& o, const ibl::Source& source) {
  constexpr std::uint64_t kPerTexel = 96, kPerFaceTexel = 160, kAlways = std::uint64_t{1} << 28;
  const auto texels = static_cast<std::uint64_t>(source.map.width) * static_cast<std::uint64_t>(source.map.height);
  const auto size = static_cast<std::uint64_t>(o.bake.size);
  require_memory(kAlways + texels * kPerTexel + 6 * size * size * kPerFaceTexel, available_memory(),
                 fmt::format("a bake of {0}x{0} texels", o.bake.size), "--size");
}

bool has_light(const BakeOptions& o) { return !o.light.environment.empty() || !o.light.scene.empty(); }

void check_usage(const BakeOptions& o) {
  if (!has_light(o) && !o.tables) throw UsageError("what to bake is missing: an environment, a scene, or --tables");
  if (o.output.empty()) throw UsageError("where to is missing: -o DIR");
  if (!has_light(o) && !o.report.empty()) throw UsageError("--report: there is no environment to report on");
  if (!has_light(o) && o.extract_sun) throw UsageError("--extract-sun: there is no environment");
  if (!o.light.scene.empty() && !o.at) throw UsageError("--from-scene: from where is missing: --at X,Y,Z");
  if (o.light.axes && o.light.scene.empty() && is_built_in_environment(o.light.environment)) {
    throw UsageError("--axes: " + o.light.environment + " is no cube map");
  }
  if (o.light.scene.empty() && o.at) throw UsageError("--at: there is no scene, see --from-scene");
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
  if (o.light.scene.empty())
    refuse({"--spp", "--root", "--texture-memory", "--scene", "--unit", "--up"}, "only with --from-scene");
  if (!o.light.scene.empty()) refuse({"--axes"}, "only for cube maps that are read");
  if (o.format.kind == BakeFormat::Kind::gltf) refuse({"--sheen"}, "--format gltf has no levels of the sheen lobe");
  if (o.profile != nullptr) check_profile(*o.profile, refuse);
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
  inputs.add_environment(o.light.environment);
  if (!o.light.scene.empty()) {
    inputs.add(o.light.scene, "the scene " + o.light.scene);
    add_scene_files({o.light.scene}, o.light.load.root, inputs);
  }
  return inputs;
}

/// What the engine expects, where nothing else is asked for.
void follow_profile(const ibl::Profile& profile, BakeOptions& o) {
  if (!o.has_size) o.bake.size = profile.size;
  if (!o.has_levels) {
    // Of what the engine filters itself nothing but level 0 is written; a small cube has fewer.
    const auto most = static_cast<int>(std::bit_width(static_cast<unsigned>(o.bake.size)));
    o.bake.levels = profile.is_filtered ? std::min(profile.levels, most) : 1;
  }
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

void run_diff(const BakeOptions& o) {
  const std::string& a = o.compared[0];
  const std::string& b = o.compared[1];
  const std::vector<CubeLevelDifference> levels =
      diff_cubemaps(read_cubemap(a, o.light.axes), read_cubemap(b, o.light.axes));
  print(o.json ? diff_json(levels) : diff_text(levels));
}

/// All of the work, up to whole files in their place. Throws Interrupted before any is.
void make_bake(BakeOptions& o, const Inputs& inputs, ProgressLine& progress, BakeResult& result) {
  Job job = progress.job();
  const StopScope stop(job.stop);
  if (o.at) o.light.position = *o.at;
  o.bake.irradiance_samples = o.bake.specular.samples;
  o.bake.specular.fis_size = o.bake.size;
  const std::string& from = o.light.scene.empty() ? o.light.environment : o.light.scene;
  result.name = !has_light(o) ? "tables" : is_built_in_environment(from) ? from : fs::path(from).filename().string();
  result.settings = o.bake;
  result.format = o.format;
  result.profile = o.profile;
  if (has_light(o)) {
    progress.phase((o.light.scene.empty() ? "loading " : "capturing ") + from);
    Diagnostics diagnostics;
    job.diagnostics = &diagnostics;
    const LoadedLight light = load_light(o.light, o.bake.size, job);
    result.warnings = diagnostics.warnings();
    for (const Diagnostic& warning : result.warnings) progress.warn(warning);
    check_memory(o, light.source);
    const Stopwatch watch;
    result.bake = bake_light(light, o.bake, job);
    result.bake_s = watch.seconds();
    if (light.is_panorama) result.panorama = light.source.map;
    if (o.extract_sun) result.suns = ibl::extract_suns(light.source);
  }
  if (o.tables) {
    progress.phase("tables");
    const Stopwatch watch;
    result.tables = ibl::make_tables(o.table_size);
    result.tables_s = watch.seconds();
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
  if (!o.report.empty()) {
    const FolderFor folder(o.report);
    write_file(o.report, bake_html(result));
  }
  if (o.json) return print(bake_json(result));
  print(bake_text(result) + (o.profile != nullptr && has_light(o) ? profile_text(*o.profile) : ""));
}

}  // namespace

Verb add_bake(Command& command) {
  const auto options = std::make_shared<BakeOptions>();
  command.text("ENV", options->light.environment,
               "An equirectangular .exr (:LAYER), .hdr, .png, .jpg, .webp or .avif; a cube map: .ktx2, .ktx, .dds, a "
               "cross or strip, a folder of six faces or a pattern with %s; or studio, sky, sky:DEG, furnace");
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
    options->has_size = command.has("--size");
    options->has_levels = command.has("--levels");
    options->has_mapping = command.has("--mapping");
    options->has_format = command.has("--format");
    check_combinations(command, *options);
    run_bake(*options);
  };
}

}  // namespace candela::cli
