#include "path/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;
using path::Encoding;
using path::TextureReader;

struct Picture {
  int width = 0;
  int height = 0;
  int bits = 8;
  std::vector<std::uint16_t> rgba;
};

Picture noise(int width, int height, int bits) {
  Picture p{width, height, bits, {}};
  Pcg32 random(static_cast<std::uint64_t>(width * 100 + height));
  for (int i = 0; i < width * height * 4; ++i)
    p.rgba.push_back(static_cast<std::uint16_t>(random.next() & (bits == 8 ? 0xffU : 0xffffU)));
  return p;
}

int add(SceneBuilder& b, const Picture& p, Filter filter, Wrap u, Wrap v) {
  const std::vector<std::uint8_t> bytes(p.rgba.begin(), p.rgba.end());
  const int texture = p.bits == 8 ? b.add_texture(p.width, p.height, bytes, filter, u)
                                  : b.add_texture_16(p.width, p.height, p.rgba, filter, u);
  b.scene().textures.back().wrap_v = v;
  return texture;
}

// ----- the slow reference: OpenGL ES 3.0 §3.8.9–3.8.10, in double precision, one texel at a time

int wrapped(long i, int size, Wrap wrap) {
  const long n = size;
  switch (wrap) {
    case Wrap::repeat:
      return static_cast<int>(((i % n) + n) % n);
    case Wrap::clamp_to_edge:
      return static_cast<int>(std::min(std::max(i, 0L), n - 1));
    case Wrap::mirrored_repeat: {
      const long m = ((i % (2 * n)) + 2 * n) % (2 * n);
      return static_cast<int>(m < n ? m : 2 * n - 1 - m);
    }
  }
  return 0;
}

glm::dvec4 reference_texel(const Picture& p, Encoding encoding, int x, int y) {
  glm::dvec4 v(0.0);
  for (int c = 0; c < 4; ++c) {
    v[c] = p.rgba[static_cast<std::size_t>((y * p.width + x) * 4 + c)] / (p.bits == 8 ? 255.0 : 65535.0);
    if (encoding == Encoding::srgb && c < 3)
      v[c] = v[c] <= 0.04045 ? v[c] / 12.92 : std::pow((v[c] + 0.055) / 1.055, 2.4);
  }
  return v;
}

glm::dvec4 reference(const Picture& p, Encoding encoding, Filter filter, Wrap wu, Wrap wv, dvec2 uv) {
  const double x = uv.x * p.width, y = uv.y * p.height;
  const auto texel = [&](double i, double j) {
    return reference_texel(p, encoding, wrapped(static_cast<long>(i), p.width, wu),
                           wrapped(static_cast<long>(j), p.height, wv));
  };
  if (filter == Filter::nearest) return texel(std::floor(x), std::floor(y));
  const double i = std::floor(x - 0.5), j = std::floor(y - 0.5);
  const double s = x - 0.5 - i, t = y - 0.5 - j;
  return (texel(i, j) * (1.0 - s) + texel(i + 1, j) * s) * (1.0 - t) +
         (texel(i, j + 1) * (1.0 - s) + texel(i + 1, j + 1) * s) * t;
}

constexpr Wrap kWraps[] = {Wrap::repeat, Wrap::clamp_to_edge, Wrap::mirrored_repeat};

