#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "cli/bake_output.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "ibl/cube.h"
#include "image/image_file.h"
#include "scene/environment.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

struct BakeOptions {
  std::string environment;
  std::string output;
  std::string report;
  ibl::BakeSettings bake;
  float rotation = 0.0f;
  float intensity = 1.0f;
  bool tables = false;
  int table_size = 128;
  bool extract_sun = false;
  bool json = false;
  bool quiet = false;
  int threads = 0;
};

/// An option with one value; what its text cannot mean names the option.
template <class T, class Parse>
void add(CLI::App* verb, const std::string& group, const std::string& name, const std::string& type, T& into,
         Parse parse, const std::string& help) {
  const auto store = [name, &into, parse](const std::string& text) {
    try {
      into = parse(text);
    } catch (const UsageError& error) {
      throw UsageError(name + ": " + error.what());
    }
  };
  verb->add_option_function<std::string>(name, store, help)->type_name(type)->group(group);
}

auto count_within(int low, int high) {
  return [low, high](const std::string& text) { return parse_count(text, low, high); };
}

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
  add(verb, group, "--size", "N", o.bake.size, count_within(1, kMostSize), "Texels along a face of level 0 [256]");
  add(verb, group, "--levels", "N", o.bake.levels, count_within(1, kMostLevels), "Each half the size of the last [6]");
  add(verb, group, "--mapping", "NAME", o.bake.mapping,
      one_of<Mapping, 3>(
          {{{"balanced", Mapping::balanced}, {"linear", Mapping::linear}, {"filament", Mapping::filament}}}),
      "Roughness of the levels: balanced (its square halves as texels do), linear, filament [balanced]");
  add(verb, group, "--method", "NAME", o.bake.specular.method,
      one_of<Method, 5>({{{"auto", Method::automatic},
                          {"zonal", Method::zonal},
                          {"hierarchical", Method::hierarchical},
                          {"fis", Method::fis},
                          {"montecarlo", Method::montecarlo}}}),
      "zonal, hierarchical; fis and montecarlo for comparison [auto: zonal where the lobe allows]");
  add(verb, group, "--samples", "N", o.bake.specular.samples, count_within(1, kMostSamples),
      "Of fis, montecarlo and riemann, per texel [1024]");
  verb->add_flag("--sheen", o.bake.sheen, "Also the levels of the sheen lobe")->group(group);
}

void add_diffuse(CLI::App* verb, BakeOptions& o) {
  using ibl::IrradianceMethod;
  using ibl::Window;
  constexpr int kMostSize = 1024;
  const std::string group = "Diffuse";
  add(verb, group, "--irradiance", "NAME", o.bake.irradiance_method,
      one_of<IrradianceMethod, 3>({{{"exact", IrradianceMethod::exact},
                                    {"riemann", IrradianceMethod::riemann},
                                    {"montecarlo", IrradianceMethod::montecarlo}}}),
      "exact; riemann and montecarlo for comparison [exact]");
  add(verb, group, "--irradiance-size", "N", o.bake.irradiance_size, count_within(1, kMostSize),
      "Texels along a face [32]");
  add(verb, group, "--sh-order", "L", o.bake.sh_order, count_within(0, ibl::kMostShOrder),
      "Highest degree of the spherical harmonics [2: nine of them]");
  add(verb, group, "--window", "NAME", o.bake.window,
      one_of<Window, 4>({{{"none", Window::none},
                          {"hann", Window::hann},
                          {"lanczos", Window::lanczos},
                          {"auto", Window::automatic}}}),
      "Damps their ringing: none, hann, lanczos, auto (as little as leaves nothing negative) [none]");
}

void add_rest(CLI::App* verb, BakeOptions& o) {
  constexpr int kMostDirections = 100000;
  constexpr float kMostIntensity = 1e30f;
  constexpr int kMostTable = 1024;
  constexpr int kMostThreads = 1024;
  add(
      verb, "Light", "--env-rotation", "DEG", o.rotation,
      [](const std::string& text) { return candela::radians(parse_number(text, -36000.0f, 36000.0f)); },
      "Turns the environment about +y [0]");
  add(
      verb, "Light", "--env-intensity", "X", o.intensity,
      [](const std::string& text) { return parse_number(text, 0.0f, kMostIntensity); },
      "Multiplies the environment [1]");
  verb->add_flag("--extract-sun", o.extract_sun, "Also the sun as numbers and the environment without it")
      ->group("Light");
  add(verb, "Proof", "--proof", "N", o.bake.proof_directions, count_within(0, kMostDirections),
      "Directions per level that are compared with the exact integral [32]");
  add(verb, "Proof", "--error", "X", o.bake.error, parse_share,
      "Refine until no level errs by more at its texels: 0.001 or 0.1%");
  add(
      verb, "Proof", "--report", "FILE.html", o.report, [](const std::string& text) { return text; },
      "The errors as a page with pictures");
  verb->add_flag("--json", o.json, "The errors as one JSON object on standard output")->group("Proof");
  verb->add_flag("--tables", o.tables, "Also the split-sum tables; alone without an environment")->group("Tables");
  add(verb, "Tables", "--table-size", "N", o.table_size, count_within(2, kMostTable), "Their width and height [128]");
  add(verb, "Running", "--threads", "N", o.threads, count_within(0, kMostThreads),
      "0 is all; the result does not depend on it [0]");
  verb->add_flag("-q,--quiet", o.quiet, "Nothing on standard error but errors")->group("Running");
}

bool is_built_in(const std::string& name) {
  return name == "studio" || name == "sky" || name.starts_with("sky:") || name == "furnace" || name == "none";
}

