#include "image/movie.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <webp/demux.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/file.h"
#include "unit/base/temp_folder.h"

// An independent reader.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_GIF
#define STBI_NO_STDIO
#include <stb_image.h>

namespace candela {
namespace {

using test::TempFolder;
using testing::HasSubstr;

constexpr ivec2 kSize{48, 32};

/// A disc that wanders over a gradient, or over nothing.
DisplayImage picture(int index, bool is_clear = false, ivec2 size = kSize) {
  DisplayImage image{.width = size.x, .height = size.y, .rgba = {}};
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const bool is_disc = std::hypot(x - 10 - 5 * index, y - 16) < 8;
      const auto shade = static_cast<std::uint8_t>(255 * x / (size.x - 1));
      const auto other = static_cast<std::uint8_t>(255 * y / (size.y - 1));
      const std::uint8_t alpha = is_disc || !is_clear ? 255 : 0;
      if (is_disc) {
        image.rgba.insert(image.rgba.end(), {220, 30, 40, alpha});
      } else {
        image.rgba.insert(image.rgba.end(), {shade, other, 128, alpha});
      }
    }
  }
  return image;
}

void write(const std::filesystem::path& path, const MovieSettings& settings, int count = 5) {
  const auto writer = open_movie(path, settings);
  for (int i = 0; i < count; ++i) writer->add(picture(i, settings.has_alpha, settings.size));
  writer->finish();
}

struct GifPictures {
  ivec2 size{0};
  std::vector<int> delays_ms;
  std::vector<std::uint8_t> rgba;  ///< one picture after the other
};
GifPictures read_gif(const std::vector<std::byte>& bytes) {
  GifPictures result;
  int* delays = nullptr;
  int count = 0, channels = 0;
  stbi_uc* pixels =
      stbi_load_gif_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()), &delays,
                                &result.size.x, &result.size.y, &count, &channels, 4);
  if (pixels == nullptr) return result;
  result.delays_ms.assign(delays, delays + count);
  const auto size = 4 * static_cast<std::size_t>(result.size.x) * static_cast<std::size_t>(result.size.y);
  result.rgba.assign(pixels, pixels + size * static_cast<std::size_t>(count));
  stbi_image_free(delays);
  stbi_image_free(pixels);
  return result;
}

std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(unit_image_movie, a_gif_has_its_pictures_its_delays_and_its_loop) {
  for (const bool has_alpha : {false, true}) {
    const TempFolder folder;
    write(folder / "a.gif", {.size = kSize, .frame_rate = 24.0, .has_alpha = has_alpha}, 7);
    const std::vector<std::byte> bytes = read_file(folder / "a.gif");
    const GifPictures gif = read_gif(bytes);
    ASSERT_EQ(gif.size, kSize);
    ASSERT_EQ(gif.delays_ms.size(), 7u);
    int sum = 0;
    for (const int delay : gif.delays_ms) sum += delay;
    EXPECT_NEAR(sum, 7000.0 / 24.0, 6.0) << "hundredths, whose sum is right";
    EXPECT_THAT(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), HasSubstr("NETSCAPE2.0"));
    for (std::size_t i = 0; i < 7; ++i) {
      const DisplayImage expected = picture(static_cast<int>(i), has_alpha);
      double error = 0.0;
      for (std::size_t k = 0; k < expected.rgba.size(); k += 4) {
        const std::uint8_t* found = &gif.rgba[i * expected.rgba.size() + k];
        ASSERT_EQ(found[3], expected.rgba[k + 3]) << "there or not there";
        if (expected.rgba[k + 3] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) error += std::abs(found[c] - expected.rgba[k + c]);
      }
      EXPECT_LT(error / static_cast<double>(expected.rgba.size()), 8.0) << i;
    }
  }
}

