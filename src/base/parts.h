#pragma once

#include <string>

#include "base/error.h"

namespace candela {

/// What a part that was left out of the build says wherever it is asked for: "the path tracer", "CANDELA_WITH_PATH".
inline Error absent_part(const std::string& part, const std::string& option) {
  return Error("this build is without " + part + ": configure it with -D" + option + "=ON");
}

}  // namespace candela
