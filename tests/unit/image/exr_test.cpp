#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <half.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/file.h"
#include "base/parallel.h"
#include "image/codec.h"
#include "image/film.h"
#include "image/image_file.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

namespace candela {
namespace {

using Imath::Box2i;
using Imath::V2i;
using test::Bytes;
using test::TempFolder;

Film random_film(int width, int height) {
  Film film;
  film.beauty = test::random_image(width, height, 4, 1);
  film.layers[Layer::albedo] = test::random_image(width, height, 3, 2);
  film.layers[Layer::normal] = test::random_image(width, height, 3, 3);
  film.layers[Layer::depth] = test::random_image(width, height, 1, 4);
  film.layers[Layer::depth].pixels[0] = std::numeric_limits<float>::infinity();
  film.layers[Layer::position] = test::random_image(width, height, 3, 5);
  film.layers[Layer::object_id] = test::random_image(width, height, 1, 6);
  for (float& v : film.layers[Layer::object_id].pixels) v = std::round(1000.0f * std::abs(v));
  film.metadata = {
      {"scene", "demo:spheres"}, {"samples", "64"}, {"a name longer than thirty-one characters", "yes"}, {"empty", ""}};
  return film;
}

TEST(unit_image_exr, layers_survive_a_round_trip_bit_by_bit) {
  const TempFolder folder;
  const Film film = random_film(37, 41);
  write_exr(folder / "a.exr", film);
  const Image beauty = read_image(folder / "a.exr");
  EXPECT_EQ(beauty.channels, 4);
  EXPECT_EQ(beauty.pixels, film.beauty.pixels);
  for (const auto& [layer, image] : film.layers) {
    const Image back = read_image(folder / "a.exr", std::string(layer_name(layer)));
    ASSERT_EQ(back.width, 37);
    ASSERT_EQ(back.height, 41);
    ASSERT_EQ(back.channels, 3);
    for (int y = 0; y < 41; ++y)
      for (int x = 0; x < 37; ++x) ASSERT_EQ(back.rgb(x, y), image.rgb(x, y)) << layer_name(layer);
  }
}

TEST(unit_image_exr, metadata_survives_a_round_trip) {
  const TempFolder folder;
  const Film film = random_film(4, 4);
  write_exr(folder / "a.exr", film);
  const ExrHeader header = read_exr_header(folder / "a.exr");
  EXPECT_EQ(header.metadata, film.metadata);
  for (const char* channel : {"R", "G", "B", "A", "albedo.R"}) {
    EXPECT_EQ(std::count(header.channels.begin(), header.channels.end(), channel), 1) << channel;
  }
}

TEST(unit_image_exr, a_file_that_is_open_gives_each_layer_as_reading_it_alone_does) {
  const TempFolder folder;
  write_exr(folder / "a.exr", random_film(7, 5));
  ExrFile file(folder / "a.exr");
  EXPECT_EQ(file.header().layers, read_exr_header(folder / "a.exr").layers);
  ASSERT_GT(file.header().layers.size(), 2u);
  // In any order, and more than once.
  for (const std::string layer : {"normal", "", "albedo", "normal", "depth"}) {
    const ImageFile alone = read_image_file({folder / "a.exr", layer});
    const ImageFile read = file.read(layer);
    EXPECT_EQ(read.image.pixels, alone.image.pixels) << layer;
    EXPECT_EQ(read.image.channels, alone.image.channels) << layer;
    EXPECT_EQ(read.format, ImageFormat::exr);
  }
  EXPECT_THROW(file.read("nowhere"), Error);
  EXPECT_THROW(ExrFile(folder / "nowhere.exr"), Error);
}

TEST(unit_image_exr, the_header_says_rec709_float_and_the_documented_channels) {
  const TempFolder folder;
  write_exr(folder / "a.exr", random_film(4, 4));
  const Imf::InputFile file((folder / "a.exr").c_str());
  const Imf::Header& header = file.header();
  ASSERT_TRUE(Imf::hasChromaticities(header));
  EXPECT_EQ(Imf::chromaticities(header).red, Imath::V2f(0.64f, 0.33f));
  EXPECT_EQ(Imf::chromaticities(header).white, Imath::V2f(0.3127f, 0.3290f));
  EXPECT_EQ(header.compression(), Imf::RLE_COMPRESSION);
  std::string names;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    names += std::string(c.name()) + ' ';
    EXPECT_EQ(c.channel().type, std::string(c.name()) == "id.Y" ? Imf::UINT : Imf::FLOAT);
  }
  EXPECT_EQ(
      names,
      "A B G R albedo.B albedo.G albedo.R depth.Z id.Y normal.B normal.G normal.R position.B position.G position.R ");
}

TEST(unit_image_exr, what_is_empty_takes_little_room_and_noise_no_more_than_its_floats) {
  const TempFolder folder;
  const auto size_of = [&](const Film& film) {
    write_exr(folder / "a.exr", film);
    return std::filesystem::file_size(folder / "a.exr");
  };
  constexpr std::uint64_t kFloats = std::uint64_t{256} * 128 * 4;
  Film film;
  film.beauty = test::random_image(256, 128, 4);
  EXPECT_LT(size_of(film), kFloats * sizeof(float) + 4096);
  film.layers[Layer::depth] = Image(256, 128, 1);
  EXPECT_LT(size_of(film), kFloats * sizeof(float) + 8192);
  film.layers.clear();
  film.beauty.pixels.assign(kFloats, 0.0f);
  EXPECT_LT(size_of(film), kFloats * sizeof(float) / 20);
}

TEST(unit_image_exr, alpha_is_left_out_of_an_opaque_film) {
  const TempFolder folder;
  Film film;
  film.beauty = test::random_image(9, 5, 4);
  for (std::size_t i = 3; i < film.beauty.pixels.size(); i += 4) film.beauty.pixels[i] = 1.0f;
  write_exr(folder / "a.exr", film);
  EXPECT_EQ(read_image(folder / "a.exr").channels, 3);
  film.beauty.pixels[3] = 0.999f;
  write_exr(folder / "a.exr", film);
  EXPECT_EQ(read_image(folder / "a.exr").channels, 4);
}

TEST(unit_image_exr, what_coloured_glass_lets_through_is_there_and_grey_is_alpha) {
  const TempFolder folder;
  Film film;
  film.beauty = Image(3, 2, 4);
  Image through(3, 2, 4);
  for (std::size_t i = 0; i < through.pixels.size(); ++i) through.pixels[i] = i % 4 == 3 ? 1.0f : 0.75f;
  set_through(through, film);
  const auto channels = [&] {
    write_exr(folder / "a.exr", film);
    return read_exr_header(folder / "a.exr").channels;
  };
  EXPECT_EQ(channels(), (std::vector<std::string>{"A", "B", "G", "R"}));
  through.pixels[2] = 0.25f;
  set_through(through, film);
  EXPECT_EQ(channels(), (std::vector<std::string>{"A", "B", "G", "R", "through.B", "through.G", "through.R"}));
  EXPECT_NEAR(read_image(folder / "a.exr").at(0, 0)[3], 1.0f - (0.75f - 0.0722f * 0.5f), 1e-6f);
}

TEST(unit_image_exr, the_same_film_gives_the_same_bytes_on_any_number_of_threads) {
  const TempFolder folder;
  const Film film = random_film(200, 150);
  Bytes first;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    write_exr(folder / "a.exr", film);
    const Bytes bytes = read_file(folder / "a.exr");
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first);
  }
}

