#pragma once

#include <string>

#include "base/diagnostics.h"
#include "cli/render_options.h"
#include "path/render.h"
#include "raster/render.h"

/// What `candela render --stats` tells of a picture, and of noise that was not reached.
namespace candela::cli {

struct Times {
  double load_s = 0.0;
  double denoise_s = 0.0;
  double write_s = 0.0;
  double total_s = 0.0;
};

/// A picture that is noisier than was asked for does not show it by itself.
void warn_of_noise(const RenderOptions& options, const path::Statistics& statistics, Diagnostics& diagnostics);

/// Of a traced picture, and of a drawn one: JSON with a line break at the end.
std::string stats_json(const RenderOptions& options, const path::Statistics& statistics, const Times& times,
                       int threads, const Diagnostics& diagnostics);
std::string stats_json(const RenderOptions& options, const raster::Statistics& statistics, const Times& times,
                       const Diagnostics& diagnostics);

/// To the file that --stats names; to standard output where it is "-".
void write_stats(const RenderOptions& options, const std::string& json);

}  // namespace candela::cli
