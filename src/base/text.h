#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace candela {

/// With the letters A to Z small, whatever else it holds.
std::string lower_case(std::string text);

/// What a file's name ends with, in small letters: ".gltf", or empty.
std::string lower_extension(const std::filesystem::path& path);

/// "1 texel", "2 texels".
std::string counted(std::uint64_t count, std::string_view thing);

/// The one of `names` that `text` is most likely a slip of: with the fewest letters inserted, left out, exchanged or
/// swapped with their neighbour, at most one for each three letters; the first of equals, empty if there is none.
std::string nearest_name(std::string_view text, std::span<const std::string> names);
/// "did you mean NAME?", preceded by `before`; empty if there is none.
std::string did_you_mean(std::string_view text, std::span<const std::string> names, std::string_view before = ": ");

/// The double that is written with as many digits as the float needs to be itself: 0.1 of 0.1f.
double decimal_of(float value);

}  // namespace candela
