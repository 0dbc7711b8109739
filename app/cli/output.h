#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "image/develop.h"
#include "image/film.h"

namespace candela::cli {

/// True for the formats that keep linear radiance: .exr and .hdr.
bool is_linear_format(const std::filesystem::path& path);
bool has_extension(const std::filesystem::path& path, std::string_view extension);  ///< ignores case

/// Throws Error unless a file can appear at `path`: its folder exists and may be written.
void check_writable(const std::filesystem::path& path);

/// Whether a file's name (not that of its folder) holds one number to be filled in: %d, or %03d with leading zeros.
bool is_frame_pattern(const std::string& name);
/// The name of frame `index` of a pattern, or where there is no place for it the name itself. %% is a %.
std::string frame_name(const std::string& pattern, int index);
/// `name` with each % so that it is one in a pattern.
std::string literal_in_pattern(const std::string& name);

/// Writes `film` to each path, each file whole or not at all.
void write_outputs(const std::vector<std::filesystem::path>& paths, const Film& film, const DevelopSettings& develop);

}  // namespace candela::cli
