#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/error.h"
#include "base/parallel.h"
#include "cli/interrupt.h"
#include "cli/json_text.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/threads.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "image/develop.h"
#include "laws/matrix.h"

namespace candela::cli {

namespace {

using Json = nlohmann::ordered_json;

std::string percent(double deviation) { return fmt::format("{:+.2f} %", 100.0 * deviation); }

/// Models that engines and texts use lose and gain what they are known to, which is no law that they keep.
std::string_view promise_text(const laws::MatrixRow& row) {
  if (!row.holds) return "BROKEN";
  return row.promise.is_exempt ? "exempt" : "kept";
}

std::string matrix_text(const std::vector<laws::MatrixRow>& matrix, bool is_partial) {
  std::string text = fmt::format("{:<58} {:>11} {:>10} {:>10} {:>8} {:>10}  {}\n", "surface", "reciprocity",
                                 "furnace -", "furnace +", "pdf", "not finite", "promise");
  int broken = 0;
  int surfaces = 0;
  for (const laws::MatrixRow& row : matrix) {
    const laws::Measurement& m = row.worst;
    text += fmt::format("{:<58} {:>11.0e} {:>10} {:>10} {:>8.0e} {:>10}  {}\n", row.group, m.reciprocity,
                        percent(m.furnace.least - 1.0), percent(m.furnace.most - 1.0), m.pdf, m.flaws.count,
                        promise_text(row));
    if (!row.holds) ++broken;
    surfaces += row.surfaces;
  }
  return text + fmt::format("{}{} surfaces in {} groups, {} broken promises\n", is_partial ? "interrupted: " : "",
                            surfaces, matrix.size(), broken);
}

std::string matrix_json(const std::vector<laws::MatrixRow>& matrix, bool is_partial) {
  Json rows = Json::array();
  for (const laws::MatrixRow& row : matrix) {
    const laws::Measurement& m = row.worst;
    Json promise = {{"reciprocal", row.promise.is_reciprocal},
                    {"white", row.promise.is_white},
                    {"gain", row.promise.gain},
                    {"exempt", row.promise.is_exempt}};
    if (row.promise.is_white) promise["loss"] = row.promise.loss;
    rows.push_back({{"surface", row.group},
                    {"surfaces", row.surfaces},
                    {"reciprocity_error", m.reciprocity},
                    {"furnace", {{"least", m.furnace.least}, {"most", m.furnace.most}}},
                    {"pdf_error", m.pdf},
                    {"not_finite", m.flaws.count},
                    {"promise", promise},
                    {"kept", row.holds}});
  }
  return json_text({{"laws", rows}, {"interrupted", is_partial}});
}

/// Values are encoded already.
DisplayImage display(const Image& sheet) {
  DisplayImage image{sheet.width, sheet.height, {}};
  image.rgba.reserve(sheet.pixels.size() / 3 * 4);
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      const vec3 v = sheet.rgb(x, y);
      for (int c = 0; c < 3; ++c) image.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * v[c])));
      image.rgba.push_back(255);
    }
  }
  return image;
}

}  // namespace

Verb add_furnace(Command& command) {
  struct Options {
    std::string output;
    bool json = false;
    bool all = false;
    bool quiet = false;
    std::string threads;
  };
  const auto options = std::make_shared<Options>();
  command.text("-o,--output", options->output, "Also draw the furnace sheet: a .png").type("FILE");
  command.flag("--all", options->all, "Every combination of lobes, not the typical ones alone: minutes");
  command.flag("--json", options->json, "For a machine: one JSON object");
  command.text("--threads", options->threads, "Default: all the machine has").type("N");
  command.flag("-q,--quiet", options->quiet, "No progress on standard error");
  command.footer(
      "Examples:\n  candela furnace\n  candela furnace -o sheet.png\n  candela furnace --all --json > laws.json\n\n"
      "Ctrl-C keeps what is measured and drawn by then (exit code 130).");
  return [options] {
    const std::filesystem::path output = options->output;
    if (!options->output.empty() && !has_extension(output, ".png")) {
      throw UsageError("--output: the sheet is a .png: " + options->output);
    }
    const ThreadLimit limit(options->threads.empty() ? 0 : parse_count(options->threads, 1, kMostThreads));
    if (!options->output.empty()) check_writable(output);

    ProgressLine progress(options->quiet);
    const Interrupt interrupt;
    const Job job = progress.job();
    const std::vector<laws::MatrixRow> matrix = laws::law_matrix(options->all, job);
    const bool is_partial = job.is_stopped();
    bool is_sheet_partial = false;
    if (!options->output.empty() && !is_partial) {
      const Image sheet = laws::furnace_sheet(job);
      is_sheet_partial = job.is_stopped();
      const FolderFor folder(output);
      write_png(output, display(sheet));
      progress.line(fmt::format("{}{}: roughness 0 to 1; from the top: {}", is_sheet_partial ? "interrupted, " : "",
                                options->output, fmt::join(laws::furnace_sheet_rows(), "; ")));
    }
    progress.clear();
    print(options->json ? matrix_json(matrix, is_partial) : matrix_text(matrix, is_partial));
    if (is_partial) throw Interrupted("the groups above are those that were measured; there is no sheet");
    if (is_sheet_partial) throw Interrupted("spheres of the sheet that are missing are black");
  };
}

}  // namespace candela::cli
