#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "denoise/denoise.h"
#include "image/develop.h"
#include "math/types.h"

/// Pictures whose samples are divided among machines, or that are gone on with later.
namespace candela {

namespace path {
class Accumulator;
}

/// One of `count` parts of a picture's samples; the first has index 1.
struct PartRange {
  int index = 1;
  int count = 1;
};
/// "2/8". Throws Error for anything else.
PartRange parse_part(const std::string& text);

/// Sums of some of a picture's samples, and what else its picture needs. Of parts of one picture the sums can be added
/// in any order: without denoising the result has the bits that one machine would have given it.
struct PicturePart {
  std::string key;  ///< of the picture that it is part of: scene, version and settings
  int first_sample = 0, end_sample = 0;
  int samples = 0;  ///< of the whole picture, per pixel
  ivec2 size{0};
  std::set<Layer> layers = {};
  std::set<MatteKind> mattes = {};
  bool has_features = false, has_through = false;
  mat3 camera_from_world{1.0f};  ///< the rotation
  std::map<MatteKind, std::map<std::uint32_t, std::string>> names = {};
  std::map<Layer, Image> centres = {};  ///< the layers that have no mean
  std::map<std::string, std::string> metadata = {};
  DevelopSettings develop = {};                  ///< that its makers asked for
  std::optional<denoise::Method> denoiser = {};  ///< likewise
  std::vector<std::byte> sums = {};              ///< as path::Accumulator writes them
};

/// A file that appears whole or not at all, packed without loss. Throws Error.
void write_part(const std::filesystem::path& path, const PicturePart& part);
/// Throws Error for a file that is damaged, of another version, or none.
PicturePart read_part(const std::filesystem::path& path);

/// The same in memory; `where` says in errors what they are of.
std::vector<std::byte> bytes_of_part(const PicturePart& part);
PicturePart part_of_bytes(std::span<const std::byte> bytes, const std::string& where);

/// A picture of parts. The bits do not depend on their order.
class MergedPicture {
 public:
  MergedPicture();
  ~MergedPicture();
  /// Throws Error for a part of another picture, and for samples that are there already; `name` says whose they are.
  /// What was added before remains.
  void add(PicturePart part, const std::string& name);
  /// Not denoised. Warns of samples that are missing: it has more noise than the whole picture, and is as right.
  Film film(Diagnostics* diagnostics = nullptr) const;
  const PicturePart& first() const { return parts_.front(); }

 private:
  std::vector<PicturePart> parts_;  ///< without sums; the first alone with the layers of centres
  std::vector<std::string> names_;
  std::unique_ptr<path::Accumulator> sums_;
  std::unique_ptr<path::Accumulator> read_;  ///< those of one part, for the room that they take
};

}  // namespace candela
