#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfEnvmapAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "base/file.h"
#include "image/codec.h"
#include "image/cube_file.h"
#include "image/cube_panorama.h"
#include "image/image_file.h"
#include "image/primaries.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

// What headers of OpenEXR files say of their pixels: which are the picture, which colours and which directions they
// mean.
namespace candela {
namespace {

using Imath::Box2i;
using Imath::V2f;
using Imath::V2i;
using test::TempFolder;

/// Value of a channel at a pixel.
using Fill = std::function<float(int, int)>;
struct Filled {
  Fill value;
  int sampling = 1;
};
using Channels = std::map<std::string, Filled>;

Filled constant(float value) {
  return {[value](int, int) { return value; }};
}

/// "R", "G", "B" after `prefix`, of values r, 2 r, 3 r.
Channels colors(float r, const std::string& prefix = "") {
  return {{prefix + "R", constant(r)}, {prefix + "G", constant(2 * r)}, {prefix + "B", constant(3 * r)}};
}
Channels operator+(Channels a, const Channels& b) {
  a.insert(b.begin(), b.end());
  return a;
}

Imf::Header header_of(int width, int height, const Channels& channels) {
  Imf::Header header(width, height);
  for (const auto& [name, filled] : channels)
    header.channels().insert(name, Imf::Channel(Imf::FLOAT, filled.sampling, filled.sampling));
  return header;
}

template <class File>
void write_pixels(File& file, const Channels& channels) {
  const Box2i window = file.header().dataWindow();
  std::map<std::string, std::vector<float>> planes;
  Imf::FrameBuffer frame;
  for (const auto& [name, filled] : channels) {
    std::vector<float>& plane = planes[name];
    for (int y = window.min.y; y <= window.max.y; y += filled.sampling)
      for (int x = window.min.x; x <= window.max.x; x += filled.sampling) plane.push_back(filled.value(x, y));
    const auto width = static_cast<std::size_t>((window.max.x - window.min.x + 1) / filled.sampling);
    frame.insert(name, Imf::Slice::Make(Imf::FLOAT, plane.data(), window, sizeof(float), width * sizeof(float),
                                        filled.sampling, filled.sampling));
  }
  file.setFrameBuffer(frame);
  if constexpr (std::is_same_v<File, Imf::TiledOutputFile>)
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  else
    file.writePixels(window.max.y - window.min.y + 1);
}

struct Part {
  std::string name;
  Channels channels;
  std::string view = {};
};

class ExrMeaning : public testing::Test {
 protected:
  std::filesystem::path path() const { return folder_ / "a.exr"; }
  ImageFile read(const std::string& layer = "") const { return read_image_file({path(), layer}); }

