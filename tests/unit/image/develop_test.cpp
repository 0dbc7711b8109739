#include "image/develop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/file.h"
#include "base/parallel.h"
#include "shade/color.glsl.h"
#include "shade/tonemap.glsl.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

namespace candela {
namespace {

constexpr ToneCurve kCurves[] = {ToneCurve::pbr_neutral, ToneCurve::agx,         ToneCurve::aces,
                                 ToneCurve::reinhard,    ToneCurve::exponential, ToneCurve::linear};

Film flat_film(int width, int height, vec3 color, float alpha = 1.0f) {
  Film film;
  film.beauty = Image(width, height, 4);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      film.beauty.set_rgb(x, y, color * alpha);
      film.beauty.at(x, y)[3] = alpha;
    }
  }
  return film;
}

double mean_code(const DisplayImage& image, std::size_t channel) {
  double sum = 0.0;
  for (std::size_t i = channel; i < image.rgba.size(); i += 4) sum += image.rgba[i];
  return sum * 4.0 / static_cast<double>(image.rgba.size());
}

TEST(unit_image_develop, without_dither_every_curve_is_rounded_from_the_shared_functions) {
  Film film;
  film.beauty = test::random_image(64, 64, 3);
  for (const ToneCurve curve : kCurves) {
    SCOPED_TRACE(tone_curve_name(curve));
    const DisplayImage image = develop(film, {.exposure = 0.7f, .tone_curve = curve, .dither = false});
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const vec3 shown = shade::tone_map(static_cast<int>(curve), film.beauty.rgb(x, y) * 0.7f);
        const vec3 exact = shade::srgb_encode(shown) * 255.0f;
        const std::uint8_t* p = &image.rgba[static_cast<std::size_t>(4 * (y * 64 + x))];
        // The table may only move a value across a rounding limit that it lies on.
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(static_cast<float>(p[c]), exact[c], 0.5f + 5e-4f);
        ASSERT_EQ(p[3], 255);
      }
    }
  }
}

TEST(unit_image_develop, what_is_shown_is_what_is_developed) {
  Film film;
  film.beauty = test::random_image(16, 16, 3);
  for (const ToneCurve curve : kCurves) {
    const DisplayImage image = develop(film, {.exposure = 0.7f, .tone_curve = curve, .dither = false});
    const Shown shown(curve, 0.7f);
    for (int i = 0; i < 256; ++i) {
      const vec3 code = shown(film.beauty.rgb(i % 16, i / 16)) * 255.0f;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(code[c], static_cast<float>(image.rgba[static_cast<std::size_t>(4 * i + c)]), 0.501f);
    }
  }
}

TEST(unit_image_develop, the_error_of_what_is_shown_is_that_of_light_times_the_slope_of_the_curve) {
  constexpr float kRelative = 0.02f;
  for (const ToneCurve curve : kCurves) {
    SCOPED_TRACE(tone_curve_name(curve));
    const Shown shown(curve, 2.0f);
    for (const float light : {0.01f, 0.05f, 0.2f}) {
      const auto code = [&](float l) {
        return shade::srgb_encode(shade::tone_map(static_cast<int>(curve), vec3(2.0f * l))).x;
      };
      const float slope = (code(1.01f * light) - code(0.99f * light)) / (0.02f * light);
      EXPECT_NEAR(shown.error(vec3(light), kRelative), slope * kRelative * light, 0.02f * slope * kRelative * light);
    }
    EXPECT_EQ(shown.error(vec3(0.0f), 0.5f), 0.0f);
    EXPECT_EQ(shown.error(vec3(0.2f), 0.0f), 0.0f);
    EXPECT_EQ(shown.error(vec3(0.2f), std::numeric_limits<float>::infinity()), std::numeric_limits<float>::infinity());
    // As large as the light and more, it is at most half of what is shown of twice the light.
    EXPECT_LE(shown.error(vec3(0.01f), 1.0f), 0.5f * shown(vec3(0.02f)).x + 1e-6f);
  }
  // White is white however uncertain, and the channel that changes most speaks for a colour.
  EXPECT_EQ(Shown(ToneCurve::linear, 100.0f).error(vec3(1.0f), 0.5f), 0.0f);
  const Shown linear(ToneCurve::linear, 1.0f);
  EXPECT_FLOAT_EQ(linear.error({0.5f, 0.01f, 0.0f}, 0.1f), linear.error({0.5f, 0.5f, 0.5f}, 0.1f));
}

