#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "image/codec.h"
#include "image/exr_guard.h"
#include "image/exr_layers.h"
#include "image/exr_stream.h"
#include "image/image_file.h"
#include "image/primaries.h"

namespace candela {

namespace {

using codec::ChannelChoice;
using codec::ChannelKind;
using codec::PartChoice;
using Imath::Box2i;
using Imath::V2i;

ivec2 size_of(const Box2i& window) { return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1}; }

// ----- pixels

/// One channel as it lies in the file: every `step` pixels from the corner of the data window.
struct Plane {
  Image image;
  ivec2 step{1};

  /// Between the four samples around a pixel of the data window, by straight lines.
  float at(int x, int y) const {
    const int left = x / step.x, top = y / step.y;
    const int right = std::min(left + 1, image.width - 1), bottom = std::min(top + 1, image.height - 1);
    const float u = static_cast<float>(x % step.x) / static_cast<float>(step.x);
    const float v = static_cast<float>(y % step.y) / static_cast<float>(step.y);
    const auto sample = [&](int i, int j) { return image.pixels[image.index(i, j)]; };
    const auto between = [](float a, float b, float t) { return t > 0.0f ? a + (b - a) * t : a; };
    return between(between(sample(left, top), sample(right, top), u),
                   between(sample(left, bottom), sample(right, bottom), u), v);
  }
};

bool is_subsampled(const Imf::Channel* channel) {
  return channel != nullptr && (channel->xSampling != 1 || channel->ySampling != 1);
}

Plane read_plane(Imf::InputPart& input, const std::string& name) {
  const Box2i data = input.header().dataWindow();
  const Imf::Channel& channel = input.header().channels()[name];
  Plane plane;
  plane.step = {channel.xSampling, channel.ySampling};
  plane.image = Image(size_of(data).x / plane.step.x, size_of(data).y / plane.step.y, 1);
  if (plane.image.empty()) throw std::runtime_error("channel \"" + name + "\" has no samples");
  Imf::FrameBuffer frame;
  frame.insert(
      name, Imf::Slice::Make(Imf::FLOAT, plane.image.pixels.data(), data, sizeof(float),
                             sizeof(float) * static_cast<std::size_t>(plane.image.width), plane.step.x, plane.step.y));
  input.setFrameBuffer(frame);
  input.readPixels(data.min.y, data.max.y);
  return plane;
}

/// What lies in both windows.
Box2i common(const Box2i& a, const Box2i& b) {
  return {V2i(std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y)),
          V2i(std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y))};
}

/// Channels with a sample for every pixel, to their places in `image`, which is the window `shown`.
void read_full(Imf::InputPart& input, const std::vector<std::string>& names, const Box2i& shown, Image& image) {
  const Box2i data = input.header().dataWindow(), both = common(data, shown);
  if (both.isEmpty() || names.empty()) return;
  constexpr int kBlock = 32;  // rows per read, a multiple of most compressions' blocks
  const auto data_width = static_cast<std::size_t>(size_of(data).x);
  const auto pixel_floats = static_cast<std::size_t>(image.channels);
  const std::size_t row_floats = data_width * pixel_floats;
  std::vector<float> block(row_floats * kBlock);
  for (int y = both.min.y; y <= both.max.y; y += kBlock) {
    const int rows = std::min(kBlock, both.max.y - y + 1);
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < names.size(); ++c) {
      if (names[c].empty()) continue;
      frame.insert(names[c], Imf::Slice::Make(Imf::FLOAT, block.data() + c, V2i(data.min.x, y),
                                              static_cast<std::int64_t>(data_width), rows, pixel_floats * sizeof(float),
                                              row_floats * sizeof(float)));
    }
    input.setFrameBuffer(frame);
    input.readPixels(y, y + rows - 1);
    for (int row = 0; row < rows; ++row) {
      const float* from = block.data() + static_cast<std::size_t>(row) * row_floats +
                          static_cast<std::size_t>(both.min.x - data.min.x) * pixel_floats;
      float* to = image.pixels.data() + image.index(both.min.x - shown.min.x, y + row - shown.min.y);
      std::copy_n(from, static_cast<std::size_t>(size_of(both).x) * pixel_floats, to);
    }
  }
}

