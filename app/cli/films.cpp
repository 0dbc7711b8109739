#include "cli/films.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "cli/output.h"
#include "cli/render_outputs.h"

namespace candela::cli {

bool is_film(const RenderOptions& o, const std::string& output) {
  if (!is_movie_name(output)) return false;
  const bool may_be_still = has_extension(output, ".webp");
  return !may_be_still || (o.shot.has_many_pictures() && !is_frame_pattern(output) && shares_names(o, output));
}

void Films::add(const std::filesystem::path& path, const DisplayImage& picture, std::optional<double> real_time_rate) {
  Film& film = films_[path];
  if (film.writer == nullptr) {
    // What nobody asked for is in every format's reach.
    constexpr double kDefault = 24.0, kSlowest = 1.0, kFastest = 50.0;
    film.settings.size = {picture.width, picture.height};
    film.settings.frame_rate = options_.frames_per_second.value_or(
        static_cast<float>(std::clamp(real_time_rate.value_or(kDefault), kSlowest, kFastest)));
    for (std::size_t i = 3; i < picture.rgba.size() && !film.settings.has_alpha; i += 4) {
      film.settings.has_alpha = picture.rgba[i] != 255;
    }
    film.writer = open_movie(path, film.settings);
  }
  film.writer->add(picture);
  ++film.count;
}

std::vector<std::string> Films::finish() {
  std::vector<std::string> lines;
  for (auto& [path, film] : films_) {
    film.writer->finish();
    lines.push_back(fmt::format("{}: {} of {}x{}, {:.4g} per second", path.string(), counted(film.count, "picture"),
                                film.settings.size.x, film.settings.size.y, film.settings.frame_rate));
  }
  films_.clear();
  return lines;
}

}  // namespace candela::cli