TEST(unit_image_develop, every_code_value_survives_decoding_and_developing) {
  Film film;
  film.beauty = Image(256, 1, 3);
  for (int i = 0; i < 256; ++i)
    film.beauty.set_rgb(i, 0, vec3(shade::srgb_decode_channel(static_cast<float>(i) / 255.0f)));
  const DisplayImage image = develop(film, {.exposure = 1.0f, .tone_curve = ToneCurve::linear, .dither = false});
  for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(image.rgba[i * 4], i);
}

TEST(unit_image_develop, dither_keeps_the_mean_that_rounding_loses) {
  for (const float between : {10.3f, 100.6f, 200.8f}) {
    const Film film = flat_film(128, 128, vec3(shade::srgb_decode_channel(between / 255.0f)));
    DevelopSettings settings{.exposure = 1.0f, .tone_curve = ToneCurve::linear, .dither = true};
    const DisplayImage image = develop(film, settings);
    EXPECT_NEAR(mean_code(image, 0), static_cast<double>(between), 0.01);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      ASSERT_NEAR(static_cast<float>(image.rgba[i]), between, 1.0f);  // at most the two neighbours
      ASSERT_EQ(image.rgba[i], image.rgba[i + 1]);                    // grey stays grey
      ASSERT_EQ(image.rgba[i], image.rgba[i + 2]);
    }
    settings.dither = false;
    EXPECT_NEAR(mean_code(develop(film, settings), 0), std::round(static_cast<double>(between)), 0.5001);
    EXPECT_EQ(std::fmod(mean_code(develop(film, settings), 0), 1.0), 0.0);
  }
}

TEST(unit_image_develop, dither_is_even_in_every_small_window) {
  const float between = 100.5f;
  const Film film = flat_film(256, 256, vec3(shade::srgb_decode_channel(between / 255.0f)));
  const DisplayImage image = develop(film, {.exposure = 1.0f, .tone_curve = ToneCurve::linear});
  for (int y0 = 0; y0 < 256; y0 += 8) {
    for (int x0 = 0; x0 < 256; x0 += 8) {
      double sum = 0.0;
      for (int y = y0; y < y0 + 8; ++y)
        for (int x = x0; x < x0 + 8; ++x) sum += image.rgba[static_cast<std::size_t>((y * 256 + x) * 4)];
      // 64 independent choices would have a deviation of 0.0625; 32 x 32 windows of them would reach past 0.19.
      EXPECT_NEAR(sum / 64.0, 100.5, 0.1);
    }
  }
}

TEST(unit_image_develop, black_and_white_are_never_dithered) {
  for (const ToneCurve curve : kCurves) {
    const DisplayImage black = develop(flat_film(300, 200, vec3(0.0f)), {.exposure = 1.0f, .tone_curve = curve});
    EXPECT_EQ(mean_code(black, 0), 0.0) << tone_curve_name(curve);
  }
  const DisplayImage white =
      develop(flat_film(300, 200, vec3(1.0f)), {.exposure = 1.0f, .tone_curve = ToneCurve::linear});
  for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(mean_code(white, c), 255.0);
}

TEST(unit_image_develop, the_picture_does_not_depend_on_threads) {
  Film film;
  film.beauty = test::random_image(211, 97, 4);
  std::vector<std::uint8_t> first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const DisplayImage image = develop(film, {});
    if (first.empty()) first = image.rgba;
    EXPECT_EQ(image.rgba, first);
  }
}