/// The window `shown`; what the data window leaves open is black, what it has beyond is dropped.
Image read_pixels(Imf::InputPart& input, const ChannelChoice& choice, const Box2i& shown) {
  const ivec2 size = size_of(shown);
  Image image(size.x, size.y, choice.alpha.empty() ? 3 : 4);
  std::vector<std::string> full(static_cast<std::size_t>(image.channels));
  std::vector<std::size_t> sparse;
  for (std::size_t c = 0; c < full.size(); ++c) {
    const std::string& name = c == 3 ? choice.alpha : choice.names[c];
    if ((c > 0 && c < 3 && choice.is_single()) || name.empty()) continue;
    if (is_subsampled(input.header().channels().findChannel(name)))
      sparse.push_back(c);
    else
      full[c] = name;
  }
  read_full(input, full, shown, image);
  const Box2i data = input.header().dataWindow(), both = common(data, shown);
  for (const std::size_t c : sparse) {
    const Plane plane = read_plane(input, c == 3 ? choice.alpha : choice.names[c]);
    for (int y = both.min.y; y <= both.max.y; ++y)
      for (int x = both.min.x; x <= both.max.x; ++x)
        image.at(x - shown.min.x, y - shown.min.y)[c] = plane.at(x - data.min.x, y - data.min.y);
  }
  if (choice.is_single())
    for (std::size_t i = 0; i < image.pixels.size(); i += static_cast<std::size_t>(image.channels))
      image.pixels[i + 1] = image.pixels[i + 2] = image.pixels[i];
  return image;
}

/// RY = (R - Y) / Y and BY = (B - Y) / Y, where Y is the luminance by the file's primaries. Chroma between its samples
/// is a mean of colours that have R, G and B ≥ 0, and so has them as well.
void decode_chroma(const Primaries& primaries, Image& image) {
  const glm::dmat3 xyz = *xyz_from_rgb(primaries);
  const vec3 weight(xyz[0].y, xyz[1].y, xyz[2].y);  // they add up to 1
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const vec3 coded = image.rgb(x, y);
      const float red = (coded.y + 1.0f) * coded.x, blue = (coded.z + 1.0f) * coded.x;
      image.set_rgb(x, y, vec3(red, (coded.x - red * weight.x - blue * weight.z) / weight.y, blue));
    }
  }
}

// ----- what the header says