TEST(unit_path_texture, reading_equals_the_slow_reference) {
  Pcg32 random(5);
  for (const Picture& p : {noise(7, 5, 8), noise(4, 8, 16), noise(1, 3, 8)}) {
    for (const Wrap wu : kWraps) {
      for (const Wrap wv : kWraps) {
        for (const Filter filter : {Filter::nearest, Filter::linear}) {
          for (const Encoding encoding : {Encoding::srgb, Encoding::data}) {
            SceneBuilder b;
            const TextureSlot s = slot(add(b, p, filter, wu, wv));
            const Scene scene = b.build();
            const TextureReader reader(scene, s, encoding);
            ASSERT_TRUE(reader);
            for (int i = 0; i < 200; ++i) {
              const vec2 uv = random.next_vec2() * 8.0f - 4.0f;
              const glm::dvec4 expected = reference(p, encoding, filter, wu, wv, dvec2(uv));
              const glm::dvec4 found(reader.sample(uv));
              ASSERT_LT(glm::length(found - expected), 2e-5 * std::max(p.width, p.height))
                  << p.width << "x" << p.height << " uv " << uv.x << " " << uv.y;
            }
          }
        }
      }
    }
  }
}

TEST(unit_path_texture, wrap_modes_and_encodings_differ_from_each_other) {
  // The reference would not notice if all of these were the same.
  const Picture p = noise(7, 5, 8);
  const dvec2 outside(1.3, -0.4), inside(0.3, 0.4);
  EXPECT_NE(reference(p, Encoding::data, Filter::linear, Wrap::repeat, Wrap::repeat, outside),
            reference(p, Encoding::data, Filter::linear, Wrap::mirrored_repeat, Wrap::repeat, outside));
  EXPECT_NE(reference(p, Encoding::data, Filter::linear, Wrap::repeat, Wrap::repeat, outside),
            reference(p, Encoding::data, Filter::linear, Wrap::repeat, Wrap::clamp_to_edge, outside));
  EXPECT_NE(reference(p, Encoding::data, Filter::linear, Wrap::repeat, Wrap::repeat, inside),
            reference(p, Encoding::srgb, Filter::linear, Wrap::repeat, Wrap::repeat, inside));
  EXPECT_NE(reference(p, Encoding::data, Filter::linear, Wrap::repeat, Wrap::repeat, inside),
            reference(p, Encoding::data, Filter::nearest, Wrap::repeat, Wrap::repeat, inside));
}

TEST(unit_path_texture, slot_transform_is_applied_before_wrapping) {
  // KHR_texture_transform: scale, then turn, then move (uv' = T R S uv).
  const vec2 offset(0.3f, -1.2f), scale(2.0f, 0.5f);
  const float angle = 0.6f;
  const Picture p = noise(8, 8, 8);
  SceneBuilder b;
  TextureSlot s = slot(add(b, p, Filter::linear, Wrap::repeat, Wrap::mirrored_repeat));
  s.transform = {vec2(std::cos(angle), -std::sin(angle)) * scale.x, vec2(std::sin(angle), std::cos(angle)) * scale.y,
                 offset};
  const Scene scene = b.build();
  const TextureReader reader(scene, s, Encoding::data);
  Pcg32 random(6);
  for (int i = 0; i < 200; ++i) {
    const vec2 uv = random.next_vec2();
    const vec2 scaled = uv * scale;
    const dvec2 expected_uv(std::cos(angle) * scaled.x + std::sin(angle) * scaled.y + offset.x,
                            -std::sin(angle) * scaled.x + std::cos(angle) * scaled.y + offset.y);
    const glm::dvec4 expected =
        reference(p, Encoding::data, Filter::linear, Wrap::repeat, Wrap::mirrored_repeat, expected_uv);
    ASSERT_LT(glm::length(glm::dvec4(reader.sample(uv)) - expected), 1e-4);
  }
}

TEST(unit_path_texture, absurd_coordinates_stay_inside_the_picture) {
  constexpr float kHuge = 3e38f;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const Wrap wrap : kWraps) {
    for (const Filter filter : {Filter::nearest, Filter::linear}) {
      SceneBuilder b;
      const TextureSlot s = slot(add(b, noise(5, 3, 8), filter, wrap, wrap));
      const Scene scene = b.build();
      const TextureReader reader(scene, s, Encoding::data);
      for (const float u : {kHuge, -kHuge, kInfinity, -kInfinity, kNan, 1e-30f, -1e-30f, 1.0f, 0x1.fffffep-1f}) {
        for (const float v : {0.5f, u}) {
          const vec4 texel = reader.sample({u, v});
          for (int c = 0; c < 4; ++c)
            EXPECT_TRUE(texel[c] >= 0.0f && texel[c] <= 1.0f) << u << ' ' << v << ' ' << texel[c];
        }
      }
    }
  }
}