TEST(unit_image_develop, non_finite_pixels_are_black_or_white_in_every_curve) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Film film;
  film.beauty = Image(4, 1, 4);
  film.beauty.set_rgb(0, 0, vec3(nan, nan, nan));
  film.beauty.set_rgb(1, 0, vec3(kInfinity, 0.0f, 1.0f));
  film.beauty.set_rgb(2, 0, vec3(-kInfinity, -1.0f, 0.0f));
  film.beauty.set_rgb(3, 0, vec3(1.0f));
  for (int x = 0; x < 3; ++x) film.beauty.at(x, 0)[3] = 1.0f;
  film.beauty.at(3, 0)[3] = nan;
  for (const ToneCurve curve : kCurves) {
    const DisplayImage image = develop(film, {.exposure = 1.0f, .tone_curve = curve});
    const std::vector<std::uint8_t> expected{0, 0, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 0};
    EXPECT_EQ(image.rgba, expected) << tone_curve_name(curve);
  }
}

TEST(unit_image_develop, alpha_is_straight_in_the_display_image) {
  for (const float alpha : {0.25f, 0.5f, 1.0f}) {
    const DisplayImage image = develop(flat_film(2, 2, vec3(0.3f), alpha),
                                       {.exposure = 1.0f, .tone_curve = ToneCurve::linear, .dither = false});
    EXPECT_NEAR(static_cast<float>(image.rgba[0]), 255.0f * shade::srgb_encode_channel(0.3f), 0.5f);
    EXPECT_NEAR(static_cast<float>(image.rgba[3]), 255.0f * alpha, 0.5f);
  }
  const DisplayImage clear = develop(flat_film(1, 1, vec3(0.3f), 0.0f), {.exposure = 1.0f});
  EXPECT_EQ(clear.rgba, (std::vector<std::uint8_t>{0, 0, 0, 0}));
}

/// A pane over the whole picture that shows `light` and lets `through` of what is behind.
Film glass_film(vec3 light, vec3 through, float coverage = 1.0f) {
  Film film = flat_film(4, 4, light, 1.0f);
  Image image(4, 4, 4);
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
    for (int c = 0; c < 3; ++c) image.pixels[i + static_cast<std::size_t>(c)] = through[c];
    image.pixels[i + 3] = coverage;
  }
  set_through(std::move(image), film);
  return film;
}

TEST(unit_image_develop, a_background_is_seen_through_coloured_glass_in_its_own_colours) {
  const vec3 light(0.2f, 0.1f, 0.05f), through(0.9f, 0.5f, 0.0f), background(0.3f, 0.4f, 0.8f);
  for (const ToneCurve curve : kCurves) {
    for (const float coverage : {1.0f, 0.25f}) {
      // Where the pane ends the rest of the pixel is background.
      const vec3 open = through * coverage + (1.0f - coverage);
      const DisplayImage image =
          develop(glass_film(light * coverage, open, coverage),
                  {.exposure = 1.5f, .tone_curve = curve, .background = background, .dither = false});
      const vec3 shown = coverage * shade::tone_map(static_cast<int>(curve), light * 1.5f) + open * background;
      const vec3 exact = shade::srgb_encode(glm::min(shown, vec3(1.0f))) * 255.0f;
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(image.rgba[c], exact[static_cast<int>(c)], 0.51f);
      ASSERT_EQ(image.rgba[3], 255);
    }
  }
}

/// Channel 0 of a picture of one colour, laid over a page in linear light.
double over_page(const DisplayImage& image, double page) {
  const auto decoded = [&](std::size_t i) {
    return shade::srgb_decode_channel(static_cast<float>(image.rgba[i]) / 255.0f);
  };
  const double alpha = image.rgba[3] / 255.0;
  return static_cast<double>(decoded(0)) * alpha + page * (1.0 - alpha);
}

