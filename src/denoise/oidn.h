#pragma once

#include "image/film.h"
#include "image/job.h"

namespace candela::denoise {

/// Why Open Image Denoise cannot be used here; empty where it can: libOpenImageDenoise.so.2 is found as the dynamic
/// linker finds libraries, and opens a device.
std::string why_no_oidn();

/// RGB of a film's picture by Open Image Denoise's filter for path tracing ("RT"), high dynamic range, with albedo and
/// normal. Film::features is there. Throws Error.
Image denoise_by_oidn(const Film& film, const Job& job = {});

}  // namespace candela::denoise
