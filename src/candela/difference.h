#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "candela/shot.h"
#include "image/develop.h"
#include "image/image_file.h"

/// How far one picture is from another: as the eye sees it (FLIP), and in numbers.
namespace candela {

struct DifferenceSettings {
  std::optional<float> exposure = {};  ///< factor for linear pictures; empty = what the first one's meter says
  ToneCurve tone_curve = ToneCurve::pbr_neutral;  ///< for linear pictures
  double tolerance = 0.0;                         ///< a pixel has changed where any channel differs by more
};

/// A picture or a layer beside another, over all channels that both have.
struct LayerDifference {
  std::string layer;        ///< empty = the picture itself
  double mean = 0.0;        ///< of |second − first|, of the values that are finite in both
  double max = 0.0;         ///< the largest of these
  std::size_t changed = 0;  ///< pixels
  std::size_t broken = 0;   ///< pixels with a value that is finite in one picture alone, or NaN; they have changed too
};

struct PictureDifference {
  ivec2 size{0};
  /// Whether both are display pictures. Values are then what is shown, 0 to 1; else linear radiance.
  bool is_display = false;
  double flip = 0.0;                    ///< mean of `error`
  double flip_max = 0.0;                ///< largest of it
  std::vector<LayerDifference> layers;  ///< the picture, then the layers that both OpenEXR files have
  std::vector<std::string> unmatched;   ///< layers that one of the two lacks
  Image error;                          ///< FLIP of each pixel, 1 channel, as flip() says
  DisplayImage first, second;           ///< as a display shows them, transparent where they are
};

/// Compares a picture with its reference, `first`. Linear ones are developed with one exposure for FLIP; transparent
/// ones are seen over black and over white, and the larger error counts. Throws Error for what cannot be read and for
/// sizes that differ.
PictureDifference compare_pictures(const ImageName& first, const ImageName& second, const DifferenceSettings& settings);

/// The same of two pictures that are both shown as `develop` says, without its background, bloom and dithering: its
/// exposure, else what the first one's meter says. Values are those that a display shows.
PictureDifference compare_films(const Film& first, const Film& second, const DevelopSettings& develop,
                                double tolerance = 0.0);

/// Pictures of two models, or of one in two ways, and how far one is from the other.
struct ShotDifference {
  std::size_t index = 0;
  PictureLabel label;
  PictureDifference difference;
};

/// Takes the pictures of both shots as Take::prepare_beside() says, compares each of the second with that of the first,
/// as a display shows both, and passes it to `take`. Of `settings` the tolerance counts alone: how light is shown is
/// the first shot's. Holds all pictures of the first. Warnings go to Job::diagnostics. Throws Error as Take does,
/// Interrupted after a stop.
void compare_shots(const Shot& first, const Shot& second, const DifferenceSettings& settings,
                   const std::function<void(ShotDifference)>& take, const Job& job = {});

/// A file of two folders, by its name below them. A path is empty where that folder has none.
struct FilePair {
  std::string name;
  std::filesystem::path first, second;
};
/// All pictures below two folders (.png .jpg .jpeg .webp .avif .hdr .exr), sorted by name. Throws Error if there is
/// none.
std::vector<FilePair> picture_pairs(const std::filesystem::path& first, const std::filesystem::path& second);
/// All scenes below them, as scenes_below() finds them; none where one of the two has none.
std::vector<FilePair> scene_pairs(const std::filesystem::path& first, const std::filesystem::path& second);

/// What can be compared: a picture with a picture, a folder with a folder, a scene with a scene.
enum class Comparable { picture, folder, scene };
/// What a name means: a folder, "demo:NAME", a picture by its content or its extension or FILE.exr:LAYER; else a scene.
Comparable comparable_of(const std::string& name);

/// An error of 0 to 1 in colours whose lightness grows with it: black, violet, red, orange, pale yellow.
DisplayImage error_map(const Image& error);

}  // namespace candela
