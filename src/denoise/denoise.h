#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "image/film.h"
#include "image/job.h"

namespace candela::denoise {

enum class Method {
  regression,  ///< built in, see regression.h
  oidn         ///< Open Image Denoise's library of version 2, where it is found at run time
};

/// "regression" or "oidn". Throws Error.
Method parse_method(std::string_view name);
std::string_view method_name(Method method);

/// Why a method cannot be had here; empty where it can.
std::string why_not(Method method);

/// Most bytes per pixel that denoise() takes beside the film that it is given, Film::noisy and its place in a file
/// included.
constexpr std::uint64_t bytes_per_pixel() { return 192; }

/// Takes noise out of a film's picture, which moves to Film::noisy, and out of what shows through it; layers stay. The
/// film has features (path::Settings::has_features). The result depends on the film alone, not on the number of
/// threads. It is biased; the bias goes to 0 as the picture converges, because a pixel's own noise decides how much of
/// it is replaced. A stop that comes while it works ends it: then the film stays as it was, and the answer is false.
/// One that came before does not: the picture so far is denoised. Throws Error where the method cannot be had.
bool denoise(Film& film, Method method, const Job& job = {});

}  // namespace candela::denoise