TEST(unit_image_exr, what_cannot_be_written_is_an_error) {
  const TempFolder folder;
  Film film = random_film(4, 4);
  film.metadata["channels"] = "a name that OpenEXR owns";
  EXPECT_THROW(write_exr(folder / "a.exr", film), Error);
  film = random_film(4, 4);
  film.layers[Layer::depth] = Image(4, 3, 1);
  EXPECT_THROW(write_exr(folder / "a.exr", film), Error);
  EXPECT_THROW(write_exr(folder / "a.exr", Film{}), Error);
  EXPECT_EQ(folder.entries(), 0u);
}

/// Writes 16-bit R,G,B, value = 100 y + x + channel, over `data` inside `display`.
template <class File>
void write_halves(File& file, const Box2i& data) {
  const auto width = static_cast<std::size_t>(data.max.x - data.min.x + 1);
  const auto height = static_cast<std::size_t>(data.max.y - data.min.y + 1);
  std::vector<half> pixels;
  for (int y = data.min.y; y <= data.max.y; ++y)
    for (int x = data.min.x; x <= data.max.x; ++x)
      for (int c = 0; c < 3; ++c) pixels.emplace_back(static_cast<float>(20 * y + x) + 0.25f * static_cast<float>(c));
  Imf::FrameBuffer frame;
  const char* const names[] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c)
    frame.insert(names[c],
                 Imf::Slice::Make(Imf::HALF, pixels.data() + c, data, 3 * sizeof(half), 3 * width * sizeof(half)));
  file.setFrameBuffer(frame);
  if constexpr (std::is_same_v<File, Imf::TiledOutputFile>)
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  else
    file.writePixels(static_cast<int>(height));
}

