#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "image/codec.h"
#include "image/exr_guard.h"
#include "image/film.h"
#include "image/image_file.h"

namespace candela {

namespace {

using Imath::Box2i;
using Imath::V2i;

class MemoryInput final : public Imf::IStream {
 public:
  MemoryInput(std::span<const std::byte> bytes, const std::string& where) : IStream(where.c_str()), bytes_(bytes) {}

  bool read(char out[], int count) override {
    const auto n = static_cast<std::uint64_t>(count);
    if (count < 0 || offset_ > bytes_.size() || n > bytes_.size() - offset_)
      throw std::runtime_error("the file is truncated");
    std::memcpy(out, bytes_.data() + offset_, n);
    offset_ += n;
    return offset_ < bytes_.size();
  }
  std::uint64_t tellg() override { return offset_; }
  void seekg(std::uint64_t position) override { offset_ = position; }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t offset_ = 0;
};

class MemoryOutput final : public Imf::OStream {
 public:
  explicit MemoryOutput(const std::string& where) : OStream(where.c_str()) {}

  void write(const char data[], int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (bytes.size() < offset_ + n) bytes.resize(offset_ + n);
    std::memcpy(bytes.data() + offset_, data, n);
    offset_ += n;
  }
  std::uint64_t tellp() override { return offset_; }
  void seekp(std::uint64_t position) override { offset_ = position; }

  std::vector<std::byte> bytes;

 private:
  std::size_t offset_ = 0;
};

/// Runs `body`, turning whatever OpenEXR throws into an Error.
template <class Body>
auto converting_errors(const char* what, const std::string& where, Body body) {
  try {
    return body();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(std::string(what) + e.what(), where);
  }
}

// ----- reading

/// The file's channels that become r, g, b, a of an image; one name thrice for a grey picture.
struct ChannelChoice {
  std::string rgb[3];
  std::string alpha;  ///< empty = none

  bool is_grey() const { return rgb[0] == rgb[1]; }
};

std::optional<ChannelChoice> choose_channels(const Imf::ChannelList& channels, const std::string& layer) {
  const std::string prefix = layer.empty() ? "" : layer + ".";
  const auto has = [&](const std::string& name) { return channels.findChannel(name) != nullptr; };
  const std::string alpha = has(prefix + "A") ? prefix + "A" : "";
  for (const char* names : {"RGB", "XYZ"}) {
    const ChannelChoice choice{{prefix + names[0], prefix + names[1], prefix + names[2]}, alpha};
    if (has(choice.rgb[0]) && has(choice.rgb[1]) && has(choice.rgb[2])) return choice;
  }
  if (has(prefix + "Y") && (has(prefix + "RY") || has(prefix + "BY")))
    throw std::runtime_error("luminance/chroma pictures are not supported");
  for (const char* name : {"Y", "Z", "V"})
    if (has(prefix + name)) return ChannelChoice{{prefix + name, prefix + name, prefix + name}, alpha};
  if (!layer.empty() && has(layer)) return ChannelChoice{{layer, layer, layer}, ""};
  return std::nullopt;
}

std::string channel_names(const Imf::MultiPartInputFile& file) {
  std::string names;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::ChannelList& channels = file.header(part).channels();
    for (auto c = channels.begin(); c != channels.end(); ++c)
      names += (names.empty() ? "" : ", ") + std::string(c.name());
  }
  return names.substr(0, 200);  // one line of a message
}

struct PartChoice {
  int part = 0;
  ChannelChoice channels;
};

/// Without a layer the first part's picture; else the first part that holds "layer.*", or that is itself named so.
PartChoice choose_part(const Imf::MultiPartInputFile& file, const std::string& layer, const std::string& where) {
  const int searched = layer.empty() ? 1 : file.parts();
  for (int part = 0; part < searched; ++part) {
    const Imf::Header& header = file.header(part);
    if (header.hasType() && !Imf::isImage(header.type())) throw Error("deep pixels are not supported", where);
    if (auto channels = choose_channels(header.channels(), layer)) return {part, *channels};
    if (!layer.empty() && header.hasName() && header.name() == layer)
      if (auto channels = choose_channels(header.channels(), {})) return {part, *channels};
  }
  const std::string wanted = layer.empty() ? "picture (R,G,B or Y)" : "layer \"" + layer + "\"";
  throw Error("no " + wanted + " among the channels " + channel_names(file), where);
}

Image read_part(Imf::MultiPartInputFile& file, const PartChoice& choice, const std::string& where) {
  Imf::InputPart input(file, choice.part);
  const Imf::Header& header = input.header();
  const Box2i data = header.dataWindow();
  const Box2i display = header.displayWindow();
  const ChannelChoice& names = choice.channels;
  for (const std::string& name : {names.rgb[0], names.rgb[1], names.rgb[2], names.alpha}) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (channel && (channel->xSampling != 1 || channel->ySampling != 1))
      throw Error("channel \"" + name + "\" is subsampled, which is not supported", where);
  }

