#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "image/film.h"

// Mattes as OpenEXR files have them: "Cryptomatte Specification", version 1.2.0, Psyop 2018. Private to this folder.
namespace candela::codec {

/// MurmurHash3 for x86, 32 bits, seed 0, of a name in UTF-8, whose exponent as a float is neither all 0 nor all 1.
std::uint32_t cryptomatte_hash(std::string_view name);

/// The attributes and the picture pairs of one kind of mattes.
struct Cryptomatte {
  std::string prefix;         ///< of the attributes: cryptomatte/1234567/
  std::string manifest;       ///< JSON: names and their hashes in hexadecimal
  std::vector<Image> levels;  ///< 4 channels: hash, coverage, hash, coverage
};
Cryptomatte make_cryptomatte(std::string_view layer, const Mattes& mattes);

}  // namespace candela::codec