Imf::Header half_header(const Box2i& display, const Box2i& data) {
  Imf::Header header(display, data);
  for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
  return header;
}

void expect_halves(const Image& image, const Box2i& display, const Box2i& data) {
  ASSERT_EQ(image.width, display.max.x - display.min.x + 1);
  ASSERT_EQ(image.height, display.max.y - display.min.y + 1);
  for (int y = display.min.y; y <= display.max.y; ++y) {
    for (int x = display.min.x; x <= display.max.x; ++x) {
      const float v = static_cast<float>(20 * y + x);
      const vec3 expected = data.intersects(V2i(x, y)) ? vec3(v, v + 0.25f, v + 0.5f) : vec3(0.0f);
      ASSERT_EQ(image.rgb(x - display.min.x, y - display.min.y), expected) << x << ' ' << y;
    }
  }
}

TEST(unit_image_exr, the_picture_is_the_display_window_whatever_the_data_window) {
  const TempFolder folder;
  const Box2i display(V2i(0, 0), V2i(11, 9));
  for (const Box2i& data :
       {display, Box2i(V2i(3, 2), V2i(7, 5)), Box2i(V2i(-4, -3), V2i(15, 12)), Box2i(V2i(-4, 5), V2i(5, 12)),
        Box2i(V2i(20, 0), V2i(22, 9)), Box2i(V2i(0, 20), V2i(11, 22))}) {
    {
      Imf::OutputFile file((folder / "a.exr").c_str(), half_header(display, data));
      write_halves(file, data);
    }
    expect_halves(read_image(folder / "a.exr"), display, data);
  }
}

TEST(unit_image_exr, every_compression_and_tiles_read_alike) {
  const TempFolder folder;
  const Box2i window(V2i(-2, -1), V2i(12, 6));
  for (const auto compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    Imf::Header header = half_header(window, window);
    header.compression() = compression;
    {
      Imf::OutputFile file((folder / "a.exr").c_str(), header);
      write_halves(file, window);
    }
    expect_halves(read_image(folder / "a.exr"), window, window);
    {
      header.setTileDescription(Imf::TileDescription(5, 3));
      Imf::TiledOutputFile file((folder / "a.exr").c_str(), header);
      write_halves(file, window);
    }
    expect_halves(read_image(folder / "a.exr"), window, window);
  }
}

TEST(unit_image_exr, grey_and_whole_numbers_read_as_colour) {
  const TempFolder folder;
  const Box2i window(V2i(0, 0), V2i(3, 1));
  for (const char* name : {"Y", "mask.V"}) {
    Imf::Header header(window, window);
    header.channels().insert(name, Imf::Channel(Imf::UINT));
    const std::vector<std::uint32_t> values{0, 1, 2, 3, 40, 50, 60, 70000};
    {
      Imf::OutputFile file((folder / "a.exr").c_str(), header);
      Imf::FrameBuffer frame;
      frame.insert(name, Imf::Slice::Make(Imf::UINT, values.data(), window, 4, 16));
      file.setFrameBuffer(frame);
      file.writePixels(2);
    }
    const Image image = read_image(folder / "a.exr", name[0] == 'Y' ? "" : "mask");
    EXPECT_EQ(image.channels, 3);
    EXPECT_EQ(image.rgb(3, 1), vec3(70000.0f));
    EXPECT_EQ(image.rgb(0, 1), vec3(40.0f));
  }
}

