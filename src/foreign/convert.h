#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "foreign/formats.h"
#include "foreign/measures.h"
#include "foreign/surroundings.h"

namespace candela::foreign {

struct Converted {
  std::vector<std::byte> glb;
  std::vector<std::string> read;  ///< names of what was read beside the file, as Surroundings take them
};

/// A scene of another format as a binary glTF in memory, whose images beside it are named relative to the scene's
/// folder. What the scene loses on the way is a warning. Assimp runs in a process of its own, which a broken file may
/// end. Throws Error at `where`, also where the build is without Assimp.
Converted convert(std::span<const std::byte> bytes, Format format, const Surroundings& around, const std::string& stem,
                  const std::string& where, Diagnostics& diagnostics, const Measures& measures = {});

}  // namespace candela::foreign
