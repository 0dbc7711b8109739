#pragma once

#include <string>

#include "candela/difference.h"

namespace candela::cli {

/// A page in one file that shows pairs of pictures beside each other, one over the other with a slider, in turn, or
/// their error. `title` and `heading` are text, `body` is HTML.
std::string pair_page(const std::string& title, const std::string& heading, const std::string& body);

/// The pictures of a pair, which are called that.
std::string pair_pictures(const PictureDifference& difference, const std::string& first, const std::string& second);

}  // namespace candela::cli
