#pragma once

#include <string_view>
#include <vector>

#include "foreign/look.h"

namespace candela::foreign {

/// The materials of a Wavefront MTL, with the physically based statements that its users agreed on (Pr, Pm, Ps, Pc,
/// Pcr, aniso, anisor, norm). Read by hand: Assimp 5.2 stops at "aniso" and knows no "map_Pr". What is malformed is
/// left out.
std::vector<Look> read_mtl(std::string_view text);

/// The material libraries that an OBJ names.
std::vector<std::string> material_libraries(std::string_view obj);

}  // namespace candela::foreign
