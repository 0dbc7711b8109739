#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "candela/candela.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/threads.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "figures/figure_book.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

struct FigureOptions {
  std::string output;
  std::vector<figures::FigureInfo> chosen;
  figures::FigureSettings settings;
  std::string quality = "final";
  int samples = 0;  ///< 0 = as the quality says
  int threads = 0;
  bool quiet = false;
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

constexpr Words<const char*, 2> kQualityWords{{{"draft", "draft"}, {"final", "final"}}};

figures::FigureSettings settings_of(const FigureOptions& o) {
  const bool is_draft = o.quality == "draft";
  figures::FigureSettings settings;
  settings.samples = o.samples > 0 ? o.samples : is_draft ? 8 : 64;
  settings.reference = 8 * settings.samples;
  settings.size = is_draft ? 0.5f : 1.0f;
  return settings;
}

/// "chapter: name, name", each from a line of its own.
std::string list_text() {
  constexpr std::size_t kColumns = 100;
  std::string text;
  std::size_t column = 0;
  const figures::FigureInfo* last = nullptr;
  const std::vector<figures::FigureInfo> all = figures::figures();
  for (const figures::FigureInfo& info : all) {
    const bool is_new = last == nullptr || info.chapter != last->chapter;
    const bool is_full = column + info.name.size() + 2 > kColumns;
    const std::string before = is_new    ? fmt::format("\n  {}: ", figures::chapter_title(info.chapter))
                               : is_full ? ",\n    "
                                         : ", ";
    column = (is_new || is_full ? before.size() : column + before.size()) + info.name.size();
    text += before + info.name;
    last = &info;
  }
  return text;
}

void run_figures(const FigureOptions& o) {
  path::check_built();
  const auto start = std::chrono::steady_clock::now();
  const fs::path folder = o.output;
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) throw Error("cannot be made: " + code.message(), folder.string());
  check_writable(folder / "index.html");

  ProgressLine progress(o.quiet);
  const ThreadLimit limit(o.threads);
  const Interrupt interrupt;
  const figures::FigureSettings settings = settings_of(o);
  const std::string note = fmt::format("Candela {}, --quality {}: {} samples per pixel, {} in references.", version(),
                                       o.quality, settings.samples, settings.reference);
  Diagnostics diagnostics;
  std::size_t told = 0;
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const auto tell_warnings = [&] {
    for (; told < diagnostics.warnings().size(); ++told) progress.warn(diagnostics.warnings()[told]);
  };
  Job job{.stop = &Interrupt::requested(), .diagnostics = &diagnostics};
  job.progress = [&](const Progress& p) {
    tell_warnings();
    progress.phase(p.what);
  };
  const figures::BookResult result = figures::write_figures(folder, o.chosen, settings, note, job);
  tell_warnings();
  progress.line(fmt::format("{}: {}{}, {} in {}", (folder / "index.html").string(),
                            result.stopped ? "interrupted; " : "", counted(result.figures, "figure"),
                            counted(result.files, "file"), duration_text(seconds())));
  if (result.stopped) {
    throw Interrupted(fmt::format("{} of {} figures are there, with their pages", result.figures, o.chosen.size()));
  }
}

}  // namespace

Verb add_figures(Command& command) {
  const auto options = std::make_shared<FigureOptions>();
  FigureOptions& o = *options;
  command.text("-o,--output", o.output, "The folder, made where it is absent; begin at its index.html")
      .type("DIR")
      .required();
  add_value(
      command, "--only", "NAMES", o.chosen,
      [](const std::string& text) { return figures::choose_figures(split(text)); },
      "These figures alone, separated by commas")
      .choices_of_list(names_of_rows(figures::figures()));
  add_choice(command, "--quality", "NAME", o.quality, kQualityWords,
             "final: minutes; draft: half as wide, 8 samples [final]");
  add_value(command, "--spp", "N", o.samples, count_within(1, 65536),
            "Samples per pixel, eight times as many in references [64]");
  add_value(command, "--threads", "N", o.threads, count_within(1, kMostThreads), "Default: all the machine has");
  command.flag("-q,--quiet", o.quiet, "No progress on standard error");
  command.footer(
      "Figures:" + list_text() +
      "\n\nExamples:\n  candela figures -o figures\n  candela figures -o figures --only ndf-ggx,fresnel-metals\n"
      "  candela figures -o draft --quality draft");
  return [options] {
    if (options->output.empty()) throw UsageError("--output: the folder needs a name");
    if (options->chosen.empty()) options->chosen = figures::choose_figures({});
    run_figures(*options);
  };
}

}  // namespace candela::cli
