#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "image/texture_file.h"
#include "math/types.h"

namespace candela {

/// What a scene's file holds and the scene does not show any more: loading drops triangles without an area, makes
/// normals unit, makes tangents, and keeps of an image its pixels alone.
struct FileSurvey {
  struct Image {
    std::string name;            ///< of the image, else of its file; may be empty
    std::string format;          ///< "PNG", "WebP" or "KTX 2, uastc-4x4, zstd"; else what it looks like, or "unknown"
    std::size_t file_bytes = 0;  ///< encoded; 0 where they cannot be had
    int bits = 8;                ///< per channel
    bool has_alpha = false;      ///< a channel of its own, or transparent colours of a PNG
    std::optional<TextureInfo> texture;  ///< what a KTX 2 says of itself
    std::string error;                   ///< why it cannot be read, with its place; empty = it can
    int file_index = -1;
  };

  struct Primitive {
    std::string where;  ///< file and JSON pointer
    int material = 0;   ///< of the scene
    std::size_t triangles = 0;
    std::size_t degenerate = 0;             ///< triangles of a list that name a vertex twice or have no area
    std::size_t normals = 0;                ///< 0 = the file has none
    std::size_t normals_off_unit = 0;       ///< further from unit length than rounding explains
    float worst_normal_length = 1.0f;       ///< the one furthest from 1
    bool has_tangents = false;              ///< in the file
    std::vector<int> missing_uv_sets = {};  ///< that the material's textures read, ascending
  };

  /// A file that is named and lies outside of the scene's own folder, all links resolved.
  struct Outside {
    std::string where;  ///< file and JSON pointer
    std::string name;   ///< as the file has it
  };

  /// What EXT_lights_image_based says of irradiance, beside the pictures that the scene is lit by.
  struct Irradiance {
    std::vector<dvec3> coefficients;  ///< of harmonics to degree 2, as ibl::Sh has them; empty = it says nothing
    quat world_from_light{1.0f, 0.0f, 0.0f, 0.0f};
  };

  std::vector<Image> images;          ///< as Scene::images
  std::vector<Primitive> primitives;  ///< of triangles, each once, in the file's order
  std::vector<Outside> outside;       ///< in the file's order
  Irradiance irradiance;
};

}  // namespace candela