std::string at_text(ivec2 at) { return fmt::format("{},{}", at.x, at.y); }

/// A panorama from a file, with what is wrong in it put right and told.
Environment load_panorama(const std::string& path, std::vector<Diagnostic>& warnings) {
  auto map = std::make_shared<Image>(read_image(path));
  constexpr float kTolerance = 0.05f;  // a few pixels come from resizing
  if (std::abs(static_cast<float>(map->width) / static_cast<float>(map->height) - 2.0f) > kTolerance) {
    throw Error(fmt::format("an equirectangular environment is twice as wide as high, this image is {}x{}", map->width,
                            map->height),
                path);
  }
  const ImageFormat format = sniff_image_format(read_file(path));
  if (format == ImageFormat::png || format == ImageFormat::jpeg) {
    warnings.push_back(
        {"8 or 16 bits per channel end at white: what is brighter, the sun above all, is missing", path});
  }
  const ibl::Repairs repairs = ibl::repair(*map);
  if (repairs.not_finite > 0) {
    warnings.push_back({fmt::format("{} texels are not finite, the first at {}: infinity became the largest finite "
                                    "value, NaN became 0",
                                    repairs.not_finite, at_text(repairs.first_not_finite)),
                        path});
  }
  if (repairs.negative > 0) {
    warnings.push_back({fmt::format("{} texels are negative, the first at {}: they became 0", repairs.negative,
                                    at_text(repairs.first_negative)),
                        path});
  }
  Environment environment;
  environment.name = path;
  environment.map = std::move(map);
  return environment;
}

ibl::Source load_source(const BakeOptions& o, std::vector<Diagnostic>& warnings) {
  Environment environment =
      is_built_in(o.environment) ? make_environment(o.environment) : load_panorama(o.environment, warnings);
  environment.rotation += o.rotation;
  environment.intensity *= o.intensity;
  return ibl::make_source(environment);
}

/// What the baker holds at once: the panorama, its sums and its harmonics, and directions and values of the faces.
void check_memory(const BakeOptions& o, const ibl::Source& source) {
  constexpr std::uint64_t kPerTexel = 96, kPerFaceTexel = 160, kAlways = std::uint64_t{1} << 28;
  const auto texels = static_cast<std::uint64_t>(source.map.width) * static_cast<std::uint64_t>(source.map.height);
  const auto size = static_cast<std::uint64_t>(o.bake.size);
  require_memory(kAlways + texels * kPerTexel + 6 * size * size * kPerFaceTexel, available_memory(),
                 fmt::format("a bake of {0}x{0} texels", o.bake.size), "--size");
}

void check_usage(const BakeOptions& o) {
  if (o.environment.empty() && !o.tables) throw UsageError("what to bake is missing: an environment, or --tables");
  if (o.output.empty()) throw UsageError("where to is missing: -o DIR");
  if (o.environment.empty() && !o.report.empty()) throw UsageError("--report: there is no environment to report on");
  if (o.environment.empty() && o.extract_sun) throw UsageError("--extract-sun: there is no environment");
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

void check_paths(const BakeOptions& o) {
  std::error_code code;
  if (fs::exists(o.output, code) && !fs::is_directory(o.output, code)) throw Error("is not a folder", o.output);
  check_writable(fs::is_directory(o.output, code) ? fs::path(o.output) / "bake.json" : fs::path(o.output));
  if (o.report.empty()) return;
  check_writable(o.report);
  if (fs::equivalent(o.report, o.environment, code)) throw Error("is an input of this bake", o.report);
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

void run_bake(BakeOptions& o) {
  check_usage(o);
  check_paths(o);
  const ThreadLimit threads(o.threads);
  ProgressLine progress(o.quiet);
  o.bake.irradiance_samples = o.bake.specular.samples;
  o.bake.specular.fis_size = o.bake.size;
  const std::string name = is_built_in(o.environment) ? o.environment : fs::path(o.environment).filename().string();
  BakeResult result{o.environment.empty() ? "tables" : name, o.bake, {}, {}, {}, {}};
  if (!o.environment.empty()) {
    progress.phase("loading " + o.environment);
    const ibl::Source source = load_source(o, result.warnings);
    for (const Diagnostic& warning : result.warnings) progress.warn(warning);
    check_memory(o, source);
    const auto start = std::chrono::steady_clock::now();
    result.bake = ibl::bake(source, o.bake, [&](const std::string& what) { progress.phase(what); });
    result.bake_s = since(start);
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
  write_bake(o.output, result);
  if (!o.report.empty()) write_file(o.report, bake_html(result));
  print(o.json ? bake_json(result) : bake_text(result));
}

}  // namespace

Verb add_bake(CLI::App& app) {
  const auto options = std::make_shared<BakeOptions>();
  CLI::App* verb = app.add_subcommand("bake", "Image-based light for engines, with its error measured")->group("Verbs");
  verb->add_option("ENV", options->environment,
                   "An equirectangular .exr, .hdr or .png, or studio, sky, sky:DEG, furnace")
      ->type_name("");
  verb->add_option("-o,--output", options->output, "Folder to write to; it is made where it is absent")
      ->type_name("DIR");
  add_cube(verb, *options);
  add_diffuse(verb, *options);
  add_rest(verb, *options);
  verb->footer(
      "Examples:\n  candela bake street.hdr -o street\n  candela bake street.hdr -o street --error 0.1% --report "
      "street.html\n  candela bake sky:20 -o dusk --extract-sun --sh-order 4 --window auto\n  candela bake --tables -o "
      "tables");
  return [options] { run_bake(*options); };
}

}  // namespace candela::cli