/// By the names that the Color Interop Forum gives to linear spaces (attribute `colorInteropID`).
struct NamedPrimaries {
  std::string_view name;
  Primaries primaries;
};
constexpr dvec2 kD65{0.3127, 0.3290}, kAcesWhite{0.32168, 0.33767};
constexpr std::array<NamedPrimaries, 7> kNamed{
    {{"lin_rec709_scene", kRec709},
     {"lin_p3d65_scene", {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65}},
     {"lin_rec2020_scene", {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65}},
     {"lin_adobergb_scene", {{0.640, 0.330}, {0.210, 0.710}, {0.150, 0.060}, kD65}},
     {"lin_ap1_scene", {{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, kAcesWhite}},
     {"lin_ap0_scene", {{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, kAcesWhite}},
     {"lin_ciexyzd65_scene", kXyz}}};

std::string text_of(const Imf::Header& header, const char* name) {
  const auto* text = header.findTypedAttribute<Imf::StringAttribute>(name);
  return text == nullptr ? "" : text->value();
}

/// What R, G and B of the file are, and what is told of it.
class FileColors {
 public:
  FileColors(const Imf::Header& header, std::vector<ImageFact>& facts) : facts_(facts) {
    if (Imf::hasChromaticities(header))
      take_chromaticities(Imf::chromaticities(header));
    else if (const std::string name = text_of(header, "colorInteropID"); !name.empty())
      take_name(name);
    if (Imf::hasAdoptedNeutral(header)) take_neutral(Imf::adoptedNeutral(header));
  }

  const Primaries& primaries() const { return primaries_; }
  /// Empty where nothing is to do.
  std::optional<mat3> matrix() const {
    if (is_same(primaries_, kRec709) && (!neutral_ || is_same({{}, {}, {}, *neutral_}, {{}, {}, {}, kRec709.white})))
      return std::nullopt;
    return rec709_from_rgb(primaries_, neutral_);
  }

 private:
  void take_chromaticities(const Imf::Chromaticities& c) {
    const auto point = [](const Imath::V2f& v) { return dvec2(static_cast<double>(v.x), static_cast<double>(v.y)); };
    take("chromaticities", {point(c.red), point(c.green), point(c.blue), point(c.white)});
  }

  void take_name(const std::string& name) {
    for (const NamedPrimaries& known : kNamed)
      if (known.name == name) return take("colorInteropID", known.primaries, name);
    const bool is_none = name == "data" || name == "unknown";
    facts_.push_back(
        {"colorInteropID", name, is_none ? "no colours: as they are" : "not known: taken as Rec.709", !is_none});
  }

  void take(const char* attribute, const Primaries& primaries, const std::string& value = {}) {
    ImageFact fact{attribute, value.empty() ? primaries_text(primaries) : value, "converted to Rec.709"};
    if (is_same(primaries, kRec709)) {
      fact.done = "Rec.709: nothing to do";
    } else if (rec709_from_rgb(primaries)) {
      primaries_ = primaries;
    } else {
      fact.done = "no colours of a display: taken as Rec.709";
      fact.is_odd = true;
    }
    facts_.push_back(std::move(fact));
  }

  void take_neutral(Imath::V2f v) {
    const dvec2 neutral(static_cast<double>(v.x), static_cast<double>(v.y));
    ImageFact fact{"adoptedNeutral", fmt::format("{:.4g} {:.4g}", v.x, v.y), "becomes the white of Rec.709"};
    fact.is_odd = !rec709_from_rgb(primaries_, neutral);
    if (fact.is_odd)
      fact.done = "no white: not used";
    else
      neutral_ = neutral;
    facts_.push_back(std::move(fact));
  }

  std::vector<ImageFact>& facts_;
  Primaries primaries_ = kRec709;
  std::optional<dvec2> neutral_;
};

/// In the file's data window, where OpenEXR's mapping to directions lives.
Projection projection_of(const Imf::Header& header, std::vector<ImageFact>& facts) {
  if (!Imf::hasEnvmap(header)) return Projection::unsaid;
  const int value = static_cast<int>(Imf::envmap(header));
  const ivec2 size = size_of(header.dataWindow());
  if (value == static_cast<int>(Imf::ENVMAP_LATLONG)) {
    facts.push_back({"envmap", "latlong", "as an environment read by OpenEXR's convention"});
    return Projection::latlong;
  }
  if (value == static_cast<int>(Imf::ENVMAP_CUBE) && size.x * 6 == size.y) {
    facts.push_back({"envmap", "cube", "as an environment read by OpenEXR's convention"});
    return Projection::cube;
  }
  const bool is_cube = value == static_cast<int>(Imf::ENVMAP_CUBE);
  facts.push_back({"envmap", is_cube ? "cube" : fmt::format("{}", value),
                   is_cube ? fmt::format("not used: {} x {} is no six faces", size.x, size.y) : "not used: unknown",
                   true});
  return Projection::unsaid;
}

void tell_windows(const Imf::Header& header, Projection projection, std::vector<ImageFact>& facts) {
  const Box2i& data = header.dataWindow();
  const Box2i& display = header.displayWindow();
  if (data != display) {
    const ivec2 size = size_of(data);
    facts.push_back({"dataWindow", fmt::format("{} x {} at {},{}", size.x, size.y, data.min.x, data.min.y),
                     projection == Projection::unsaid ? "black around it, cut to the display window"
                                                      : "taken for the whole, as an envmap's is"});
  }
  if (header.pixelAspectRatio() != 1.0f)
    facts.push_back({"pixelAspectRatio", fmt::format("{:.6g}", header.pixelAspectRatio()), "not used"});
  if (Imf::hasWhiteLuminance(header))
    facts.push_back({"whiteLuminance", fmt::format("{:.6g}", Imf::whiteLuminance(header)), "not used"});
}

void tell_choice(const Imf::MultiPartInputFile& file, const PartChoice& choice, std::vector<ImageFact>& facts) {
  const Imf::Header& header = file.header(choice.part);
  if (file.parts() > 1) {
    facts.push_back(
        {"part",
         fmt::format("{} of {}{}", choice.part, file.parts(), header.hasName() ? ", \"" + header.name() + "\"" : ""),
         "read"});
  }
  if (!choice.layer.empty()) facts.push_back({"layer", choice.layer, "read: the file has no other picture"});
  if (Imf::hasMultiView(header)) {
    std::string views;
    for (const std::string& view : Imf::multiView(header)) views += (views.empty() ? "" : " ") + view;
    facts.push_back({"multiView", views, "the first is read unless a layer is named"});
  }
  const std::string view = header.hasView() ? header.view() : "";
  if (!view.empty()) facts.push_back({"view", view, "read"});
  if (choice.channels.kind == ChannelKind::luma_chroma)
    facts.push_back({"Y RY BY", "luminance and chroma", "converted to R G B"});
}

ImageFile read_part(Imf::MultiPartInputFile& file, const PartChoice& choice) {
  Imf::InputPart input(file, choice.part);
  const Imf::Header& header = input.header();
  ImageFile result;
  tell_choice(file, choice, result.facts);
  result.projection = projection_of(header, result.facts);
  tell_windows(header, result.projection, result.facts);
  const bool is_whole = result.projection != Projection::unsaid;
  result.image = read_pixels(input, choice.channels, is_whole ? header.dataWindow() : header.displayWindow());

  const FileColors colors(header, result.facts);
  const ChannelKind kind = choice.channels.kind;
  if (kind == ChannelKind::luma_chroma) decode_chroma(colors.primaries(), result.image);
  const std::optional<mat3> matrix = colors.matrix();
  if (!matrix || (kind != ChannelKind::color && kind != ChannelKind::luma_chroma)) return result;
  const std::size_t moved = convert_to_rec709(result.image, *matrix);
  if (moved > 0)
    result.facts.push_back({"gamut", fmt::format("{} pixels beyond Rec.709", moved), "brought in at equal luminance"});
  return result;
}

/// Calls `work` with what OpenEXR throws made an Error.
template <class Work>
auto understood(const std::string& where, const Work& work) {
  return codec::converting_errors("damaged or unsupported OpenEXR: ", where, work);
}

}  // namespace

ImageFile codec::decode_exr(std::span<const std::byte> bytes, const std::string& layer, const std::string& where) {
  check_exr_header(bytes, where);
  return understood(where, [&] {
    MemoryInput stream(bytes, where);
    Imf::MultiPartInputFile file(stream, 0);
    return read_part(file, choose_part(file, layer, where));
  });
}

namespace {

ExrHeader header_of(const Imf::MultiPartInputFile& file) {
  ExrHeader result{codec::channel_names(file), codec::layer_names(file), {}};
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
        result.metadata.emplace(attribute.name(), text->value());
  }
  result.metadata.erase("type");  // the library adds it to files that have none
  return result;
}

}  // namespace