TEST(unit_image_develop, a_background_that_shows_the_page_is_both_in_their_shares) {
  for (const float coverage : {0.0f, 0.3f, 1.0f}) {
    for (const float opacity : {0.25f, 0.75f}) {
      DevelopSettings settings{.exposure = 1.0f, .tone_curve = ToneCurve::linear, .dither = false};
      const Film film = flat_film(2, 2, vec3(0.6f, 0.2f, 0.1f), coverage);
      const DisplayImage alone = develop(film, settings);
      settings.background = vec3(0.1f, 0.9f, 0.5f);
      settings.background_opacity = opacity;
      const DisplayImage image = develop(film, settings);
      for (const double page : {0.0, 0.4, 1.0}) {
        const double behind = 0.1 * static_cast<double>(opacity) + page * (1.0 - static_cast<double>(opacity));
        EXPECT_NEAR(over_page(image, page), over_page(alone, behind), 0.01) << coverage << ' ' << opacity;
      }
      EXPECT_EQ(image.rgba[3], std::lround(255.0f * (coverage + (1.0f - coverage) * opacity)));
    }
  }
}

TEST(unit_image_develop, a_plain_background_stays_plain_beside_glass) {
  const Film nothing = glass_film(vec3(0.0f), vec3(1.0f), 0.0f);
  for (const float bloom : {0.0f, 0.1f}) {
    const DisplayImage image =
        develop(nothing, {.exposure = 1.0f, .background = vec3(1.0f, 0.0f, 1.0f), .bloom = bloom});
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      EXPECT_EQ(image.rgba[i], 255);
      EXPECT_EQ(image.rgba[i + 1], 0);
      EXPECT_EQ(image.rgba[i + 2], 255);
    }
  }
  EXPECT_EQ(develop(nothing, {.exposure = 1.0f}).rgba[3], 0);
}

TEST(unit_image_develop, alpha_of_glass_is_what_it_keeps_unless_it_reflects_more) {
  const DevelopSettings settings{.exposure = 1.0f, .tone_curve = ToneCurve::linear, .dither = false};
  EXPECT_EQ(develop(glass_film(vec3(0.02f), vec3(0.9f)), settings).rgba[3], 26);
  EXPECT_EQ(develop(glass_film(vec3(0.0f), vec3(0.9f, 0.9f, 0.0f)), settings).rgba[3],
            static_cast<int>(255.0f * (1.0f - 0.9f * 0.9278f) + 0.5f));
  // A highlight of half of white over glass that keeps a tenth: over black it shows as what it is.
  const DisplayImage highlight = develop(glass_film(vec3(0.5f), vec3(0.9f)), settings);
  EXPECT_EQ(highlight.rgba[3], 128);
  EXPECT_EQ(highlight.rgba[0], 255);
}

TEST(unit_image_film, what_shows_through_is_averaged_like_the_picture) {
  const Film a = glass_film(vec3(0.2f), vec3(0.9f, 0.5f, 0.1f)), b = glass_film(vec3(0.6f), vec3(0.1f), 0.5f);
  Film mean;
  accumulate(a, 0.5f, mean);
  accumulate(b, 0.5f, mean);
  EXPECT_NEAR(mean.through.at(1, 1)[0], 0.5f, 1e-6f);
  EXPECT_NEAR(mean.through.at(1, 1)[2], 0.1f, 1e-6f);
  EXPECT_NEAR(mean.through.at(1, 1)[3], 0.75f, 1e-6f);
  EXPECT_NEAR(mean.beauty.at(1, 1)[3], alpha_before({0.5f, 0.3f, 0.1f}), 1e-6f);
  EXPECT_EQ(alpha_before(vec3(0.0f)), 1.0f);
  EXPECT_EQ(alpha_before(vec3(1.0f)), 0.0f);
}

TEST(unit_image_develop, tone_curve_names_are_those_of_the_command_line) {
  for (const char* name : {"pbr-neutral", "agx", "aces", "reinhard", "exponential", "linear"})
    EXPECT_EQ(tone_curve_name(parse_tone_curve(name)), name);
  EXPECT_THROW(parse_tone_curve("filmic"), Error);
  EXPECT_THROW(parse_tone_curve(""), Error);
}

