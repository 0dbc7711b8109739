#include "candela/gap.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>

#include "base/error.h"

// What of the difference between both engines each approximation has.

namespace candela {
namespace {

Shot shot_of(const std::string& scene, ivec2 size) {
  Shot shot;
  shot.scene = scene;
  shot.size = size;
  return shot;
}

std::vector<ViewGap> gaps_of(const Shot& shot,
                             GapSettings settings = {.samples = 32, .frames = 4, .looks_for_suspects = false}) {
  std::vector<ViewGap> gaps;
  measure_gaps(shot, settings, [&](ViewGap gap) { gaps.push_back(std::move(gap)); });
  return gaps;
}

const CauseGap* cause_of(const ViewGap& gap, GapCause cause) {
  for (const CauseGap& c : gap.causes) {
    if (c.cause == cause) return &c;
  }
  return nullptr;
}

TEST(unit_gap, causes_add_up_to_the_difference_in_every_pixel) {
  for (const char* scene : {"demo:cornell", "demo:row-subsurface"}) {
    Shot shot = shot_of(scene, {48, 24});
    shot.drawn.occlusion_radius = 0.05f;
    shot.environment = "sky";
    const std::vector<ViewGap> gaps = gaps_of(shot);
    ASSERT_EQ(gaps.size(), 1);
    const ViewGap& gap = gaps[0];
    double shares = 0.0;
    for (const CauseGap& c : gap.causes) shares += c.share;
    EXPECT_NEAR(shares, 1.0, 1e-5) << scene;
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 48; ++x) {
        vec3 sum(0.0f);
        for (const CauseGap& c : gap.causes) sum += c.error.rgb(x, y);
        const vec3 difference = gap.frame.beauty.rgb(x, y) - gap.truth.beauty.rgb(x, y);
        const float slack = 1e-4f * (1.0f + max_component(gap.truth.beauty.rgb(x, y)));
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(sum[c], difference[c], slack) << scene << ' ' << x << ' ' << y;
      }
    }
  }
}

TEST(unit_gap, a_room_lit_by_its_lamp_lacks_light_between_surfaces) {
  const ViewGap gap = gaps_of(shot_of("demo:cornell", {48, 48}))[0];
  ASSERT_FALSE(gap.causes.empty());
  EXPECT_EQ(gap.causes[0].cause, GapCause::between);
  EXPECT_GT(gap.causes[0].share, 0.8);
  EXPECT_LT(gap.causes[0].bias.x, -0.1f) << "what is missing makes it darker";
  EXPECT_LT(gap.causes[0].flip_without, 0.3 * gap.difference.flip);
  EXPECT_EQ(cause_of(gap, GapCause::probes), nullptr);
  EXPECT_EQ(cause_of(gap, GapCause::glass), nullptr);
}

TEST(unit_gap, probes_stand_for_what_they_replace) {
  Shot shot = shot_of("demo:cornell", {48, 48});
  shot.probes = 1;
  const ViewGap gap = gaps_of(shot)[0];
  EXPECT_NE(cause_of(gap, GapCause::probes), nullptr);
  EXPECT_EQ(cause_of(gap, GapCause::between), nullptr);
  EXPECT_LT(gap.difference.flip, gaps_of(shot_of("demo:cornell", {48, 48}))[0].difference.flip);
}

TEST(unit_gap, glass_and_scattering_are_causes_of_their_own) {
  const ViewGap glass = gaps_of(shot_of("demo:row-transmission-ior", {96, 24}))[0];
  ASSERT_NE(cause_of(glass, GapCause::glass), nullptr);
  EXPECT_GT(cause_of(glass, GapCause::glass)->share, 0.1);
  const ViewGap wax = gaps_of(shot_of("demo:row-subsurface", {96, 24}))[0];
  ASSERT_NE(cause_of(wax, GapCause::scattering), nullptr);
  EXPECT_EQ(cause_of(wax, GapCause::glass), nullptr);
}

TEST(unit_gap, each_material_has_its_numbers_and_pixels_add_up) {
  const ViewGap gap = gaps_of(shot_of("demo:row-metallic", {96, 24}))[0];
  std::size_t pixels = 0;
  double flip = 0.0;
  for (const MaterialGap& m : gap.materials) {
    pixels += m.numbers.pixels;
    flip += static_cast<double>(m.numbers.pixels) * m.numbers.flip;
  }
  EXPECT_EQ(pixels, 96 * 24);
  EXPECT_NEAR(flip / (96 * 24), gap.difference.flip, 1e-9);
  EXPECT_EQ(gap.numbers.flip, gap.difference.flip);
  EXPECT_GT(gap.materials.size(), 3);
}

TEST(unit_gap, the_noise_of_the_truth_is_no_error) {
  // Of eight samples the noise is larger than the difference, which stays what it is.
  const auto of = [](int samples) {
    return gaps_of(shot_of("demo:row-metallic", {96, 24}),
                   {.samples = samples, .frames = 1, .looks_for_suspects = false})[0];
  };
  const ViewGap few = of(8), many = of(256);
  EXPECT_GT(few.flip_noise, 3.0 * many.flip_noise);
  EXPECT_NEAR(few.numbers.relative_l2, many.numbers.relative_l2, 0.15 * many.numbers.relative_l2);
}

TEST(unit_gap, pictures_of_a_set_have_one_exposure) {
  Shot shot = shot_of("demo:row-metallic", {48, 24});
  shot.views = {"front", "top"};
  shot.environment = "sky";
  shot.exposure = std::optional<float>();
  const std::vector<ViewGap> gaps = gaps_of(shot, {.samples = 2, .frames = 1, .looks_for_suspects = false});
  ASSERT_EQ(gaps.size(), 2);
  EXPECT_EQ(gaps[0].label.view, "front");
  EXPECT_EQ(gaps[1].label.view, "top");
  EXPECT_EQ(gaps[0].develop.exposure, gaps[1].develop.exposure);
}

TEST(unit_gap, what_cannot_be_compared_is_refused) {
  const auto refused = [](const std::function<void(Shot&)>& change) {
    Shot shot = shot_of("demo:furnace", {16, 8});
    change(shot);
    EXPECT_THROW(gaps_of(shot), Error);
  };
  refused([](Shot& s) { s.background = Background::transparent; });
  refused([](Shot& s) { s.ground = GroundChoice(); });
  refused([](Shot& s) { s.shutter_s = 0.1; });
  refused([](Shot& s) { s.pictures = PictureRange{}; });
  EXPECT_THROW(gaps_of(shot_of("demo:furnace", {16, 8}), {.samples = 1}), Error);
  const std::atomic<bool> stop{true};
  EXPECT_THROW(measure_gaps(shot_of("demo:furnace", {16, 8}), {}, [](const ViewGap&) {}, {.stop = &stop}), Interrupted);
}

}  // namespace
}  // namespace candela
