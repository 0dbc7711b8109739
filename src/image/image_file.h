#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"

namespace candela {

enum class ImageFormat { unknown, png, jpeg, webp, avif, hdr, exr };

/// From the first bytes, never from a name; so many are enough.
inline constexpr std::size_t kSniffedBytes = 64;
ImageFormat sniff_image_format(std::span<const std::byte> bytes);
/// "PNG", "JPEG", "WebP", "AVIF", "Radiance HDR", "OpenEXR" or "unknown".
const char* format_name(ImageFormat format);
/// Whether its texels are those of a display, 8 or 16 bits of sRGB: PNG, JPEG, WebP, AVIF.
bool is_display_format(ImageFormat format);

/// One thing that a file says of its pixels, and what reading made of it.
struct ImageFact {
  std::string name;     ///< "chromaticities", "EXPOSURE"
  std::string value;    ///< as the file has it
  std::string done;     ///< "converted to Rec.709"
  bool is_odd = false;  ///< it could not be followed: whoever uses the picture should hear of it
};

/// What the header of a PNG, JPEG, WebP, AVIF or KTX 2 says.
struct ImageHeader {
  ivec2 size{0};
  int bits = 8;  ///< per channel of the texels that decoding gives: 8 or 16
  bool has_alpha = false;
  std::vector<ImageFact> facts = {};  ///< odd ones
};

/// From the header alone, without a pixel decoded; throws Error(…, where) when it is none of them or is damaged.
ImageHeader read_image_header(std::span<const std::byte> bytes, const std::string& where);
/// Width and height of it.
ivec2 read_image_size(std::span<const std::byte> bytes, const std::string& where);

/// Decodes PNG, JPEG, WebP, AVIF or the largest level of a KTX 2 to RGBA texels. Throws Error(…, where) for other
/// formats, damaged data or sizes above 16384. Of an animation it is the first frame; what files say of colour spaces
/// is ignored, as glTF 2.0 §3.8.1 asks for; an AVIF of 10 or 12 bits becomes 16, and is turned as it says.
TextureImage decode_texture(std::span<const std::byte> bytes, const std::string& where);

/// A PNG of 8 bits per channel, which says nothing of how they are encoded.
std::vector<std::byte> encode_png(const TextureImage& image);

/// Numbers, as a grey PNG of 8 or 16 bits: depths, masks. `values` by rows from the top, those above what the bits hold
/// as the largest.
std::vector<std::byte> encode_grey_png(ivec2 size, int bits, std::span<const std::uint32_t> values);

/// How a picture of light from everywhere covers the directions, where the file itself says so (OpenEXR's `envmap`).
enum class Projection { unsaid, latlong, cube };

/// A picture and what its file says of it.
struct ImageFile {
  Image image;
  ImageFormat format = ImageFormat::unknown;
  Projection projection = Projection::unsaid;
  std::vector<ImageFact> facts;
};

/// The name of a picture: a file, or FILE:LAYER for one layer of an OpenEXR file. Where a file of the whole name
/// exists, that is meant; else the longest part before a colon that is a file.
struct ImageName {
  std::filesystem::path path;
  std::string layer;

  /// For people: FILE or FILE:LAYER.
  std::string text() const { return layer.empty() ? path.string() : path.string() + ":" + layer; }
};
ImageName parse_image_name(const std::string& name);

/// Reads a linear image in Rec.709: Radiance .hdr (RGBE and XYZE), OpenEXR, PNG, JPEG, WebP and AVIF (sRGB
/// decoded). The result has 3 channels, or 4 where the file has alpha, which is premultiplied on the way in.
///
/// Of an OpenEXR file the picture is the first part with R, G, B, with Y, RY, BY or with Y; else the only layer that
/// has these; else data (X, Y, Z of a position, Z of a depth). A layer is "LAYER.*" in any part, or a part or a view of
/// that name. What chromaticities, PRIMARIES, COLORCORR, EXPOSURE and the like ask for is done, and told in `facts`.
ImageFile read_image_file(const ImageName& name);
/// The picture alone. Without `layer`, `path` may be FILE:LAYER.
Image read_image(const std::filesystem::path& path, const std::string& layer = {});

/// What the headers of an OpenEXR file say, without its pixels.
struct ExrHeader {
  std::vector<std::string> channels;            ///< full names, sorted within each part, e.g. "R", "albedo.R"
  std::vector<std::string> layers;              ///< sorted: what can be read by name
  std::map<std::string, std::string> metadata;  ///< every string attribute by name; the first part's where they differ
};
/// Throws Error.
ExrHeader read_exr_header(const std::filesystem::path& path);

/// An OpenEXR file of which several layers are wanted: it is read and opened once.
class ExrFile {
 public:
  /// Throws Error.
  explicit ExrFile(const std::filesystem::path& path);
  ~ExrFile();
  ExrFile(ExrFile&&) noexcept;
  ExrFile& operator=(ExrFile&&) noexcept;

  const ExrHeader& header() const;
  /// The picture, or that layer, as read_image_file() gives it. Throws Error.
  ImageFile read(const std::string& layer = {});

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Radiance RGBE, run-length coded; negative values are clamped to 0. Alpha is dropped.
void write_hdr(const std::filesystem::path& path, const Image& image);

}  // namespace candela