TEST(unit_image_exr, a_layer_is_found_by_the_name_of_its_part) {
  const TempFolder folder;
  const Box2i window(V2i(0, 0), V2i(5, 4));
  std::vector<Imf::Header> headers;
  for (const char* name : {"beauty", "albedo"}) {
    headers.push_back(half_header(window, window));
    headers.back().setName(name);
    headers.back().setType(Imf::SCANLINEIMAGE);
  }
  {
    Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), 2);
    for (int part = 0; part < 2; ++part) {
      Imf::OutputPart output(file, part);
      write_halves(output, window);
    }
  }
  expect_halves(read_image(folder / "a.exr"), window, window);
  expect_halves(read_image(folder / "a.exr", "albedo"), window, window);
  EXPECT_THROW(read_image(folder / "a.exr", "depth"), Error);
}

TEST(unit_image_exr, a_missing_layer_is_an_error_that_lists_what_is_there) {
  const TempFolder folder;
  write_exr(folder / "a.exr", random_film(4, 4));
  try {
    read_image(folder / "a.exr", "diffuse");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(e.message().find("albedo.R"), std::string::npos) << e.what();
    EXPECT_EQ(e.where(), (folder / "a.exr").string());
  }
}

TEST(unit_image_exr, damage_is_an_error_and_never_a_crash) {
  const TempFolder folder;
  const auto decode = [](std::span<const std::byte> bytes) { codec::decode_exr(bytes, {}, "t"); };
  Film film;
  film.beauty = test::random_image(6, 20, 4);
  film.metadata["scene"] = "x";
  write_exr(folder / "a.exr", film);
  test::check_damage(decode, read_file(folder / "a.exr"));

  Imf::Header header = half_header(Box2i(V2i(0, 0), V2i(5, 4)), Box2i(V2i(0, 0), V2i(5, 4)));
  header.setTileDescription(Imf::TileDescription(4, 4));
  {
    Imf::TiledOutputFile file((folder / "a.exr").c_str(), header);
    write_halves(file, header.dataWindow());
  }
  test::check_damage(decode, read_file(folder / "a.exr"));
}

/// The position of an attribute's value in the file.
std::size_t value_of(const Bytes& bytes, const std::string& name_and_type) {
  const Bytes needle = test::bytes_of(name_and_type);
  const auto at = std::search(bytes.begin(), bytes.end(), needle.begin(), needle.end());
  return static_cast<std::size_t>(at - bytes.begin()) + needle.size() + 4;
}

TEST(unit_image_exr, sizes_that_cannot_be_are_refused_before_the_library_allocates) {
  const TempFolder folder;
  Film film;
  film.beauty = test::random_image(4, 4, 3);
  write_exr(folder / "a.exr", film);
  const Bytes good = read_file(folder / "a.exr");
  const std::size_t data = value_of(good, std::string("dataWindow\0box2i\0", 17));
  const auto message_with = [&](std::size_t at, std::int32_t value) {
    Bytes bytes = good;
    std::memcpy(&bytes[at], &value, 4);
    write_file(folder / "bad.exr", bytes);
    try {
      read_image(folder / "bad.exr");
    } catch (const Error& e) {
      return e.message();
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message_with(data + 8, 32768), "image of 32769 x 4 is too large");
  EXPECT_EQ(message_with(data + 12, 32768), "image of 4 x 32769 is too large");
  EXPECT_EQ(message_with(data + 8, 2147483647), "damaged OpenEXR: an impossible image window");
  EXPECT_EQ(message_with(data + 8, -2), "damaged OpenEXR: an impossible image window");
  EXPECT_EQ(message_with(data - 4, 2000000000), "damaged OpenEXR: an attribute beyond the end of the file");
  EXPECT_EQ(message_with(data - 4, -1), "damaged OpenEXR: an attribute beyond the end of the file");
  Bytes large = good;
  for (const std::size_t at : {data + 8, data + 12}) {
    const std::int32_t value = 32000;
    std::memcpy(&large[at], &value, 4);
  }
  write_file(folder / "bad.exr", large);
  try {
    read_image(folder / "bad.exr");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.message(), "the picture takes more than 2 GiB of memory");
  }
}

}  // namespace
}  // namespace candela