TEST(unit_image_movie, a_gif_of_noise_passes_the_end_of_its_code_table) {
  const TempFolder folder;
  DisplayImage noise{.width = 200, .height = 150, .rgba = {}};
  std::uint32_t state = 1;
  for (int i = 0; i < 200 * 150; ++i) {
    for (int c = 0; c < 4; ++c) {
      state = state * 1664525u + 1013904223u;
      noise.rgba.push_back(c == 3 ? std::uint8_t{255} : static_cast<std::uint8_t>(state >> 24));
    }
  }
  const auto writer = open_movie(folder / "n.gif", {.size = {200, 150}});
  writer->add(noise);
  writer->finish();
  const GifPictures gif = read_gif(read_file(folder / "n.gif"));
  ASSERT_EQ(gif.size, ivec2(200, 150));
  double error = 0.0;
  for (std::size_t k = 0; k < noise.rgba.size(); ++k) error += std::abs(gif.rgba[k] - noise.rgba[k]);
  EXPECT_LT(error / static_cast<double>(noise.rgba.size()), 20.0);
}

TEST(unit_image_movie, a_palette_has_the_few_colours_that_there_are) {
  std::vector<std::uint64_t> counts(Palette::kBins, 0);
  counts[0] = 5;                         // black
  counts[Palette::kBins - 1] = 1;        // white
  counts[std::size_t{31} * 1024] = 100;  // red
  const Palette palette(counts);
  EXPECT_EQ(palette.colors().size(), 3u);
  const auto color = [&](int r, int g, int b) { return palette.colors()[palette.nearest(r, g, b)]; };
  EXPECT_EQ(color(250, 3, 0), (std::array<std::uint8_t, 3>{255, 0, 0}));
  EXPECT_EQ(color(255, 255, 255), (std::array<std::uint8_t, 3>{255, 255, 255}));
  EXPECT_EQ(color(-5, 0, 20), (std::array<std::uint8_t, 3>{0, 0, 0}));
}

