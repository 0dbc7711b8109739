#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"

namespace candela::test {

/// Files that npm's ktx2-encoder and Arm's astcenc wrote; make_fixtures.mjs in their folder makes them again.
inline std::filesystem::path basis_folder() { return CANDELA_SOURCE_DIR "/tests/unit/image/basis"; }
inline std::vector<std::byte> basis_file(const std::string& name) { return read_file(basis_folder() / name); }

}  // namespace candela::test
