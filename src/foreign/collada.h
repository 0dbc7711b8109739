#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace candela::foreign {

/// A COLLADA in which every camera and light has a name: COLLADA 1.4 asks for none, but Assimp up to 5.4 leaves out
/// what a camera without one says.
std::vector<std::byte> with_names(std::span<const std::byte> collada);

}  // namespace candela::foreign
