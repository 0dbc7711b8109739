#pragma once

#include <filesystem>
#include <string>

namespace candela {

/// With the letters A to Z small, whatever else it holds.
std::string lower_case(std::string text);

/// What a file's name ends with, in small letters: ".gltf", or empty.
std::string lower_extension(const std::filesystem::path& path);

}  // namespace candela
