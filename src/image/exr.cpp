#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "image/cryptomatte.h"
#include "image/exr_stream.h"
#include "image/film.h"

namespace candela {

namespace {

using codec::MemoryOutput;
using Imath::V2i;

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

/// What a header and a frame buffer refer to while a file is written.
struct Buffers {
  std::vector<std::vector<unsigned>> numbers;
  std::vector<codec::Cryptomatte> mattes;
};

/// A layer of integers, each of which its float holds exactly.
void add_numbers(Imf::Header& header, Imf::FrameBuffer& frame, const std::string& name, const Image& image,
                 Buffers& buffers) {
  const std::vector<unsigned>& numbers = buffers.numbers.emplace_back(image.pixels.begin(), image.pixels.end());
  header.channels().insert(name, Imf::Channel(Imf::UINT));
  frame.insert(name, Imf::Slice::Make(Imf::UINT, numbers.data(), V2i(0, 0), image.width, image.height, sizeof(unsigned),
                                      sizeof(unsigned) * static_cast<std::size_t>(image.width)));
}

void add_layer(Imf::Header& header, Imf::FrameBuffer& frame, Layer layer, const Image& image, Buffers& buffers) {
  const LayerInfo& info = layer_info(layer);
  if (info.is_number)
    return add_numbers(header, frame, std::string(info.name) + "." + info.channels[0], image, buffers);
  for (std::size_t c = 0; c < info.channels.size(); ++c) {
    add_channel(header, frame, std::string(info.name) + "." + info.channels[c], image, c);
  }
}

void add_mattes(Imf::Header& header, Imf::FrameBuffer& frame, const Film& film, Buffers& buffers) {
  buffers.mattes.reserve(film.mattes.size());
  for (const MatteInfo& info : kMatteKinds) {
    const auto found = film.mattes.find(info.kind);
    if (found == film.mattes.end()) continue;
    const std::string layer(info.layer);
    const codec::Cryptomatte& made = buffers.mattes.emplace_back(codec::make_cryptomatte(layer, found->second));
    const auto insert = [&](const char* key, const std::string& value) {
      header.insert((made.prefix + key).c_str(), Imf::StringAttribute(value));
    };
    insert("name", layer);
    insert("hash", "MurmurHash3_32");
    insert("conversion", "uint32_to_float32");
    insert("manifest", made.manifest);
    for (std::size_t level = 0; level < made.levels.size(); ++level) {
      constexpr std::array<const char*, 4> kSuffixes = {".R", ".G", ".B", ".A"};
      const std::string name = layer + "0" + std::to_string(level);
      for (std::size_t c = 0; c < 4; ++c) add_channel(header, frame, name + kSuffixes[c], made.levels[level], c);
    }
  }
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

/// RLE removes what is flat in a tenth of ZIP's time. Of noise no way makes much less; of layers, which are smooth,
/// ZIPS would leave two thirds, for a quarter of the time that a set of drawn pictures takes. The table is in
/// docs/performance.md.
void set_compression(Imf::Header& header) { header.compression() = Imf::RLE_COMPRESSION; }

std::size_t film_bytes(const Film& film) {
  std::size_t floats = film.beauty.pixels.size() + film.through.pixels.size() + film.noisy.pixels.size();
  for (const auto& [layer, image] : film.layers) floats += image.pixels.size();
  for (const auto& [kind, mattes] : film.mattes) floats += 2 * mattes.ranks.size();
  return floats * sizeof(float);
}

}  // namespace

void write_exr(const std::filesystem::path& path, const Film& film) {
  const std::string where = path.string();
  check_film(film, where);
  const std::vector<std::byte> bytes = codec::converting_errors("cannot encode OpenEXR: ", where, [&] {
    Imf::Header header(film.width(), film.height());
    set_compression(header);
    Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec.709
    Imf::FrameBuffer frame;
    const Image& beauty = film.beauty;
    const char* const names[] = {"R", "G", "B"};
    if (beauty.channels == 1) add_channel(header, frame, "Y", beauty, 0);
    for (std::size_t c = 0; beauty.channels >= 3 && c < 3; ++c) add_channel(header, frame, names[c], beauty, c);
    if (!is_opaque(beauty)) add_channel(header, frame, "A", beauty, 3);
    if (!film.noisy.empty()) add_rgb(header, frame, "noisy", film.noisy);
    if (is_colored(film.through)) add_rgb(header, frame, "through", film.through);
    Buffers buffers;
    buffers.numbers.reserve(film.layers.size());
    for (const auto& [layer, image] : film.layers) add_layer(header, frame, layer, image, buffers);
    add_mattes(header, frame, film, buffers);
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
