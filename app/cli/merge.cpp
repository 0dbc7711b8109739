#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "candela/part.h"
#include "cli/inputs.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/values.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

struct MergeOptions {
  std::vector<std::string> parts, outputs;
  std::optional<std::optional<float>> exposure;
  std::optional<ToneCurve> tone_curve;
  std::optional<float> bloom;
  std::string denoiser;
  bool quiet = false, strict = false;
};

void check_usage(const MergeOptions& o) {
  if (o.outputs.empty()) throw UsageError("--output: where to is missing: -o FILE.exr or FILE.png");
  for (const std::string& output : o.outputs) {
    if (!standard_output_format(output).empty()) throw UsageError("--output: goes to a file: " + output);
    try {
      check_output_extension(output);
    } catch (const Error& error) {
      throw UsageError(std::string("--output: ") + error.what());
    }
  }
}

std::optional<denoise::Method> chosen_denoiser(const MergeOptions& o, const PicturePart& part) {
  if (o.denoiser.empty()) return part.denoiser;
  if (o.denoiser == "none") return std::nullopt;
  std::optional<denoise::Method> method;
  try {
    method = o.denoiser == "true" ? denoise::Method::regression : denoise::parse_method(o.denoiser);
  } catch (const Error& error) {
    throw UsageError("--denoise: " + std::string(error.what()));
  }
  if (!part.has_features) throw Error("--denoise: the parts lack what that takes: render them with --denoise");
  return method;
}

/// In another thread, beside what is done with the part before it.
std::future<PicturePart> read_soon(const std::string& name) {
  return std::async(std::launch::async, [name] { return read_part(name); });
}

void run_merge(const MergeOptions& o) {
  check_usage(o);
  const Stopwatch watch;
  ProgressLine progress(o.quiet);
  const Interrupt interrupt;
  Inputs inputs;
  for (const std::string& part : o.parts) inputs.add(part, "a part");
  std::vector<fs::path> outputs(o.outputs.begin(), o.outputs.end());
  for (const fs::path& output : outputs) {
    inputs.refuse(output);
    check_writable(output);
  }
  MergedPicture merged;
  constexpr std::size_t kAhead = 2;  // reading takes longer than adding
  std::deque<std::future<PicturePart>> coming;
  for (std::size_t i = 0, asked = 0; i < o.parts.size(); ++i) {
    for (; asked < std::min(i + kAhead, o.parts.size()); ++asked) coming.push_back(read_soon(o.parts[asked]));
    progress.phase("reading " + o.parts[i]);
    PicturePart part = coming.front().get();
    coming.pop_front();
    merged.add(std::move(part), o.parts[i]);
  }
  Diagnostics diagnostics;
  Film film = merged.film(&diagnostics);
  const PicturePart& part = merged.first();
  DevelopSettings develop = part.develop;
  if (o.exposure) develop.exposure = *o.exposure;
  if (o.tone_curve) develop.tone_curve = *o.tone_curve;
  if (o.bloom) develop.bloom = *o.bloom;
  if (std::optional<denoise::Method> denoiser = chosen_denoiser(o, part)) {
    if (const std::string why = denoise::why_not(*denoiser); !why.empty()) {
      diagnostics.warn(why + "; the built-in regression denoises");
      denoiser = denoise::Method::regression;
    }
    progress.phase("denoising");
    if (!denoise::denoise(film, *denoiser, progress.job())) throw Interrupted("nothing was written");
    film.metadata["denoiser"] = denoise::method_name(*denoiser);
  }
  for (const Diagnostic& warning : diagnostics.warnings()) {
    if (o.strict) throw Error(warning.message + " (--strict)", warning.where);
    progress.warn(warning);
  }
  write_outputs(outputs, film, develop);
  for (const fs::path& output : outputs) {
    progress.line(fmt::format("{}: {}x{}, {} of {} samples per pixel from {} parts in {}", output.string(),
                              film.width(), film.height(), film.metadata.at("samples"), part.samples, o.parts.size(),
                              duration_text(watch.seconds())));
  }
}

}  // namespace

Verb add_merge(Command& command) {
  const auto options = std::make_shared<MergeOptions>();
  MergeOptions& o = *options;
  command.texts("PART", o.parts, "Files of render --part, in any order").required();
  command.texts("-o,--output", o.outputs, "Picture to write, may be repeated: .png, .jpg, .webp, .exr, .hdr")
      .type("FILE")
      .repeated();
  add_value(command, "--exposure", "auto|EV|f/N,1/T,ISO", o.exposure, parse_exposure, "As of render [the parts']");
  add_value(command, "--tonemap", "CURVE", o.tone_curve, parse_tone_curve, "As of render [the parts']")
      .choices(names_of_rows(kToneCurves));
  add_value(command, "--bloom", "X", o.bloom, number_within(0.0f, 1.0f), "As of render [the parts']");
  command.flag_or_value("--denoise", "[=regression|oidn|none]", o.denoiser, "As of render [the parts']");
  command.flag("-q,--quiet", o.quiet, "No progress");
  command.flag("--strict", o.strict, "Missing parts are an error");
  command.help();
  command.footer(
      "The picture has the bits that one machine would have given it; denoising follows. Missing parts are a "
      "warning.\n\n"
      "Examples:\n  candela merge p1.part p2.part -o helmet.exr -o helmet.png\n"
      "  candela merge parts/*.part -o helmet.png --exposure 1 --denoise\n");
  return [options] { run_merge(*options); };
}

}  // namespace candela::cli
