#include <array>
#include <cmath>

#include "content/demo_scenes.h"

// The still life of the README: what metallic-roughness, textures, alpha masks, small lamps and a lens can show.
namespace candela::content {
namespace {

constexpr float kBallRadius = 0.054f;

float smoothstep(float from, float to, float x) {
  const float t = glm::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

Material dielectric(const char* name, vec3 color, float roughness) {
  Material material;
  material.name = name;
  material.base_color = color;
  material.metallic = 0.0f;
  material.roughness = roughness;
  return material;
}

Material metal(const char* name, vec3 color, float roughness) {
  Material material;
  material.name = name;
  material.base_color = color;
  material.roughness = roughness;
  return material;
}

// F0 of measured metals as linear Rec.709 (from complex refractive indices under D65); gold's red is held at 1.
const vec3 kGold(1.0f, 0.782f, 0.344f);
const vec3 kCopper(0.955f, 0.638f, 0.538f);
const vec3 kBrass(0.910f, 0.778f, 0.423f);
const vec3 kSteel(0.562f, 0.565f, 0.578f);
const vec3 kSilver(0.972f, 0.960f, 0.915f);

/// Overlapping shallow dents, as a round hammer leaves them.
float hammered(vec2 uv, int cells) {
  const float n = static_cast<float>(cells);
  return 0.30f * tiling_dents(uv * n, ivec2(cells), 9.0f, 11) / n;
}

/// Growth rings, drawn out along u: pale early wood that darkens to a sharp edge.
float wood_rings(vec2 uv) {
  const float bend = tiling_fractal(uv * vec2(2.0f, 3.0f), {2, 3}, 3, 0.5f, 21);
  const float across = uv.y * 11.0f + 1.6f * bend;
  const float ring = across - std::floor(across);
  return ring * ring * (1.0f - smoothstep(0.90f, 1.0f, ring));
}
/// Short dark vessels.
float wood_pores(vec2 uv) {
  return smoothstep(0.22f, 0.55f, tiling_fractal(uv * vec2(14.0f, 150.0f), {14, 150}, 2, 0.5f, 31));
}
vec3 walnut(vec2 uv) {
  const float streak = tiling_fractal(uv * vec2(2.0f, 36.0f), {2, 36}, 4, 0.65f, 41);
  const vec3 light = srgb(0xb8824c), dark = srgb(0x3d1f10);
  const float depth = glm::clamp(0.22f + 0.75f * wood_rings(uv) + 0.65f * streak, 0.0f, 1.0f);
  return glm::mix(light, dark, depth) * (1.0f - 0.6f * wood_pores(uv));
}

/// Black marble: veins where warped noise crosses zero.
vec3 marble(vec2 uv) {
  const vec2 warp(tiling_fractal(uv * 3.0f, {3, 3}, 5, 0.5f, 51), tiling_fractal(uv * 3.0f, {3, 3}, 5, 0.5f, 52));
  const float thick = std::abs(tiling_fractal((uv + 0.22f * warp) * vec2(2.0f, 3.0f), {2, 3}, 4, 0.5f, 53));
  const float thin = std::abs(tiling_fractal((uv + 0.3f * warp) * vec2(4.0f, 5.0f), {4, 5}, 4, 0.5f, 54));
  const float vein = 0.8f * std::exp(-thick * 48.0f) + 0.35f * std::exp(-thin * 60.0f);
  const float cloud = 0.5f + 0.5f * tiling_fractal(uv * 4.0f, {4, 4}, 4, 0.5f, 55);
  const vec3 stone = glm::mix(srgb(0x0f1412), srgb(0x1f2824), cloud);
  return glm::mix(stone, srgb(0xd9d6cc), glm::clamp(vein, 0.0f, 1.0f));
}

/// Chips of stone in cement.
vec3 terrazzo(vec2 uv) {
  const std::array<vec3, 5> chips{srgb(0xc8553d), srgb(0x5d8aa8), srgb(0xe3b23c), srgb(0x8fa37a), srgb(0xe9e2d4)};
  vec3 color = srgb(0x3a3f45) * (1.0f + 0.15f * tiling_fractal(uv * 48.0f, {48, 48}, 2, 0.5f, 61));
  for (const int cells : {17, 9}) {
    const vec2 bent =
        uv + 0.012f * vec2(tiling_noise(uv * 22.0f, {22, 22}, 62), tiling_noise(uv * 22.0f, {22, 22}, 63));
    const Cells c =
        tiling_cells(bent * static_cast<float>(cells), ivec2(cells), 64 + static_cast<std::uint32_t>(cells));
    const bool chosen = c.cell % 100 < 62;
    if (chosen && c.second - c.nearest > 0.16f && c.nearest < 0.46f) color = chips[(c.cell / 128) % chips.size()];
  }
  return color;
}

/// A test ball: a thick shell with a round window and a slit shows a core; both stand on a turned foot. The shell's
/// axis leans towards `window`, a direction in the ball's space. The foot's underside is at y = 0.
void add_ball(SceneBuilder& builder, const std::string& name, const mat4& place, vec3 window, int shell, int core,
              int foot, int parent) {
  const int root = builder.node(name, -1, place * scaling(kBallRadius), parent);
  const vec3 axis = glm::normalize(window);
  const vec3 side = glm::normalize(glm::cross(axis, vec3(0, 1, 0)));
  const vec3 center(0.0f, 1.21f, 0.0f);
  const mat4 lean(vec4(glm::cross(axis, side), 0.0f), vec4(axis, 0.0f), vec4(side, 0.0f), vec4(center, 1.0f));

  const float slit = radians(72.0f), slit_width = radians(4.5f);
  const Primitive front = lathe(shell_outline(0.87f, 1.0f, radians(37.0f), slit, 0.026f, 36), 192, vec2(2.0f, 1.0f));
  const Primitive rear = lathe(shell_outline(0.87f, 1.0f, slit + slit_width, kPi, 0.026f, 64), 192, vec2(2.0f, 1.0f));
  builder.node(name + " shell", builder.mesh(name + " shell", front, shell), lean, root);
  builder.node(name + " back", builder.mesh(name + " back", rear, shell), lean, root);
  builder.node(name + " core", builder.mesh(name + " core", sphere(0.83f, 64), core), translation(center), root);

  const std::array<OutlineCorner, 8> profile{{{{0.0f, 0.0f}},
                                              {{0.72f, 0.0f}, 0.02f},
                                              {{0.72f, 0.10f}, 0.035f},
                                              {{0.60f, 0.15f}, 0.05f},
                                              {{0.47f, 0.26f}, 0.08f},
                                              {{0.52f, 0.335f}, 0.012f},
                                              {{0.46f, 0.36f}, 0.01f},
                                              {{0.0f, 0.36f}}}};
  builder.node(name + " foot", builder.mesh(name + " foot", lathe(rounded_outline(profile), 192), foot), mat4(1.0f),
               root);
}

int hammered_copper(SceneBuilder& builder) {
  Material material = metal("hammered copper", kCopper, 0.16f);
  material.normal_texture =
      builder.texture("hammered", normal_texture(512, [](vec2 uv) { return hammered(uv, 12); }), vec2(1.0f));
  return builder.material(material);
}

int lacquered_walnut(SceneBuilder& builder) {
  Material material = dielectric("lacquered walnut", vec3(1.0f), 1.0f);
  material.base_color_texture = builder.texture("walnut", color_texture(1024, walnut));
  material.metallic_roughness_texture = builder.texture(
      "walnut gloss", roughness_texture(512, [](vec2 uv) { return vec2(0.16f + 0.35f * wood_pores(uv), 0.0f); }));
  material.normal_texture =
      builder.texture("walnut pores", normal_texture(512, [](vec2 uv) { return -0.00020f * wood_pores(uv); }));
  return builder.material(material);
}

int brushed_brass(SceneBuilder& builder) {
  const auto streaks = [](vec2 uv) { return tiling_fractal(uv * vec2(6.0f, 160.0f), {6, 160}, 3, 0.7f, 71); };
  Material material = metal("brushed brass", kBrass, 1.0f);
  material.normal_texture =
      builder.texture("brushed", normal_texture(512, [&](vec2 uv) { return 0.00045f * streaks(uv); }));
  material.metallic_roughness_texture = builder.texture(
      "brushed gloss", roughness_texture(512, [&](vec2 uv) { return vec2(0.27f + 0.08f * streaks(uv), 1.0f); }));
  return builder.material(material);
}

void add_lamp(SceneBuilder& builder, vec3 place, int foot, int parent) {
  const int root = builder.node("lamp", -1, translation(place), parent);
  Material shade = dielectric("perforated shade", srgb(0x23282c), 0.35f);
  shade.alpha_mode = AlphaMode::mask;
  shade.double_sided = true;
  shade.base_color_texture =
      builder.texture("perforation", cutout_texture(1024, [](vec2 uv) {
                        // Rows of round holes, every other row shifted; the rims at top and bottom stay whole.
                        const float rows = 14.0f, columns = 44.0f;
                        const float row = std::floor(uv.y * rows);
                        const float shift = std::fmod(row, 2.0f) * 0.5f;
                        const vec2 cell(uv.x * columns + shift, uv.y * rows);
                        const vec2 offset = cell - glm::floor(cell) - 0.5f;
                        const float size = 0.36f - 0.16f * std::abs(uv.y - 0.5f) * 2.0f;
                        const bool rim = uv.y < 1.0f / rows || uv.y > 1.0f - 1.0f / rows;
                        const float inside = rim ? 1.0f : smoothstep(size - 0.05f, size + 0.05f, glm::length(offset));
                        return vec4(vec3(1.0f), inside);
                      }));
  const std::array<OutlineCorner, 2> cone{{{{0.052f, 0.062f}}, {{0.034f, 0.150f}}}};
  builder.node("lamp shade", builder.mesh("lamp shade", lathe(rounded_outline(cone), 192), builder.material(shade)),
               mat4(1.0f), root);

  Material glow = dielectric("frosted tube", srgb(0xfff0dc), 0.6f);
  glow.emission = vec3(1.0f, 0.52f, 0.19f) * 3.0f;
  const std::array<OutlineCorner, 4> tube{
      {{{0.0f, 0.070f}}, {{0.022f, 0.070f}, 0.008f}, {{0.022f, 0.145f}, 0.012f}, {{0.0f, 0.145f}}}};
  builder.node("lamp tube", builder.mesh("lamp tube", lathe(rounded_outline(tube), 32), builder.material(glow)),
               mat4(1.0f), root);

  const std::array<OutlineCorner, 7> stand{{{{0.0f, 0.0f}},
                                            {{0.042f, 0.0f}, 0.002f},
                                            {{0.042f, 0.007f}, 0.003f},
                                            {{0.0050f, 0.014f}, 0.012f},
                                            {{0.0042f, 0.060f}, 0.004f},
                                            {{0.0120f, 0.070f}, 0.003f},
                                            {{0.0f, 0.070f}}}};
  builder.node("lamp stand", builder.mesh("lamp stand", lathe(rounded_outline(stand), 96), foot), mat4(1.0f), root);
}

void add_cubes(SceneBuilder& builder, vec3 place, int parent) {
  Material stone = dielectric("terrazzo", vec3(1.0f), 0.22f);
  stone.base_color_texture = builder.texture("terrazzo", color_texture(512, terrazzo));
  Material white = dielectric("marble", vec3(1.0f), 0.2f);
  white.base_color_texture = builder.texture("marble", color_texture(512, marble));
  Material clay = dielectric("clay", srgb(0xb5533c), 0.9f);
  clay.normal_texture = builder.texture("clay grain", normal_texture(512, [](vec2 uv) {
                                          return 0.0016f * tiling_fractal(uv * 60.0f, {60, 60}, 3, 0.6f, 81);
                                        }));
  struct Cube {
    Material material;
    float half;
    float turn_deg;
    vec2 shift;
  };
  const std::array<Cube, 3> cubes{{{std::move(stone), 0.034f, 24.0f, {0.0f, 0.0f}},
                                   {std::move(clay), 0.026f, -14.0f, {-0.004f, 0.002f}},
                                   {std::move(white), 0.019f, 52.0f, {0.003f, 0.001f}}}};
  float height = place.y;
  for (const Cube& cube : cubes) {
    const vec3 center(place.x + cube.shift.x, height + cube.half, place.z + cube.shift.y);
    const Primitive shape = rounded_box(vec3(cube.half), 0.0028f);
    builder.node(cube.material.name + " cube",
                 builder.mesh(cube.material.name + " cube", shape, builder.material(cube.material)),
                 translation(center) * rotation_y(cube.turn_deg), parent);
    height += 2.0f * cube.half;
  }
}

void add_marbles(SceneBuilder& builder, int parent) {
  struct Marble {
    Material material;
    vec2 place;
    float radius;
  };
  const std::array<Marble, 6> marbles{{{dielectric("red glaze", srgb(0xb3121d), 0.05f), {-0.062f, 0.088f}, 0.0130f},
                                       {metal("silver", kSilver, 0.03f), {0.058f, 0.098f}, 0.0150f},
                                       {dielectric("ivory glaze", srgb(0xefe6d2), 0.08f), {0.094f, 0.072f}, 0.0095f},
                                       {metal("satin gold", kGold, 0.22f), {-0.034f, 0.108f}, 0.0090f},
                                       {dielectric("black glaze", srgb(0x0c0c0e), 0.04f), {-0.172f, 0.070f}, 0.0140f},
                                       {dielectric("saffron", srgb(0xe0941b), 0.35f), {0.163f, 0.075f}, 0.0120f}}};
  for (const Marble& m : marbles)
    builder.node(m.material.name + " marble",
                 builder.mesh(m.material.name + " marble", sphere(m.radius, 64), builder.material(m.material)),
                 translation(vec3(m.place.x, m.radius, m.place.y)), parent);
}

}  // namespace

Scene make_materials() {
  SceneBuilder builder("materials");
  // The studio's lamps stand around a camera at azimuth 35°.
  const int root = builder.node("still life", -1, rotation_y(35.0f));

  Material table = dielectric("polished slate", srgb(0x2b343b), 0.06f);
  builder.node("backdrop",
               builder.mesh("backdrop", quad(vec3(-4.0f, 0.0f, 1.0f), vec3(8.0f, 0.0f, 0.0f), vec3(0.0f, 0.0f, -9.0f)),
                            builder.material(table)),
               mat4(1.0f), root);

  const int porcelain = builder.material(dielectric("petrol glaze", srgb(0x0e6576), 0.07f));
  const int gold = builder.material(metal("gold", kGold, 0.12f));
  const int steel = builder.material(metal("satin steel", kSteel, 0.3f));
  const int black = builder.material(dielectric("black lacquer", srgb(0x141416), 0.18f));
  const int ivory = builder.material(dielectric("ivory", srgb(0xdfd5c2), 0.22f));
  const int copper = hammered_copper(builder);
  const int walnut_wood = lacquered_walnut(builder);
  const int brass = brushed_brass(builder);

  add_ball(builder, "centre ball", translation(vec3(0.0f, 0.0f, 0.035f)) * scaling(1.12f), vec3(0.45f, 0.55f, 1.0f),
           porcelain, gold, steel, root);
  add_ball(builder, "left ball", translation(vec3(-0.135f, 0.0f, -0.02f)), vec3(0.75f, 0.6f, 0.8f), copper, black,
           steel, root);
  add_ball(builder, "right ball", translation(vec3(0.135f, 0.0f, -0.02f)), vec3(-0.55f, 0.65f, 0.9f), walnut_wood,
           ivory, brass, root);

  const Primitive knot = torus_knot(2, 3, 0.034f, 0.0148f, 0.0084f, 720, 48, vec2(14.0f, 1.0f));
  const vec3 knot_place(-0.062f, 0.0f, -0.165f);
  builder.node("knot", builder.mesh("knot", knot, brass),
               translation(knot_place + vec3(0.0f, 0.122f, 0.0f)) * rotation_y(18.0f) * rotation_z(30.0f), root);
  const std::array<OutlineCorner, 4> drum{
      {{{0.0f, 0.0f}}, {{0.040f, 0.0f}, 0.002f}, {{0.040f, 0.066f}, 0.003f}, {{0.0f, 0.066f}}}};
  builder.node("plinth", builder.mesh("plinth", lathe(rounded_outline(drum), 128), black), translation(knot_place),
               root);
  add_cubes(builder, vec3(-0.225f, 0.0f, -0.13f), root);
  add_lamp(builder, vec3(0.212f, 0.0f, -0.125f), steel, root);
  add_marbles(builder, root);

  builder.camera(vec3(0.0f, 0.245f, 0.78f), vec3(0.0f, 0.070f, -0.02f), 20.5f, 16.0f / 9.0f, root, 8.0f,
                 vec3(0.0f, 0.06f, 0.075f));
  return builder.finish("studio", 1.25f);
}

}  // namespace candela::content