  // The result is the display window; what the data window leaves open is black, what it has beyond is dropped.
  const int channels = names.alpha.empty() ? 3 : 4;
  Image image(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1, channels);
  const int first_y = std::max(data.min.y, display.min.y), last_y = std::min(data.max.y, display.max.y);
  const int first_x = std::max(data.min.x, display.min.x), last_x = std::min(data.max.x, display.max.x);
  if (first_x > last_x) return image;

  constexpr int kBlock = 32;  // rows per read, a multiple of most compressions' blocks
  const auto data_width = static_cast<std::size_t>(data.max.x - data.min.x + 1);
  const std::size_t pixel_floats = static_cast<std::size_t>(channels);
  const std::size_t row_floats = data_width * pixel_floats;
  std::vector<float> block(row_floats * kBlock);
  for (int y = first_y; y <= last_y; y += kBlock) {
    const int rows = std::min(kBlock, last_y - y + 1);
    Imf::FrameBuffer frame;
    const auto bind = [&](const std::string& name, std::size_t c) {
      frame.insert(name, Imf::Slice::Make(Imf::FLOAT, block.data() + c, V2i(data.min.x, y),
                                          static_cast<std::int64_t>(data_width), rows, pixel_floats * sizeof(float),
                                          row_floats * sizeof(float)));
    };
    for (std::size_t c = 0; c < (names.is_grey() ? 1u : 3u); ++c) bind(names.rgb[c], c);
    if (channels == 4) bind(names.alpha, 3);
    input.setFrameBuffer(frame);
    input.readPixels(y, y + rows - 1);
    for (int row = 0; row < rows; ++row) {
      const float* from = block.data() + static_cast<std::size_t>(row) * row_floats +
                          static_cast<std::size_t>(first_x - data.min.x) * pixel_floats;
      float* to = image.pixels.data() + image.index(first_x - display.min.x, y + row - display.min.y);
      std::copy_n(from, static_cast<std::size_t>(last_x - first_x + 1) * pixel_floats, to);
    }
  }
  if (names.is_grey())
    for (std::size_t i = 0; i < image.pixels.size(); i += pixel_floats)
      image.pixels[i + 1] = image.pixels[i + 2] = image.pixels[i];
  return image;
}

// ----- writing

/// Adds one channel of an image to header and frame buffer. The frame buffer's type is not const, but is only read.
void add_channel(Imf::Header& header, Imf::FrameBuffer& frame, const std::string& name, const Image& image,
                 std::size_t channel) {
  const auto pixel_bytes = static_cast<std::size_t>(image.channels) * sizeof(float);
  header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  frame.insert(name, Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + channel, V2i(0, 0), image.width, image.height,
                                      pixel_bytes, pixel_bytes * static_cast<std::size_t>(image.width)));
}

bool is_opaque(const Image& image) {
  if (image.channels != 4) return true;
  for (std::size_t i = 3; i < image.pixels.size(); i += 4)
    if (image.pixels[i] != 1.0f) return false;
  return true;
}

void add_rgb(Imf::Header& header, Imf::FrameBuffer& frame, const std::string& name, const Image& image) {
  const char* const suffixes[] = {".R", ".G", ".B"};
  for (std::size_t c = 0; c < 3; ++c) add_channel(header, frame, name + suffixes[c], image, c);
}

/// Whether any pixel lets so much more of one colour through than of another that 8 bits could show it.
bool is_colored(const Image& through) {
  constexpr float kLeast = 1.0f / 512.0f;
  for (std::size_t i = 0; i < through.pixels.size(); i += 4) {
    const float* t = through.pixels.data() + i;
    if (std::max({t[0], t[1], t[2]}) - std::min({t[0], t[1], t[2]}) > kLeast) return true;
  }
  return false;
}

void add_layer(Imf::Header& header, Imf::FrameBuffer& frame, Layer layer, const Image& image) {
  const std::string name(layer_name(layer));
  if (image.channels == 1) {
    add_channel(header, frame, name + (layer == Layer::depth ? ".Z" : ".Y"), image, 0);
    return;
  }
  add_rgb(header, frame, name, image);
}