TEST(unit_path_texture, no_texture_means_no_reader) {
  SceneBuilder b;
  EXPECT_FALSE(TextureReader(b.build(), TextureSlot{}, Encoding::srgb));
  EXPECT_FALSE(TextureReader());
}

/// Looks at a unit square of `primitive` from the front, unlit, so that the picture is the texture.
Image picture_of(SceneBuilder b, Primitive primitive, const Material& material) {
  b.add(std::move(primitive), material);
  View view;
  view.world_from_camera = translation({0.5f, 0.5f, 1.0f});
  view.projection = OrthographicCamera{.xmag = 0.5f, .ymag = 0.5f};
  return shoot(b.build(), dark_environment(), view, centred(2, 1, 1)).beauty;
}

TEST(unit_path_texture, every_uv_set_has_its_own_coordinates) {
  SceneBuilder b;
  const int texture = b.add_texture(2, 1, {255, 0, 0, 255, 0, 255, 0, 255}, Filter::nearest);
  for (const int set : {0, 1, 2, 7, 40}) {
    Primitive p = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    for (const std::size_t other : {0u, 1u, 2u, 7u, 40u}) p.uvs[other].assign(4, vec2(0.25f, 0.5f));
    p.uvs[static_cast<std::size_t>(set)].assign(4, vec2(0.75f, 0.5f));
    SceneBuilder one = b;
    Material m = unlit(vec3(1.0f));
    m.base_color_texture = slot(texture, set);
    one.add(p, m);
    const Film film = shoot(one.build(), dark_environment(), look_at({0, 0, 2}, vec3(0), 0.5f), settings(4, 1, 1));
    EXPECT_EQ(film.beauty.rgb(2, 2), vec3(0, 1, 0)) << set;
  }
}

TEST(unit_path_texture, second_uv_set_is_used_where_the_slot_says_so) {
  SceneBuilder b;
  Material m = unlit(vec3(1.0f));
  m.base_color_texture = slot(b.add_texture(2, 1, {255, 0, 0, 255, 0, 255, 0, 255}, Filter::nearest), 1);
  Primitive p = quad(vec3(0.0f), {1, 0, 0}, {0, 1, 0});
  p.uvs[1] = {{1, 0}, {0, 0}, {0, 1}, {1, 1}};  // the other way round
  const Image second = picture_of(b, p, m);
  EXPECT_EQ(second.rgb(0, 0), vec3(0, 1, 0));
  EXPECT_EQ(second.rgb(1, 0), vec3(1, 0, 0));
  m.base_color_texture.uv_set = 0;
  const Image first = picture_of(b, p, m);
  EXPECT_EQ(first.rgb(0, 0), vec3(1, 0, 0));
  EXPECT_EQ(first.rgb(1, 0), vec3(0, 1, 0));
}

TEST(unit_path_texture, v_runs_downwards_as_in_gltf) {
  SceneBuilder b;
  Material m = unlit(vec3(1.0f));
  m.base_color_texture = slot(b.add_texture(1, 2, {255, 0, 0, 255, 0, 0, 255, 255}, Filter::nearest));
  const Image image = picture_of(b, quad(vec3(0.0f), {1, 0, 0}, {0, 1, 0}), m);
  // Row 0 of the texture is v = 0, which the quad has at its lower edge.
  EXPECT_EQ(image.rgb(0, 1), vec3(1, 0, 0));
  EXPECT_EQ(image.rgb(0, 0), vec3(0, 0, 1));
}

}  // namespace
}  // namespace candela
