#pragma once

namespace candela {

/// Whether this is a build for browsers: there are no threads, and the driver answers no query while code runs.
#ifdef __EMSCRIPTEN__
inline constexpr bool kIsBrowser = true;
#else
inline constexpr bool kIsBrowser = false;
#endif

}  // namespace candela
