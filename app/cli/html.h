#pragma once

#include <string>

#include "image/develop.h"

namespace candela::cli {

/// An <img> with the picture in it, as a PNG; `what` is its text for those who do not see it.
std::string image_element(const DisplayImage& image, const std::string& what);

/// The same of a drawing that stands alone: its styles are its own.
std::string svg_element(const std::string& svg, const std::string& what);

}  // namespace candela::cli
