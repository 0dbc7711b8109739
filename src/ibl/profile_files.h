#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ibl/profile.h"

namespace candela::ibl {

/// Harmonics of radiance about the world's axes, as the engine evaluates them: in its unit and about its axes. Throws
/// Error where the engine takes none, or for fewer than three bands where it wants a polynomial.
std::vector<dvec3> sh_for(const Profile& profile, std::span<const dvec3> radiance);

/// What was baked, in the axes of the world; what is absent (null or empty) is not written.
struct BakedLight {
  const Cubemap* specular = nullptr;  ///< level l filtered for roughness_of_level(l), level 0 sharp
  const Image* panorama = nullptr;    ///< where the light came as one; else it is made from the cube where it is wanted
  const CubeFaces* diffuse = nullptr;  ///< irradiance
  std::span<const dvec3> sh = {};      ///< of radiance
  const Image* table = nullptr;        ///< scale, bias and a third channel, as arrange_table takes it
  std::string source = {};             ///< name of the environment
};

struct WrittenFiles {
  std::vector<std::filesystem::path> paths;
  EncodingLoss loss;  ///< what the formats could not hold, over all files
};

/// Writes into `folder`, which exists, what the engine takes: `specular` as its container (or `environment.exr`, or six
/// `specular_px.hdr` …; of engines that filter themselves level 0 alone), `diffuse`, `sh.json` and `sh.h`, and the
/// table as `dfg.exr` and `dfg.ktx2`. Each file appears whole or not at all. Throws Error.
WrittenFiles write_for(const Profile& profile, const std::filesystem::path& folder, const BakedLight& light);

}  // namespace candela::ibl
