#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"

namespace candela::test {

/// Files that npm's ktx2-encoder wrote; make_fixtures.mjs in their folder makes them again.
inline std::filesystem::path basis_folder() { return CANDELA_SOURCE_DIR "/tests/unit/image/basis"; }
inline constexpr auto kBasisFiles =
    std::to_array<const char*>({"etc1s.ktx2", "etc1s_alpha.ktx2", "etc1s_grey.ktx2", "etc1s_flat.ktx2",
                                "etc1s_cube.ktx2", "uastc.ktx2", "uastc_alpha_zstd.ktx2", "uastc_cube.ktx2"});
inline std::vector<std::byte> basis_file(const std::string& name) { return read_file(basis_folder() / name); }

}  // namespace candela::test
