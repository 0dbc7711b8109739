#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/render_options.h"
#include "image/movie.h"

namespace candela::cli {

/// Whether the pictures of a shot that have this output go into one film, or into one film for each of what its
/// placeholders distinguish: a name that can only be a film's, or a .webp that has no place for their number.
bool is_film(const RenderOptions& options, const std::string& output);

/// The films of a run while they are written.
class Films {
 public:
  explicit Films(const RenderOptions& options) : options_(options) {}

  /// Throws Error as open_movie() and MovieWriter::add() do.
  void add(const std::filesystem::path& path, const DisplayImage& picture, std::optional<double> real_time_rate);
  /// All of them appear; says what there is now.
  std::vector<std::string> finish();

 private:
  struct Film {
    std::unique_ptr<MovieWriter> writer;
    MovieSettings settings;
    std::size_t count = 0;
  };
  const RenderOptions& options_;
  std::map<std::filesystem::path, Film> films_;
};

}  // namespace candela::cli
