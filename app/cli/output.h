#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "image/develop.h"
#include "image/film.h"

namespace candela::cli {

/// True for the formats that keep linear radiance: .exr and .hdr.
bool is_linear_format(const std::filesystem::path& path);
bool has_extension(const std::filesystem::path& path, std::string_view extension);  ///< ignores case

/// Throws Error unless a file can appear at `path`: its folder, or the nearest one above it that exists, may be
/// written.
void check_writable(const std::filesystem::path& path);

/// The extension of the format that a name asks for on standard output: ".png" of "-", and of png:-, jpg:-, webp:-,
/// hdr:- and exr:- their own. Empty for the name of a file.
std::string standard_output_format(const std::string& name);
/// Has `write` make a file of that extension and sends it to standard output as a whole.
void write_standard_output(const std::string& extension,
                           const std::function<void(const std::filesystem::path&)>& write);

/// Makes the folder of a file and those above it. What it made and nothing was written into goes away again with it.
class FolderFor {
 public:
  explicit FolderFor(const std::filesystem::path& file);
  ~FolderFor();
  FolderFor(const FolderFor&) = delete;
  FolderFor& operator=(const FolderFor&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  ///< the outermost first
};

/// Whether a file's name (not that of its folder) holds one number to be filled in: %d, or %03d with leading zeros.
bool is_frame_pattern(const std::string& name);
/// The name of frame `index` of a pattern, or where there is no place for it the name itself. %% is a %.
std::string frame_name(const std::string& pattern, int index);
/// `name` with each % so that it is one in a pattern.
std::string literal_in_pattern(const std::string& name);

/// Writes `film` to each path, each file whole or not at all; folders are made.
void write_outputs(const std::vector<std::filesystem::path>& paths, const Film& film, const DevelopSettings& develop);

}  // namespace candela::cli
