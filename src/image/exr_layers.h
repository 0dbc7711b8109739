#pragma once

#include <ImfMultiPartInputFile.h>

#include <array>
#include <string>
#include <vector>

// Which channels of an OpenEXR file are the picture. Private to this folder.
namespace candela::codec {

/// What three channels mean.
enum class ChannelKind {
  color,        ///< R, G, B
  luma_chroma,  ///< Y, RY, BY
  grey,         ///< Y
  data,         ///< X, Y, Z of a position, Z of a depth, X and Y or U and V of a vector in the picture: no colours
};

/// The file's channels that become r, g, b, a of an image; one name thrice where one channel is all.
struct ChannelChoice {
  ChannelKind kind = ChannelKind::color;
  std::array<std::string, 3> names;  ///< the third of a vector in the picture is empty, and reads as 0
  std::string alpha;                 ///< empty = none

  bool is_single() const { return names[0] == names[1]; }
};

struct PartChoice {
  int part = 0;
  std::string layer;  ///< that was found without being asked for; else empty
  ChannelChoice channels;
};

/// See read_image_file. Throws Error(…, where) that lists what there is.
PartChoice choose_part(const Imf::MultiPartInputFile& file, const std::string& layer, const std::string& where);

/// Full names of the channels, part by part.
std::vector<std::string> channel_names(const Imf::MultiPartInputFile& file);

/// What can be asked for by name: layers of channels, and parts where there are several; sorted.
std::vector<std::string> layer_names(const Imf::MultiPartInputFile& file);

}  // namespace candela::codec