struct ExrFile::Parts {
  std::string where;
  std::vector<std::byte> bytes;
  std::optional<codec::MemoryInput> stream;
  std::optional<Imf::MultiPartInputFile> file;
  ExrHeader header;
};

ExrFile::ExrFile(const std::filesystem::path& path) : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.where = path.string();
  p.bytes = read_file(path);
  if (sniff_image_format(p.bytes) != ImageFormat::exr) throw Error("not an OpenEXR file", p.where);
  codec::check_exr_header(p.bytes, p.where);
  understood(p.where, [&] {
    p.stream.emplace(p.bytes, p.where);
    p.file.emplace(*p.stream, 0);
    p.header = header_of(*p.file);
  });
}

ExrFile::~ExrFile() = default;
ExrFile::ExrFile(ExrFile&&) noexcept = default;
ExrFile& ExrFile::operator=(ExrFile&&) noexcept = default;

const ExrHeader& ExrFile::header() const { return parts_->header; }

ImageFile ExrFile::read(const std::string& layer) {
  Parts& p = *parts_;
  ImageFile result =
      understood(p.where, [&] { return read_part(*p.file, codec::choose_part(*p.file, layer, p.where)); });
  result.format = ImageFormat::exr;
  return result;
}

ExrHeader read_exr_header(const std::filesystem::path& path) { return ExrFile(path).header(); }

}  // namespace candela