TEST(unit_image_exposure, text_means_what_the_manual_says) {
  EXPECT_EQ(parse_exposure("auto"), std::nullopt);
  EXPECT_FLOAT_EQ(parse_exposure("0").value(), 1.0f);
  EXPECT_FLOAT_EQ(parse_exposure("-1.5").value(), std::exp2(-1.5f));
  EXPECT_FLOAT_EQ(parse_exposure("+2").value(), 4.0f);
  // f/1 for 1 s at ISO 100 is EV100 = 0; f/8, 1/125 s is 2^EV = 64 · 125 = 8000.
  EXPECT_FLOAT_EQ(parse_exposure("f/1,1,100").value(), 1.0f / 1.2f);
  EXPECT_FLOAT_EQ(parse_exposure("f/8,1/125,100").value(), 1.0f / (1.2f * 8000.0f));
  EXPECT_FLOAT_EQ(parse_exposure("f/8,0.008,400").value(), 1.0f / (1.2f * 2000.0f));
}

TEST(unit_image_exposure, anything_else_is_an_error) {
  for (const char* text : {"",
                           "Auto",
                           "bright",
                           "1.5x",
                           "nan",
                           "inf",
                           "++1",
                           "1e9",
                           "-1e9",
                           "f/8",
                           "f/8,1/125",
                           "8,1/125,100",
                           "f/0,1/125,100",
                           "f/8,1/0,100",
                           "f/8,-1,100",
                           "f/8,1/125,0",
                           "f/8,1/125,100,",
                           "f/8,1/125,100 ",
                           "f/8,1/,100",
                           "f/8,,100",
                           "f/-8,1,100",
                           "f/nan,1,100"})
    EXPECT_THROW(parse_exposure(text), Error) << text;
}

TEST(unit_image_exposure, a_flat_picture_is_exposed_to_middle_grey) {
  EXPECT_FLOAT_EQ(metered_exposure(flat_film(30, 20, vec3(2.0f))), 0.09f);
  EXPECT_FLOAT_EQ(metered_exposure(flat_film(1, 1, vec3(0.001f))), 180.0f);
  EXPECT_FLOAT_EQ(metered_exposure(flat_film(4, 4, vec3(0.0f))), 1.0f);
  EXPECT_FLOAT_EQ(metered_exposure(Film{}), 1.0f);
}

TEST(unit_image_exposure, the_log_average_is_metered_and_black_is_left_out) {
  Film film = flat_film(20, 20, vec3(0.0f));
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x) film.beauty.set_rgb(x, y, vec3(x < 10 ? 0.25f : 4.0f));
  EXPECT_NEAR(metered_exposure(film), 0.18f, 1e-6f);  // √(0.25 · 4) = 1
}

TEST(unit_image_exposure, the_outermost_percent_does_not_count) {
  Film film = flat_film(100, 10, vec3(1.0f));
  for (int x = 0; x < 10; ++x) {
    film.beauty.set_rgb(x, 0, vec3(1e6f));
    film.beauty.set_rgb(x, 1, vec3(1e-9f));
  }
  EXPECT_NEAR(metered_exposure(film), 0.18f, 1e-6f);
  film.beauty.set_rgb(50, 5, vec3(1e6f));  // the eleventh of 1000
  EXPECT_LT(metered_exposure(film), 0.1799f);
}

TEST(unit_image_exposure, coverage_is_the_weight_and_does_not_darken) {
  EXPECT_NEAR(metered_exposure(flat_film(9, 9, vec3(1.0f), 0.25f)), 0.18f, 1e-6f);
  Film film = flat_film(20, 20, vec3(1.0f));
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      film.beauty.set_rgb(x, y, vec3(16.0f * 0.25f));
      film.beauty.at(x, y)[3] = 0.25f;
    }
  }
  EXPECT_NEAR(metered_exposure(film), 0.18f * std::exp2(-4.0f * 0.25f / 1.25f), 1e-5f);
}

/// `lit` tenths of it in the light.
Film lit_before_backdrop(int lit, float light, float backdrop) {
  Film film = flat_film(100, 20, vec3(backdrop));
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 10 * lit; ++x) film.beauty.set_rgb(x, y, vec3(light));
  return film;
}

