#include "cli/render_statistics.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "candela/candela.h"
#include "cli/json_text.h"
#include "cli/output.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace {

double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

const char* end_of(const path::Statistics& s) { return s.interrupted ? "interrupt" : s.timed_out ? "time" : "samples"; }

nlohmann::ordered_json noise_json(const RenderOptions& o, const path::Statistics& s) {
  if (!s.noise) return nullptr;
  nlohmann::ordered_json json{{"target", *o.shot.traced.noise},
                              {"reached", s.noise->share_above <= 0.0},
                              {"share_above", s.noise->share_above},
                              {"worst", nullptr},
                              {"stopped_by", s.noise->share_above <= 0.0 ? "noise" : end_of(s)}};
  if (std::isfinite(s.noise->worst)) json["worst"] = s.noise->worst;
  return json;
}

}  // namespace

void warn_of_noise(const RenderOptions& o, const path::Statistics& s, Diagnostics& diagnostics) {
  if (!o.noise_given || !s.noise || s.noise->share_above <= 0.0) return;
  const std::string why = s.interrupted ? "the interruption"
                          : s.timed_out
                              ? "--time"
                              : fmt::format("the limit of {} per pixel (--spp)",
                                            counted(static_cast<std::size_t>(o.shot.traced.samples), "sample"));
  const std::string worst =
      std::isfinite(s.noise->worst) ? fmt::format("{:.2g}", s.noise->worst) : std::string("unknown");
  const double percent = 100.0 * s.noise->share_above;
  diagnostics.warn(
      fmt::format("the noise target {:g} was not reached in {} % of the pixels, the worst of which is {}: "
                  "stopped by {}",
                  *o.shot.traced.noise, percent < 1.0 ? "less than 1" : fmt::format("{:.0f}", percent), worst, why),
      o.shot.scene);
}

std::string stats_json(const RenderOptions& o, const path::Statistics& s, const Times& times, int threads,
                       const Diagnostics& diagnostics) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  nlohmann::ordered_json json{
      {"version", version()},
      {"scene", o.shot.scene},
      {"width", o.shot.size.x},
      {"height", o.shot.size.y},
      {"spp", s.mean_samples_per_pixel},
      {"threads", threads},
      {"load_s", times.load_s},
      {"build_s", s.build_s},
      {"render_s", s.render_s},
      {"denoise_s", times.denoise_s},
      {"write_s", times.write_s},
      {"total_s", times.total_s},
      {"cpu_s", cpu_seconds(usage)},
      {"peak_rss_mb", static_cast<double>(usage.ru_maxrss) / 1024.0},  // Linux counts kibibytes
      {"samples", s.samples},
      {"spared_samples", s.spared_samples},
      {"msamples_per_s", s.render_s > 0.0 ? static_cast<double>(s.samples) / s.render_s * 1e-6 : 0.0},
      {"rays", {{"camera", s.camera_rays}, {"bounce", s.bounce_rays}, {"shadow", s.shadow_rays}}},
      {"non_finite_samples", s.non_finite_samples},
      {"triangles", s.triangles},
      {"instances", s.instances},
      {"interrupted", s.interrupted},
      {"noise", noise_json(o, s)},
      {"warnings", nlohmann::ordered_json::array()}};
  for (const Diagnostic& warning : diagnostics.warnings()) json["warnings"].push_back(warning.text());
  return json_text(json);
}

std::string stats_json(const RenderOptions& o, const raster::Statistics& s, const Times& times,
                       const Diagnostics& diagnostics) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  nlohmann::ordered_json json{{"version", version()},
                              {"engine", "raster"},
                              {"driver", s.driver},
                              {"scene", o.shot.scene},
                              {"width", o.shot.size.x},
                              {"height", o.shot.size.y},
                              {"frames", s.frames},
                              {"msaa", o.shot.drawn.msaa},
                              {"load_s", times.load_s},
                              {"open_s", s.open_s},
                              {"light_s", s.light_s},
                              {"light_is_cached", s.is_light_cached},
                              {"upload_s", s.upload_s},
                              {"compile_s", s.compile_s},
                              {"shadow_s", s.shadow_s},
                              {"frame_s", s.frame_s},
                              {"draw_s", s.draw_s},
                              {"write_s", times.write_s},
                              {"total_s", times.total_s},
                              {"cpu_s", cpu_seconds(usage)},
                              {"peak_rss_mb", static_cast<double>(usage.ru_maxrss) / 1024.0},
                              {"programs", s.programs},
                              {"draws", s.draws},
                              {"triangles", s.triangles},
                              {"non_finite_pixels", s.non_finite_pixels},
                              {"interrupted", s.interrupted},
                              {"warnings", nlohmann::ordered_json::array()}};
  for (const Diagnostic& warning : diagnostics.warnings()) json["warnings"].push_back(warning.text());
  return json_text(json);
}

void write_stats(const RenderOptions& o, const std::string& json) {
  if (*o.stats == "-") return print(json);
  const FolderFor folder(*o.stats);
  write_file(*o.stats, json);
}

}  // namespace candela::cli
