#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"

// Numbers for programs that read text: spherical harmonics and two-dimensional tables as JSON and as C headers. All
// write whole files or none, print the shortest text that reads back as the same float, and throw Error for numbers
// that are not finite.
namespace candela {

/// What stands beside the coefficients, so that nobody has to guess.
struct ShText {
  std::string unit;    ///< of the coefficients, e.g. "radiance" or "irradiance / pi"
  std::string basis;   ///< e.g. "real, orthonormal, without the Condon-Shortley sign, l (l + 1) + m"
  std::string axes;    ///< by which the harmonics are evaluated, as axes_text() says
  std::string source;  ///< the environment
};
/// RGB per coefficient. The header declares `name_coefficients` and the array `name`.
void write_sh_json(const std::filesystem::path& path, std::span<const dvec3> coefficients, const ShText& text);
void write_sh_header(const std::filesystem::path& path, std::span<const dvec3> coefficients, const ShText& text,
                     const std::string& name);

struct TableText {
  std::string title;                  ///< what the table is
  std::string columns;                ///< what runs along a row, e.g. "NoV, in the middle of texels"
  std::string rows;                   ///< what runs down the rows
  std::vector<std::string> channels;  ///< one name for each of the image's first channels; others are not written
};
/// Values by row, column and channel. The header declares `name_width`, `name_height`, `name_channels` and `name`.
void write_table_json(const std::filesystem::path& path, const Image& table, const TableText& text);
void write_table_header(const std::filesystem::path& path, const Image& table, const TableText& text,
                        const std::string& name);

}  // namespace candela
