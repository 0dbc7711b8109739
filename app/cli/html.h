#pragma once

#include <string>

#include "image/develop.h"

namespace candela::cli {

/// An <img> with the picture in it, as a PNG; `what` is its text for those who do not see it.
std::string image_element(const DisplayImage& image, const std::string& what);

}  // namespace candela::cli
