#pragma once

#include <string>
#include <vector>

#include "figures/figure.h"

namespace candela::figures {

/// A figure that was made, with its number within the chapter of the whole book, from 1.
struct PageFigure {
  FigureInfo info;
  Figure figure;
  int number = 1;
};

/// The page of all figures: complete HTML without scripts, fonts or anything else from elsewhere. Parameters stand in
/// it as small pictures that lead to their pages. `note` tells how the book was made.
std::string index_html(const std::vector<PageFigure>& figures, const std::string& note);

/// The page of one parameter; `before` and `after` are its neighbours, null at the ends.
std::string parameter_html(const PageFigure& figure, const PageFigure* before, const PageFigure* after,
                           const std::string& note);

/// The name of a parameter's page.
std::string parameter_page(const std::string& figure_name);

}  // namespace candela::figures
