#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace candela::cli {

/// What an OpenEXR file says about itself, without its pixels.
struct ExrHeader {
  std::vector<std::string> channels;            ///< full names, e.g. "R", "albedo.R"
  std::map<std::string, std::string> metadata;  ///< attributes of type string
};

/// Of the first part. Throws Error(…, where) for a header that is damaged.
ExrHeader read_exr_header(std::span<const std::byte> bytes, const std::string& where);

}  // namespace candela::cli
