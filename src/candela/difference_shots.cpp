#include <memory>
#include <utility>

#include "base/error.h"
#include "candela/difference.h"

namespace candela {

namespace {

/// Of a film what a display shows of it.
Film what_is_shown(Film film) {
  Film shown;
  shown.beauty = std::move(film.beauty);
  shown.through = std::move(film.through);
  return shown;
}

void require_whole(bool is_whole) {
  if (!is_whole) throw Interrupted("the pictures are not all there");
}

}  // namespace

void compare_shots(const Shot& first, const Shot& second, const DifferenceSettings& settings,
                   const std::function<void(ShotDifference)>& take, const Job& job) {
  const auto stage = std::make_shared<Stage>();
  auto reference = std::make_unique<Take>(first, job.diagnostics, stage);
  Take judged(second, job.diagnostics, stage);
  judged.prepare_beside(*reference);
  const std::vector<PictureLabel> labels = judged.labels();
  const JobParts parts(job, 2);
  std::vector<Film> films;
  DevelopSettings develop;
  const TakeResult of_first = reference->render(
      [&](TakenPicture picture) {
        if (films.empty()) develop = picture.develop;
        if (!develop.exposure) develop.exposure = metered_exposure(picture.film);
        films.push_back(what_is_shown(std::move(picture.film)));
      },
      parts.part(0, "first, "));
  require_whole(!of_first.interrupted);
  reference.reset();  // two acceleration structures need not be there at once
  judged.render(
      [&](const TakenPicture& picture) {
        require_whole(picture.is_whole());
        Film& other = films.at(picture.index);
        take({picture.index, labels[picture.index], compare_films(other, picture.film, develop, settings.tolerance)});
        other = {};
      },
      parts.part(1, "second, "));
}

}  // namespace candela