void add_metadata(Imf::Header& header, const std::map<std::string, std::string>& metadata, const std::string& where) {
  for (const auto& [key, value] : metadata) {
    if (key.empty() || key.size() > 255 || header.find(key.c_str()) != header.end())
      throw Error("\"" + key + "\" cannot be the name of an OpenEXR attribute", where);
    header.insert(key.c_str(), Imf::StringAttribute(value));
  }
}

void check_film(const Film& film, const std::string& where) {
  if (film.beauty.empty()) throw Error("cannot write an empty picture", where);
  for (const auto& [layer, image] : film.layers)
    if (image.width != film.width() || image.height != film.height())
      throw Error("layer \"" + std::string(layer_name(layer)) + "\" differs in size from the picture", where);
}

/// The noise of a rendered picture in 32 bits hardly compresses: RLE removes what is flat in a tenth of ZIP's time.
/// Layers are smooth: there ZIP halves the file, row by row at the lowest level nearly as well as by any other way. The
/// table is in docs/performance.md.
void set_compression(Imf::Header& header, const Film& film) {
  header.compression() = film.layers.empty() ? Imf::RLE_COMPRESSION : Imf::ZIPS_COMPRESSION;
  header.zipCompressionLevel() = 1;
}

std::size_t film_bytes(const Film& film) {
  std::size_t floats = film.beauty.pixels.size() + film.through.pixels.size();
  for (const auto& [layer, image] : film.layers) floats += image.pixels.size();
  return floats * sizeof(float);
}

}  // namespace

Image codec::decode_exr(std::span<const std::byte> bytes, const std::string& layer, const std::string& where) {
  check_exr_header(bytes, where);
  return converting_errors("damaged or unsupported OpenEXR: ", where, [&] {
    MemoryInput stream(bytes, where);
    Imf::MultiPartInputFile file(stream, 0);
    return read_part(file, choose_part(file, layer, where), where);
  });
}

ExrHeader read_exr_header(const std::filesystem::path& path) {
  const std::string where = path.string();
  const std::vector<std::byte> bytes = read_file(path);
  if (sniff_image_format(bytes) != ImageFormat::exr) throw Error("not an OpenEXR file", where);
  codec::check_exr_header(bytes, where);
  return converting_errors("damaged or unsupported OpenEXR: ", where, [&] {
    MemoryInput stream(bytes, where);
    const Imf::MultiPartInputFile file(stream, 0);
    ExrHeader result;
    const Imf::Header& header = file.header(0);
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
      result.channels.emplace_back(channel.name());
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
        result.metadata[attribute.name()] = text->value();
    result.metadata.erase("type");  // the library adds it to files that have none
    return result;
  });
}

void write_exr(const std::filesystem::path& path, const Film& film) {
  const std::string where = path.string();
  check_film(film, where);
  const std::vector<std::byte> bytes = converting_errors("cannot encode OpenEXR: ", where, [&] {
    Imf::Header header(film.width(), film.height());
    set_compression(header, film);
    Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec.709
    Imf::FrameBuffer frame;
    const Image& beauty = film.beauty;
    const char* const names[] = {"R", "G", "B"};
    if (beauty.channels == 1) add_channel(header, frame, "Y", beauty, 0);
    for (std::size_t c = 0; beauty.channels >= 3 && c < 3; ++c) add_channel(header, frame, names[c], beauty, c);
    if (!is_opaque(beauty)) add_channel(header, frame, "A", beauty, 3);
    if (is_colored(film.through)) add_rgb(header, frame, "through", film.through);
    for (const auto& [layer, image] : film.layers) add_layer(header, frame, layer, image);
    add_metadata(header, film.metadata, where);

    MemoryOutput stream(where);
    // A block that would grow is stored as it is: nothing is ever moved, and what is not needed is never touched.
    constexpr std::uint64_t kHeader = 65536;
    stream.bytes.reserve(kHeader + film_bytes(film));
    {
      // Blocks are compressed side by side and written in order, and there is no date attribute: the same film gives
      // the same bytes for any number of threads. The destructor writes the index.
      const int workers = thread_count() > 1 ? thread_count() : 0;
      if (Imf::globalThreadCount() < workers) Imf::setGlobalThreadCount(workers);
      Imf::OutputFile output(stream, header, workers);
      output.setFrameBuffer(frame);
      output.writePixels(film.height());
    }
    return std::move(stream.bytes);
  });
  write_file(path, bytes);
}

}  // namespace candela