TEST(unit_image_movie, a_webp_has_its_pictures_its_times_and_its_loop) {
  const TempFolder folder;
  write(folder / "a.webp", {.size = kSize, .frame_rate = 30.0, .has_alpha = true}, 4);
  const std::vector<std::byte> bytes = read_file(folder / "a.webp");
  const WebPData data{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  const std::unique_ptr<WebPAnimDecoder, void (*)(WebPAnimDecoder*)> decoder(WebPAnimDecoderNew(&data, nullptr),
                                                                             WebPAnimDecoderDelete);
  ASSERT_NE(decoder, nullptr);
  WebPAnimInfo info;
  ASSERT_NE(WebPAnimDecoderGetInfo(decoder.get(), &info), 0);
  EXPECT_EQ(info.frame_count, 4u);
  EXPECT_EQ(info.loop_count, 0u);
  for (int i = 0; i < 4; ++i) {
    std::uint8_t* rgba = nullptr;
    int end_ms = 0;
    ASSERT_NE(WebPAnimDecoderGetNext(decoder.get(), &rgba, &end_ms), 0);
    EXPECT_EQ(end_ms, std::lround(1000.0 * (i + 1) / 30.0));
    const std::size_t disc = 4 * static_cast<std::size_t>(16 * kSize.x + 10 + 5 * i);
    EXPECT_NEAR(rgba[disc], 220, 12);
    EXPECT_EQ(rgba[disc + 3], 255);
    EXPECT_EQ(rgba[3], 0) << "a corner";
  }
}

TEST(unit_image_movie, what_the_formats_have_not_is_refused_beforehand) {
  EXPECT_THAT(message_of([] { check_movie("a.avi", {.size = kSize}); }), HasSubstr(".mp4, .webm, .webp or .gif"));
  EXPECT_THAT(message_of([] { check_movie("a.gif", {.size = kSize, .frame_rate = 60.0}); }), HasSubstr("at most 50"));
  EXPECT_EQ(message_of([] { check_movie("a.webp", {.size = kSize, .frame_rate = 60.0}); }), "");
  const TempFolder folder;
  for (const char* name : {"a.gif", "a.webp"}) {
    EXPECT_THAT(message_of([&] { open_movie(folder / name, {.size = kSize})->finish(); }), HasSubstr("no picture"));
    EXPECT_THAT(message_of([&] {
                  open_movie(folder / name, {.size = kSize})->add(picture(0, false, {8, 8}));
                }),
                HasSubstr("another size"));
  }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(unit_image_movie, a_full_disk_leaves_nothing) {
  for (const char* name : {"a.gif", "a.webp"}) {
    const TempFolder folder;
    const test::FullDisk full(200);
    EXPECT_THAT(message_of([&] { write(folder / name, {.size = kSize}); }), HasSubstr("disk full")) << name;
    EXPECT_EQ(folder.entries(), 0u) << name;
  }
}

/// A folder that is all of PATH beside the system's, with an ffmpeg of these lines.
class PretendedFfmpeg {
 public:
  explicit PretendedFfmpeg(const std::string& script) : before_(std::getenv("PATH")) {
    std::ofstream(folder_ / "ffmpeg") << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(folder_ / "ffmpeg", std::filesystem::perms::owner_all);
    setenv("PATH", (folder_.path().string() + ":/usr/bin:/bin").c_str(), 1);
  }
  ~PretendedFfmpeg() { setenv("PATH", before_.c_str(), 1); }
  PretendedFfmpeg(const PretendedFfmpeg&) = delete;
  PretendedFfmpeg& operator=(const PretendedFfmpeg&) = delete;

 private:
  TempFolder folder_;
  std::string before_;
};

TEST(unit_image_movie, ffmpeg_is_given_every_pixel_and_what_it_writes_appears) {
  const PretendedFfmpeg ffmpeg("for last; do :; done\ncat > \"$last\"");
  const TempFolder folder;
  write(folder / "a.webm", {.size = kSize, .has_alpha = true}, 3);
  const std::vector<std::byte> bytes = read_file(folder / "a.webm");
  std::vector<std::uint8_t> expected;
  for (int i = 0; i < 3; ++i) {
    const DisplayImage p = picture(i, true);
    expected.insert(expected.end(), p.rgba.begin(), p.rgba.end());
  }
  ASSERT_EQ(bytes.size(), expected.size());
  EXPECT_EQ(std::memcmp(bytes.data(), expected.data(), expected.size()), 0);
  EXPECT_EQ(folder.entries(), 1u);
  // An MP4 has no transparency.
  write(folder / "a.mp4", {.size = kSize, .has_alpha = true}, 1);
  EXPECT_EQ(read_file(folder / "a.mp4")[0], std::byte{0});
}

TEST(unit_image_movie, an_ffmpeg_that_dies_or_fails_is_one_line_and_leaves_nothing) {
  const auto message = [](const std::string& script, int pictures = 40) {
    const PretendedFfmpeg ffmpeg(script);
    const TempFolder folder;
    std::string text = message_of([&] { write(folder / "a.mp4", {.size = {640, 480}}, pictures); });
    EXPECT_EQ(folder.entries(), 0u) << script;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    return text;
  };
  EXPECT_THAT(message("echo one >&2; echo no such codec >&2; exit 3"), HasSubstr("(exit code 3): no such codec"));
  EXPECT_THAT(message("kill -9 $$"), HasSubstr("signal 9"));
  EXPECT_THAT(message("cat > /dev/null", 1), HasSubstr("exit code 0")) << "no file";
  EXPECT_THAT(message("for last; do :; done; cat > \"$last\"; echo No space left on device >&2", 1),
              HasSubstr("No space left"));
}

TEST(unit_image_movie, without_ffmpeg_one_hears_of_it_beforehand) {
  const TempFolder empty;
  const std::string before = std::getenv("PATH");
  setenv("PATH", empty.path().c_str(), 1);
  EXPECT_THAT(message_of([] { check_movie("a.mp4", {.size = kSize}); }), HasSubstr("not installed"));
  EXPECT_EQ(message_of([] { check_movie("a.gif", {.size = kSize}); }), "");
  setenv("PATH", before.c_str(), 1);
}

}  // namespace
}  // namespace candela