TEST(unit_image_exposure, what_lamps_light_is_metered_and_not_a_backdrop_that_they_do_not) {
  for (const int lit : {2, 4, 7}) {
    for (const float backdrop : {0.0f, 1e-6f, 1e-3f, 0.5f}) {
      const float shown = 900.0f * metered_exposure(lit_before_backdrop(lit, 900.0f, backdrop));
      EXPECT_NEAR(shown, 0.18f, 0.05f) << lit << " tenths before " << backdrop;
    }
  }
  // Six stops are what a picture has: within them all counts alike.
  const float even = metered_exposure(lit_before_backdrop(5, 32.0f, 0.5f));
  EXPECT_NEAR(even, 0.18f / 4.0f, 1e-6f);
}

TEST(unit_image_exposure, more_light_never_makes_what_it_lights_darker_than_grey_nor_white) {
  for (float light = 1.0f; light < 1e6f; light *= 2.0f) {
    const float shown = light * metered_exposure(lit_before_backdrop(6, light, 0.5f));
    EXPECT_GE(shown, 0.1799f) << light;
    EXPECT_LE(shown, 1.0f) << light;
  }
}

TEST(unit_image_exposure, at_most_a_tenth_of_what_is_lit_is_white) {
  // Windows of a room: beyond a tenth of the picture it is exposed for them.
  for (const float contrast : {10.0f, 100.0f, 1e4f}) {
    const float shown = contrast * metered_exposure(lit_before_backdrop(2, contrast, 1.0f));
    EXPECT_LE(shown, 1.7001f) << contrast;
  }
  Film small = flat_film(100, 20, vec3(1.0f));
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 5; ++x) small.beauty.set_rgb(x, y, vec3(1e4f));
  EXPECT_GT(metered_exposure(small), 0.1f) << "a lamp that is seen does not darken its room";
}

TEST(unit_image_exposure, a_broken_pixel_does_not_break_the_meter) {
  Film film = flat_film(9, 9, vec3(1.0f));
  film.beauty.set_rgb(0, 0, vec3(std::nanf("")));
  film.beauty.set_rgb(1, 0, vec3(kInfinity));
  film.beauty.set_rgb(2, 0, vec3(-1.0f));
  film.beauty.at(3, 0)[3] = std::nanf("");
  EXPECT_NEAR(metered_exposure(film), 0.18f, 1e-6f);
}

TEST(unit_image_write_film, linear_formats_ignore_exposure_and_curve) {
  const test::TempFolder folder;
  Film film;
  film.beauty = test::random_image(20, 10, 3);
  const DevelopSettings settings{.exposure = 100.0f, .tone_curve = ToneCurve::agx};
  write_film(folder / "a.EXR", film, settings);
  EXPECT_EQ(read_image(folder / "a.EXR").pixels, film.beauty.pixels);
  write_film(folder / "a.hdr", film, settings);
  EXPECT_NEAR(read_image(folder / "a.hdr").pixels[5], film.beauty.pixels[5], film.beauty.pixels[5] * 0.1f + 0.5f);
}

TEST(unit_image_write_film, png_holds_the_developed_picture) {
  const test::TempFolder folder;
  Film film;
  film.beauty = test::random_image(20, 10, 4);
  write_film(folder / "a.png", film, {.exposure = 1.0f});
  EXPECT_EQ(decode_texture(read_file(folder / "a.png"), "t").pixels, develop(film, {.exposure = 1.0f}).rgba);
}

TEST(unit_image_write_film, unknown_extensions_are_refused_before_rendering) {
  for (const char* name : {"a.png", "a.jpg", "a.JPEG", "a.hdr", "dir.x/a.exr"})
    EXPECT_NO_THROW(check_output_extension(name));
  for (const char* name : {"a", "a.", ".png", "a.gif", "a.png/b", "a.pngx"})
    EXPECT_THROW(check_output_extension(name), Error) << name;
  const test::TempFolder folder;
  EXPECT_THROW(write_film(folder / "a.webp", Film{}, {}), Error);
}

}  // namespace
}  // namespace candela