  void write(const Imf::Header& header, const Channels& channels) const {
    Imf::OutputFile file(path().c_str(), header);
    write_pixels(file, channels);
  }
  void write(const Channels& channels) const { write(header_of(4, 2, channels), channels); }
  void write(const std::vector<Part>& parts) const {
    std::vector<Imf::Header> headers;
    for (const Part& part : parts) {
      headers.push_back(header_of(4, 2, part.channels));
      headers.back().setName(part.name);
      headers.back().setType(Imf::SCANLINEIMAGE);
      if (!part.view.empty()) headers.back().setView(part.view);
    }
    Imf::MultiPartOutputFile file(path().c_str(), headers.data(), static_cast<int>(headers.size()));
    for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
      Imf::OutputPart output(file, i);
      write_pixels(output, parts[static_cast<std::size_t>(i)].channels);
    }
  }
  float red(const std::string& layer = "") const { return read(layer).image.rgb(3, 1).x; }
  std::string error(const std::string& layer = "") const {
    try {
      read(layer);
    } catch (const Error& e) {
      return e.message();
    }
    return "read";
  }
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
};
using unit_image_exr_meaning = ExrMeaning;

/// Without a name where there is none.
ImageFact fact_named(const ImageFile& file, const std::string& name) {
  for (const ImageFact& fact : file.facts)
    if (fact.name == name) return fact;
  return {};
}

// ----- which channels

TEST_F(unit_image_exr_meaning, a_lone_layer_is_found_without_its_name) {
  write(colors(0.5f, "ViewLayer.Combined.") +
        Channels{{"ViewLayer.Combined.A", constant(0.25f)}, {"ViewLayer.Depth.Z", constant(5.0f)}});
  const ImageFile file = read();
  EXPECT_EQ(file.image.rgb(0, 0), vec3(0.5f, 1.0f, 1.5f));
  EXPECT_EQ(file.image.channels, 4);
  ASSERT_FALSE(fact_named(file, "layer").name.empty());
  EXPECT_EQ(fact_named(file, "layer").value, "ViewLayer.Combined");
  EXPECT_EQ(red("ViewLayer.Combined"), 0.5f);
  EXPECT_EQ(red("ViewLayer.Depth"), 5.0f);
  EXPECT_EQ(red("ViewLayer.Depth.Z"), 5.0f) << "one channel alone";
  EXPECT_NE(error("ViewLayer"), "read");
}

TEST_F(unit_image_exr_meaning, of_several_layers_one_has_to_be_named_unless_one_is_the_sum) {
  write(colors(1.0f, "View.DiffDir.") + colors(2.0f, "View.GlossDir."));
  EXPECT_EQ(error(),
            "has several layers and none is the picture: name one as FILE:LAYER, of View.DiffDir, View.GlossDir");
  EXPECT_EQ(red("View.GlossDir"), 2.0f);
  write(colors(1.0f, "View.DiffDir.") + colors(2.0f, "View.Combined.") + colors(3.0f, "View.Normal."));
  EXPECT_EQ(red(), 2.0f);
  write(colors(1.0f, "a.Combined.") + colors(2.0f, "b.Combined."));
  EXPECT_NE(error(), "read");
  // A picture of its own always comes first; positions and depths never.
  write(colors(7.0f) + colors(1.0f, "View.Combined."));
  EXPECT_EQ(red(), 7.0f);
  write(Channels{{"P.X", constant(1)}, {"P.Y", constant(2)}, {"P.Z", constant(3)}, {"Z", constant(9)}} +
        colors(4.0f, "Beauty."));
  EXPECT_EQ(red(), 4.0f);
  EXPECT_EQ(read("P").image.rgb(0, 0), vec3(1, 2, 3));
  write(Channels{{"Z", constant(9)}});
  EXPECT_EQ(red(), 9.0f) << "a depth alone";
}

TEST_F(unit_image_exr_meaning, of_several_parts_the_picture_is_the_one_with_colours) {
  write(
      {{"depth", {{"Z", constant(5)}}}, {"mask", {{"Y", constant(6)}}}, {"rgba", colors(0.5f)}, {"again", colors(9)}});
  const ImageFile file = read();
  EXPECT_EQ(file.image.rgb(0, 0), vec3(0.5f, 1.0f, 1.5f));
  EXPECT_NE(fact_named(file, "part").value.find("rgba"), std::string::npos);
  EXPECT_EQ(red("depth"), 5.0f);
  EXPECT_EQ(red("mask"), 6.0f);
  EXPECT_EQ(red("again"), 9.0f);
  // Layers and parts, as Nuke and Blender write them.
  write({{"View.Depth", {{"View.Depth.Z", constant(5)}}}, {"View.Combined", colors(3, "View.Combined.")}});
  EXPECT_EQ(red(), 3.0f);
  EXPECT_EQ(red("View.Combined"), 3.0f);
  write({{"first", colors(1, "a.")}, {"second", colors(2, "a.")}});
  EXPECT_EQ(red("second.a"), 2.0f);
}

TEST_F(unit_image_exr_meaning, the_first_of_several_views_is_read_unless_another_is_named) {
  const Channels both = colors(1, "View.Combined.left.") + colors(2, "View.Combined.right.");
  Imf::Header header = header_of(4, 2, both);
  Imf::addMultiView(header, {"left", "right"});
  write(header, both);
  EXPECT_EQ(red(), 1.0f);
  EXPECT_EQ(red("View.Combined.right"), 2.0f);
  const Channels plain = colors(3) + colors(4, "right.");
  header = header_of(4, 2, plain);
  Imf::addMultiView(header, {"left", "right"});
  write(header, plain);
  EXPECT_EQ(red(), 3.0f);
  EXPECT_EQ(red("right"), 4.0f);
  write({{"rgba.left", colors(5), "left"}, {"rgba.right", colors(6), "right"}});
  EXPECT_EQ(red(), 5.0f);
  EXPECT_EQ(red("right"), 6.0f);
  EXPECT_EQ(red("rgba.right"), 6.0f);
}

TEST_F(unit_image_exr_meaning, a_layer_is_named_after_a_colon_and_a_file_of_that_name_wins) {
  write(colors(1) + colors(2, "a:b."));
  const std::string file = path().string();
  EXPECT_EQ(read_image(file + ":a:b").rgb(0, 0).x, 2.0f);
  EXPECT_EQ(parse_image_name(file + ":a:b").text(), file + ":a:b");
  EXPECT_THROW(read_image(file + ":c"), Error);
  EXPECT_THROW(read_image(file + ":"), Error) << "no file and no layer";
  EXPECT_THROW(read_image((folder() / "absent.exr").string() + ":a:b"), Error);
  write(colors(8));
  std::filesystem::copy_file(path(), file + ":a:b");
  write(colors(1) + colors(2, "a:b."));
  EXPECT_EQ(read_image(file + ":a:b").rgb(0, 0).x, 8.0f);
  std::filesystem::copy_file(path(), folder() / "b.exr:c");
  EXPECT_EQ(read_image((folder() / "b.exr:c").string() + ":a:b").rgb(0, 0).x, 2.0f) << "a colon in the file's own name";
}

// ----- luminance and chroma

TEST_F(unit_image_exr_meaning, luminance_and_chroma_become_colours) {
  // Even pixels have chroma; the picture is flat over 2 x 2 blocks, so that nothing is lost.
  const auto rgb = [](int x, int y) {
    const int column = x / 2, row = y / 2;
    return 70000.0f * vec3(1.0f + static_cast<float>(column), 4.0f - static_cast<float>(row), 2.0f);
  };
  const auto luma = [&](int x, int y) { return luminance(rgb(x, y)); };
  for (const int sampling : {1, 2}) {
    const Channels channels{{"Y", {luma}},
                            {"RY", {[&](int x, int y) { return (rgb(x, y).x - luma(x, y)) / luma(x, y); }, sampling}},
                            {"BY", {[&](int x, int y) { return (rgb(x, y).z - luma(x, y)) / luma(x, y); }, sampling}},
                            {"A", constant(0.5f)}};
    write(header_of(8, 4, channels), channels);
    const ImageFile file = read();
    ASSERT_EQ(file.image.channels, 4);
    for (int y = 0; y < 4; y += 2)
      for (int x = 0; x < 8; x += 2)
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(file.image.rgb(x, y)[c] / rgb(x, y)[c], 1.0f, 1e-3f) << x << ' ' << y << ' ' << c;
    EXPECT_FALSE(fact_named(file, "Y RY BY").name.empty());
    for (const float v : file.image.pixels) ASSERT_GE(v, 0.0f);
  }
}

TEST_F(unit_image_exr_meaning, luminance_and_chroma_agree_with_openexrs_own_reader) {
  constexpr int kSize = 64;
  std::vector<Imf::Rgba> pixels;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      pixels.emplace_back(0.5f + 0.2f * std::sin(0.1f * static_cast<float>(x)),
                          0.5f + 0.3f * std::cos(0.1f * static_cast<float>(y)), 0.3f + 0.004f * static_cast<float>(x),
                          1.0f);
  const Imf::Chromaticities p3(V2f(0.68f, 0.32f), V2f(0.265f, 0.69f), V2f(0.15f, 0.06f), V2f(0.3127f, 0.329f));
  for (const bool is_wide : {false, true}) {
    Imf::Header header(kSize, kSize);
    if (is_wide) Imf::addChromaticities(header, p3);
    {
      Imf::RgbaOutputFile file(path().c_str(), header, Imf::WRITE_YC);
      file.setYCRounding(10, 10);  // all the bits that there are
      file.setFrameBuffer(pixels.data(), 1, kSize);
      file.writePixels(kSize);
    }
    const mat3 matrix =
        is_wide ? *rec709_from_rgb({{0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}, {0.3127, 0.329}}) : mat3(1.0f);
    Imf::RgbaInputFile theirs(path().c_str());
    std::vector<Imf::Rgba> back(pixels.size());
    theirs.setFrameBuffer(back.data(), 1, kSize);
    theirs.readPixels(0, kSize - 1);
    const Image ours = read().image;
    // Its chroma is a sinc's sum, which is another thing at the border.
    for (int y = 8; y < kSize - 8; ++y) {
      for (int x = 8; x < kSize - 8; ++x) {
        const Imf::Rgba& p = back[static_cast<std::size_t>(y * kSize + x)];
        ASSERT_LT(glm::distance(ours.rgb(x, y), matrix * vec3(p.r, p.g, p.b)), 0.005f) << x << ' ' << y;
      }
    }
  }
}

TEST_F(unit_image_exr_meaning, chroma_needs_both_halves) {
  const Channels channels{{"Y", constant(2)}, {"RY", {[](int, int) { return 0.5f; }, 2}}};
  write(header_of(4, 2, channels), channels);
  EXPECT_EQ(read().image.rgb(1, 1), vec3(2.0f)) << "grey";
}

TEST_F(unit_image_exr_meaning, subsampled_colours_are_joined_by_straight_lines) {
  Channels channels = colors(1);
  channels["B"] = {[](int x, int) { return static_cast<float>(x); }, 2};
  write(header_of(8, 4, channels), channels);
  const Image image = read().image;
  for (int x = 0; x < 7; ++x) EXPECT_EQ(image.rgb(x, 3), vec3(1.0f, 2.0f, static_cast<float>(x)));
  EXPECT_EQ(image.rgb(7, 3).z, 6.0f) << "nothing lies beyond the last sample";
}

// ----- colours

Imf::Chromaticities chromaticities(const Primaries& p) {
  const auto point = [](dvec2 v) { return V2f(static_cast<float>(v.x), static_cast<float>(v.y)); };
  return {point(p.red), point(p.green), point(p.blue), point(p.white)};
}
const Primaries kAcesCg{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};

TEST_F(unit_image_exr_meaning, chromaticities_become_rec709_in_every_layout_of_pixels) {
  const Channels channels = colors(0.5f) + colors(0.25f, "layer.") + Channels{{"Z", constant(5)}} +
                            Channels{{"P.X", constant(1)}, {"P.Y", constant(2)}, {"P.Z", constant(-3)}};
  Imf::Header header = header_of(4, 2, channels);
  Imf::addChromaticities(header, chromaticities(kAcesCg));
  const vec3 expected = *rec709_from_rgb(kAcesCg) * vec3(0.5f, 1.0f, 1.5f);
  write(header, channels);
  EXPECT_LT(glm::distance(read().image.rgb(1, 1), expected), 1e-5f);
  EXPECT_LT(glm::distance(read("layer").image.rgb(1, 1), 0.5f * expected), 1e-5f);
  EXPECT_EQ(read("P").image.rgb(1, 1), vec3(1, 2, -3)) << "no colours";
  EXPECT_EQ(read("Z").image.rgb(1, 1), vec3(5.0f));
  EXPECT_EQ(fact_named(read(), "chromaticities").done, "converted to Rec.709");
  header.setTileDescription(Imf::TileDescription(3, 2));
  {
    Imf::TiledOutputFile file(path().c_str(), header);
    write_pixels(file, channels);
  }
  EXPECT_LT(glm::distance(read().image.rgb(1, 1), expected), 1e-5f);
}

TEST_F(unit_image_exr_meaning, rec709_keeps_every_bit) {
  // Next to a large one the smallest part of a channel would leave its trace in the others.
  const Channels channels{{"R", constant(3e9f)}, {"G", constant(0.1f)}, {"B", constant(7e-9f)}};
  Imf::Header header = header_of(4, 2, channels);
  Imf::addChromaticities(header, Imf::Chromaticities());
  write(header, channels);
  EXPECT_EQ(read().image.rgb(0, 0), vec3(3e9f, 0.1f, 7e-9f));
  EXPECT_FALSE(fact_named(read(), "chromaticities").is_odd);
}

TEST_F(unit_image_exr_meaning, chromaticities_that_cannot_be_are_told_and_not_followed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const V2f r(0.64f, 0.33f), g(0.3f, 0.6f), b(0.15f, 0.06f);
  for (const Imf::Chromaticities& bad :
       {Imf::Chromaticities(r, g, b, V2f(0.3127f, 0.0f)), Imf::Chromaticities(r, r, r, r),
        Imf::Chromaticities(V2f(0, 0), V2f(0, 0), V2f(0, 0), V2f(0, 0)),
        Imf::Chromaticities(V2f(nan, nan), g, b, V2f(0.3f, 0.3f)),
        Imf::Chromaticities(V2f(1e30f, -1e30f), g, b, V2f(0.3f, 0.3f))}) {
    Channels channels = colors(0.1f);
    Imf::Header header = header_of(4, 2, channels);
    Imf::addChromaticities(header, bad);
    Imf::addAdoptedNeutral(header, V2f(0.0f, 0.0f));
    write(header, channels);
    const ImageFile file = read();
    EXPECT_EQ(file.image.rgb(0, 0), vec3(0.1f, 0.2f, 3 * 0.1f));
    EXPECT_TRUE(fact_named(file, "chromaticities").is_odd);
    EXPECT_TRUE(fact_named(file, "adoptedNeutral").is_odd);
    EXPECT_EQ(read_clean_environment(path()).warnings.size(), 2U);
  }
}

TEST_F(unit_image_exr_meaning, the_adopted_neutral_becomes_white) {
  const Channels channels{{"R", constant(1)}, {"G", constant(1)}, {"B", constant(1)}};
  Imf::Header header = header_of(4, 2, channels);
  Imf::addAdoptedNeutral(header, V2f(0.38f, 0.38f));
  write(header, channels);
  const vec3 expected = *rec709_from_rgb(kRec709, dvec2(0.38, 0.38)) * vec3(1.0f);
  EXPECT_LT(glm::distance(read().image.rgb(0, 0), expected), 1e-4f);
  EXPECT_GT(expected.z, 1.3f) << "bluer: the light was taken as warm";
}

TEST_F(unit_image_exr_meaning, the_names_of_linear_spaces_are_known) {
  Channels channels = colors(0.5f);
  for (const auto& [name, primaries] : {std::pair("lin_ap1_scene", kAcesCg),
                                        {"lin_rec709_scene", kRec709},
                                        {"data", kRec709},
                                        {"lin_made_up", kRec709}}) {
    Imf::Header header = header_of(4, 2, channels);
    header.insert("colorInteropID", Imf::StringAttribute(name));
    write(header, channels);
    const ImageFile file = read();
    EXPECT_LT(glm::distance(file.image.rgb(0, 0), *rec709_from_rgb(primaries) * vec3(0.5f, 1.0f, 1.5f)), 1e-4f) << name;
    EXPECT_EQ(fact_named(file, "colorInteropID").is_odd, std::string(name) == "lin_made_up");
  }
}

TEST_F(unit_image_exr_meaning, colours_beyond_rec709_are_counted_and_not_negative) {
  Channels channels{{"R", constant(0)}, {"G", constant(1)}, {"B", constant(0)}};
  Imf::Header header = header_of(4, 2, channels);
  Imf::addChromaticities(header, chromaticities(kAcesCg));
  write(header, channels);
  const ImageFile file = read();
  for (const float v : file.image.pixels) EXPECT_GE(v, 0.0f);
  EXPECT_EQ(fact_named(file, "gamut").value, "8 pixels beyond Rec.709");
  EXPECT_TRUE(read_clean_environment(path()).warnings.empty());
}

// ----- directions

TEST_F(unit_image_exr_meaning, environments_of_openexr_are_read_by_its_convention) {
  Channels channels = colors(1);
  channels["R"] = {[](int x, int y) { return static_cast<float>(x + 100 * y); }};
  Imf::Header header = header_of(8, 4, channels);
  Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  // Its window is that of the data.
  header.displayWindow() = Box2i(V2i(2, 1), V2i(3, 2));
  write(header, channels);
  EXPECT_EQ(read().projection, Projection::latlong);
  EXPECT_EQ(read().image.width, 8);
  EXPECT_EQ(read_environment_file(path()).panorama.pixels, panorama_from_openexr(read().image).pixels);

  header = header_of(4, 24, channels);
  Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  write(header, channels);
  const EnvironmentFile file = read_environment_file(path());
  ASSERT_FALSE(file.cube.empty());
  EXPECT_EQ(file.cube.levels[0][5].pixels, cube_from_openexr(read().image)[5].pixels);
  EXPECT_TRUE(file.warnings.empty());
  // Who says the axes means a strip.
  EXPECT_NE(read_environment_file(path(), kPictureAxes).cube.levels[0][5].pixels, file.cube.levels[0][5].pixels);
}

TEST_F(unit_image_exr_meaning, an_envmap_that_cannot_be_is_told) {
  Channels channels = colors(1);
  for (const auto& [width, height, value] : {std::tuple(8, 4, 1), {4, 23, 1}, {8, 4, 7}}) {
    Imf::Header header = header_of(width, height, channels);
    Imf::addEnvmap(header, value == 7 ? Imf::ENVMAP_LATLONG : Imf::ENVMAP_CUBE);
    write(header, channels);
    if (value == 7) {
      test::Bytes bytes = read_file(path());
      const test::Bytes needle = test::bytes_of(std::string("envmap\0envmap\0\1\0\0\0", 18));
      *(std::search(bytes.begin(), bytes.end(), needle.begin(), needle.end()) + 18) = std::byte{7};
      write_file(path(), bytes);
    }
    EXPECT_EQ(read().projection, Projection::unsaid);
    EXPECT_TRUE(fact_named(read(), "envmap").is_odd) << width << ' ' << height;
    EXPECT_EQ(read_environment_file(path()).warnings.size(), 1U);
  }
}

TEST_F(unit_image_exr_meaning, damage_to_what_it_says_is_an_error_and_never_a_crash) {
  const auto decode = [](std::span<const std::byte> bytes) { codec::decode_exr(bytes, {}, "t"); };
  const Channels yc{
      {"Y", constant(1)}, {"RY", {[](int, int) { return 0.1f; }, 2}}, {"BY", {[](int, int) { return 0.1f; }, 2}}};
  Imf::Header header = header_of(4, 2, yc);
  Imf::addChromaticities(header, chromaticities(kAcesCg));
  Imf::addAdoptedNeutral(header, V2f(0.3f, 0.3f));
  write(header, yc);
  test::check_damage(decode, read_file(path()));
  const Channels cube = colors(1, "layer.");
  header = header_of(1, 6, cube);
  Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  Imf::addMultiView(header, {"left", "right"});
  write(header, cube);
  test::check_damage(decode, read_file(path()));
  write({{"depth", {{"Z", constant(5)}}, "left"}, {"rgba", colors(0.5f), "right"}});
  test::check_damage(decode, read_file(path()));
}

}  // namespace
}  // namespace candela
