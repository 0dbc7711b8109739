#include <algorithm>
#include <array>
#include <span>

#include "base/check.h"
#include "content/demo_scenes.h"
#include "scene/metals.h"

// The rows of docs/materials: seven test balls, on which one parameter goes from its least to its greatest.
namespace candela::content {
namespace {

constexpr int kBalls = 7;
constexpr float kRadius = 0.05f;
constexpr float kSpacing = 2.32f * kRadius;

/// What stands in the row.
enum class Shape {
  cap,    ///< a thick cap of the material over a grey core on a foot
  ball,   ///< solid
  cored,  ///< solid, with a white core
  lamp    ///< hollow, with a small lamp inside
};

/// One of kBalls equal steps from `least` to `most`.
float step(int i, float least, float most) {
  return glm::mix(least, most, static_cast<float>(i) / static_cast<float>(kBalls - 1));
}
using Values = std::array<float, kBalls>;
float value(const Values& values, int i) { return values[static_cast<std::size_t>(i)]; }

Material dielectric(std::uint32_t hex, float roughness) {
  Material material;
  material.base_color = srgb(hex);
  material.metallic = 0.0f;
  material.roughness = roughness;
  return material;
}

Material metal(vec3 color, float roughness) {
  Material material;
  material.base_color = color;
  material.roughness = roughness;
  return material;
}

// F0 as linear Rec.709; gold's red is held at 1.
const vec3 kGold(1.0f, 0.782f, 0.344f);
const vec3 kSteel(0.562f, 0.565f, 0.578f);

/// A body of glass.
Material glass(float roughness = 0.0f) {
  Material material = dielectric(0xffffff, roughness);
  material.transmission = 1.0f;
  material.thickness = 2.0f;  // of the unit sphere that is scaled to kRadius
  return material;
}

/// A body full of matter that scatters, below a boundary that lets light in diffusely.
Material wax(float mean_free_path) {
  Material material = dielectric(0xffffff, 0.25f);
  material.ior = 1.4f;
  material.diffuse_transmission = 1.0f;
  material.thickness = 2.0f;
  // σt = -ln(1/e) / distance: the distance is the mean free path.
  material.attenuation_color = vec3(0.36787944f);
  material.attenuation_distance = mean_free_path;
  material.multiscatter_color = vec3(0.93f, 0.62f, 0.42f);
  return material;
}

/// A metal below an oxide.
Material film(float thickness_nm, float ior) {
  Material material = metal(kSteel, 0.12f);
  material.iridescence = 1.0f;
  material.iridescence_thickness_max_nm = thickness_nm;
  material.iridescence_ior = ior;
  return material;
}

Material cloth(vec3 color, float roughness) {
  Material material = dielectric(0x30101c, 0.9f);
  material.sheen_color = color;
  material.sheen_roughness = roughness;
  return material;
}

Material coated(float weight, float roughness) {
  Material material = dielectric(0xa01418, 0.55f);
  material.clearcoat = weight;
  material.clearcoat_roughness = roughness;
  return material;
}

/// A measured metal by name.
Material measured(std::string_view name, float roughness) {
  const Metal* found = find_metal(name);
  CANDELA_CHECK(found != nullptr);
  Material material = metal(vec3(1.0f), roughness);
  material.conductor_n = found->n;
  material.conductor_k = found->k;
  return material;
}

/// KHR_materials_pbrSpecularGlossiness: from a matte blue plastic to a gilt mirror by way of what the other workflow
/// cannot say, a coloured reflection over a diffuse layer of another hue.
Material specular_glossiness(float t) {
  Material material = dielectric(0x2a5db0, 1.0f - t);
  material.specular_glossiness = true;
  material.ior = 0.0f;
  material.specular_color = glm::mix(vec3(0.04f), kGold, t);
  return material;
}

/// The lobes beside each other, for the README.
Material showcase(int i) {
  switch (i) {
    case 0:
      return measured("gold", 0.14f);
    case 1: {
      Material material = metal(kSteel, 0.22f);
      material.anisotropy = 0.85f;
      return material;
    }
    case 2:
      return film(380.0f, 1.9f);
    case 3: {
      Material material = coated(1.0f, 0.0f);
      material.metallic = 0.6f;
      material.roughness = 0.4f;
      return material;
    }
    case 4: {
      Material material = cloth(vec3(0.95f, 0.4f, 0.7f), 0.5f);
      material.base_color = srgb(0x8a2452);
      return material;
    }
    case 5:
      return wax(0.1f * kRadius);
    default: {
      Material material = glass();
      material.attenuation_color = vec3(0.35f, 0.78f, 0.62f);
      material.attenuation_distance = 2.0f * kRadius;
      return material;
    }
  }
}

struct Row {
  const char* name;
  const char* description;
  Shape shape;
  Material (*material)(int ball);
};

Material with(Material material, float Material::*parameter, float value) {
  material.*parameter = value;
  return material;
}

constexpr std::array<std::string_view, kBalls> kRowMetals{"silver", "aluminium", "titanium", "iron",
                                                          "brass",  "copper",    "gold"};
constexpr Values kIors{1.0f, 1.2f, 1.33f, 1.5f, 1.76f, 2.0f, 2.42f};
constexpr Values kDispersions{0.0f, 0.3f, 0.6f, 1.0f, 2.0f, 4.0f, 8.0f};
constexpr Values kAttenuation{16.0f, 8.0f, 4.0f, 2.0f, 1.0f, 0.5f, 0.25f};   // in radii
constexpr Values kFreePaths{2.0f, 0.8f, 0.4f, 0.2f, 0.1f, 0.04f, 0.015f};    // in radii
constexpr Values kEmissions{0.0f, 0.125f, 0.25f, 0.5f, 1.0f, 2.0f, 4.0f};    // cd/m²
constexpr Values kScatterings{-0.9f, -0.6f, -0.3f, 0.0f, 0.3f, 0.6f, 0.9f};  // g

constexpr std::array kRows{
    Row{"row-lobes", "one ball per lobe: gold, brushed, oxide, car paint, velvet, wax, glass", Shape::ball, showcase},
    Row{"row-metallic", "metallic 0 to 1", Shape::cap,
        [](int i) { return with(metal(kGold, 0.25f), &Material::metallic, step(i, 0.0f, 1.0f)); }},
    Row{"row-roughness", "roughness 0 to 1 of a dielectric", Shape::cap,
        [](int i) { return dielectric(0x1f4fa8, step(i, 0.0f, 1.0f)); }},
    Row{"row-roughness-metal", "roughness 0 to 1 of a metal", Shape::cap,
        [](int i) { return metal(kGold, step(i, 0.0f, 1.0f)); }},
    Row{"row-ior", "ior 1 to 2.42 of a black gloss", Shape::cap,
        [](int i) { return with(dielectric(0x101012, 0.06f), &Material::ior, value(kIors, i)); }},
    Row{"row-specular", "specular 0 to 1", Shape::cap,
        [](int i) { return with(dielectric(0x2c6a4f, 0.12f), &Material::specular, step(i, 0.0f, 1.0f)); }},
    Row{"row-clearcoat", "clearcoat 0 to 1", Shape::cap, [](int i) { return coated(step(i, 0.0f, 1.0f), 0.0f); }},
    Row{"row-clearcoat-roughness", "clearcoat roughness 0 to 1", Shape::cap,
        [](int i) { return coated(1.0f, step(i, 0.0f, 1.0f)); }},
    Row{"row-sheen-color", "sheen colour black to white", Shape::cap,
        [](int i) { return cloth(vec3(step(i, 0.0f, 1.0f)), 0.35f); }},
    Row{"row-sheen-roughness", "sheen roughness 0 to 1", Shape::cap,
        [](int i) { return cloth(vec3(0.9f, 0.75f, 0.8f), step(i, 0.0f, 1.0f)); }},
    Row{"row-anisotropy", "anisotropy 0 to 1", Shape::cap,
        [](int i) { return with(metal(kSteel, 0.2f), &Material::anisotropy, step(i, 0.0f, 1.0f)); }},
    Row{"row-anisotropy-rotation", "anisotropy rotation 0 to 180 degrees", Shape::cap,
        [](int i) {
          Material material = with(metal(kSteel, 0.2f), &Material::anisotropy, 0.85f);
          material.anisotropy_rotation = step(i, 0.0f, kPi);
          return material;
        }},
    Row{"row-diffuse-roughness", "diffuse roughness 0 to 1 of clay", Shape::cap,
        [](int i) { return with(dielectric(0xc08a60, 0.7f), &Material::diffuse_roughness, step(i, 0.0f, 1.0f)); }},
    Row{"row-retroreflection", "retroreflection 0 to 1 of a metal", Shape::cap,
        [](int i) { return with(metal(kSteel, 0.25f), &Material::retroreflection, step(i, 0.0f, 1.0f)); }},
    Row{"row-fuzz", "dust on lacquer, 0 to 1", Shape::cap,
        [](int i) {
          Material material = with(coated(1.0f, 0.0f), &Material::fuzz, step(i, 0.0f, 1.0f));
          material.fuzz_color = vec3(0.5f, 0.42f, 0.32f);
          material.fuzz_roughness = 0.9f;
          return material;
        }},
    Row{"row-fuzz-color", "fuzz colour black to white", Shape::cap,
        [](int i) {
          Material material = with(dielectric(0x9a5a64, 0.8f), &Material::fuzz, 1.0f);
          material.fuzz_color = vec3(step(i, 0.0f, 1.0f));
          return material;
        }},
    Row{"row-edge-color", "specular colour of a whole lobe, white to red", Shape::cap,
        [](int i) {
          Material material = with(dielectric(0x14161c, 0.1f), &Material::specular_edge_color, 1.0f);
          material.specular_color = glm::mix(vec3(1.0f), vec3(1.0f, 0.08f, 0.02f), step(i, 0.0f, 1.0f));
          return material;
        }},
    Row{"row-edge-color-metal", "specular colour of a metal near 82 degrees, white to blue", Shape::cap,
        [](int i) {
          Material material = with(metal(kGold, 0.15f), &Material::specular_edge_color, 1.0f);
          material.specular_color = glm::mix(vec3(1.0f), vec3(0.0f, 0.1f, 0.8f), step(i, 0.0f, 1.0f));
          return material;
        }},
    Row{"row-clearcoat-anisotropy", "clearcoat anisotropy 0 to 1", Shape::cap,
        [](int i) { return with(coated(1.0f, 0.25f), &Material::clearcoat_anisotropy, step(i, 0.0f, 1.0f)); }},
    Row{"row-iridescence-thickness", "film thickness 0 to 900 nm", Shape::cap,
        [](int i) { return film(step(i, 0.0f, 900.0f), 1.8f); }},
    Row{"row-iridescence-ior", "film index 1 to 2.5", Shape::cap,
        [](int i) { return film(400.0f, step(i, 1.0f, 2.5f)); }},
    Row{"row-transmission", "transmission 0 to 1 of a body", Shape::ball,
        [](int i) {
          Material material = with(glass(), &Material::transmission, step(i, 0.0f, 1.0f));
          material.base_color = srgb(0x9fd8d0);
          return material;
        }},
    Row{"row-transmission-ior", "ior 1 to 2.42 of a body of glass", Shape::ball,
        [](int i) { return with(glass(), &Material::ior, value(kIors, i)); }},
    Row{"row-transmission-roughness", "roughness 0 to 1 of a body of glass", Shape::ball,
        [](int i) { return glass(step(i, 0.0f, 1.0f)); }},
    Row{"row-thin-transmission", "transmission 0 to 1 of a sheet", Shape::cored,
        [](int i) {
          Material material = with(dielectric(0xd88a4a, 0.05f), &Material::transmission, step(i, 0.0f, 1.0f));
          material.double_sided = true;
          return material;
        }},
    Row{"row-attenuation", "attenuation distance 16 to 1/4 radii", Shape::cored,
        [](int i) {
          Material material = glass();
          material.attenuation_color = vec3(0.85f, 0.55f, 0.18f);
          material.attenuation_distance = value(kAttenuation, i) * kRadius;
          return material;
        }},
    Row{"row-dispersion", "dispersion 0 to 8", Shape::ball,
        [](int i) {
          Material material = with(glass(), &Material::dispersion, value(kDispersions, i));
          material.ior = 1.7f;
          return material;
        }},
    Row{"row-diffuse-transmission", "diffuse transmission 0 to 1 around a lamp", Shape::lamp,
        [](int i) {
          Material material = with(dielectric(0xe8e0d0, 0.5f), &Material::diffuse_transmission, step(i, 0.0f, 1.0f));
          material.diffuse_transmission_color = srgb(0xe8c89a);
          material.double_sided = true;
          return material;
        }},
    Row{"row-subsurface", "mean free path 2 to 0.015 radii of a body that scatters", Shape::ball,
        [](int i) { return wax(value(kFreePaths, i) * kRadius); }},
    Row{"row-scatter-anisotropy", "scattering backwards (-0.9) to forwards (0.9)", Shape::ball,
        [](int i) { return with(wax(0.35f * kRadius), &Material::scatter_anisotropy, value(kScatterings, i)); }},
    Row{"row-emission", "emission 0 to 4 cd/m²", Shape::cap,
        [](int i) {
          Material material = dielectric(0x303030, 0.4f);
          material.emission = vec3(1.0f, 0.55f, 0.25f) * value(kEmissions, i);
          return material;
        }},
    Row{"row-conductor", "measured metals: silver aluminium titanium iron brass copper gold", Shape::cap,
        [](int i) { return measured(kRowMetals[static_cast<std::size_t>(i)], 0.18f); }},
    Row{"row-specular-glossiness", "specular and glossiness 0 to 1 over a blue diffuse layer", Shape::cap,
        [](int i) { return specular_glossiness(step(i, 0.0f, 1.0f)); }}};

/// Grey squares, a radius wide.
void add_ground(SceneBuilder& builder, int parent) {
  constexpr float kSize = 8.0f;
  Material ground = dielectric(0xffffff, 0.7f);
  ground.name = "checker";
  const auto checker = [](vec2 uv) { return (uv.x < 0.5f) == (uv.y < 0.5f) ? srgb(0x8a8a8a) : srgb(0x5c5c5c); };
  ground.base_color_texture = builder.texture("checker", color_texture(256, checker), vec2(0.5f * kSize / kRadius));
  const Primitive plane =
      quad(vec3(-0.5f * kSize, 0.0f, 0.5f * kSize), vec3(kSize, 0.0f, 0.0f), vec3(0.0f, 0.0f, -kSize));
  builder.node("backdrop", builder.mesh("backdrop", plane, builder.material(ground)), mat4(1.0f), parent);
}

/// Adds the grey parts, and the ball itself of `material`; it stands at y = 0.
void add_ball(SceneBuilder& builder, Shape shape, int material, const std::string& name, vec3 place, int parent) {
  const int root = builder.node(name, -1, translation(place) * scaling(kRadius), parent);
  const auto add = [&](const std::string& part, const Primitive& primitive, int of, const mat4& at) {
    builder.node(name + part, builder.mesh(name + part, primitive, of), at, root);
  };
  const auto paint = [&](std::uint32_t hex) {
    Material grey = dielectric(hex, 0.5f);
    grey.name = name + " core";
    return builder.material(grey);
  };
  if (shape != Shape::cap) {
    const mat4 center = translation(vec3(0.0f, 1.0f, 0.0f));
    add("", sphere(1.0f, 64), material, center);
    if (shape == Shape::cored) add(" core", sphere(0.4f, 32), paint(0xf0f0f0), center);
    if (shape == Shape::lamp) {
      Material lamp = dielectric(0xffffff, 1.0f);
      lamp.name = name + " lamp";
      lamp.emission = vec3(5.0f, 4.3f, 3.6f);
      add(" lamp", sphere(0.3f, 24), builder.material(lamp), center);
    }
    return;
  }
  const int grey = paint(0x6a6a6a);
  const mat4 center = translation(vec3(0.0f, 1.02f, 0.0f));
  // A shell is closed at its lower pole; here that is the top.
  const Primitive cap = lathe(shell_outline(0.90f, 1.0f, radians(58.0f), kPi, 0.03f, 40), 96);
  add("", cap, material, center * rotation_x(180.0f));
  add(" core", sphere(0.87f, 32), grey, center);
  const std::array<OutlineCorner, 4> drum{
      {{{0.0f, 0.0f}}, {{0.66f, 0.0f}, 0.02f}, {{0.66f, 0.22f}, 0.05f}, {{0.0f, 0.22f}}}};
  add(" foot", lathe(rounded_outline(drum), 64), grey, mat4(1.0f));
}

Scene make_row(const Row& row) {
  SceneBuilder builder(row.name);
  // The studio's lamps stand around a camera at azimuth 35°.
  const int root = builder.node("row", -1, rotation_y(35.0f));
  add_ground(builder, root);
  for (int i = 0; i < kBalls; ++i) {
    Material material = row.material(i);
    material.name = "ball " + std::to_string(i);
    const vec3 place((static_cast<float>(i) - 0.5f * (kBalls - 1)) * kSpacing, 0.0f, 0.0f);
    add_ball(builder, row.shape, builder.material(material), material.name, place, root);
  }
  // From far, so that all balls are seen from the same side.
  constexpr float kDistance = 46.0f * kRadius;
  const vec3 target(0.0f, 0.96f * kRadius, 0.0f);
  const float elevation = radians(13.0f);
  builder.camera(target + kDistance * vec3(0.0f, std::sin(elevation), std::cos(elevation)), target, 3.41f,
                 1200.0f / 200.0f, root);
  return builder.finish("studio", 1.0f);
}

}  // namespace

std::vector<DemoInfo> row_demos() {
  std::vector<DemoInfo> list;
  list.reserve(std::size(kRows));
  for (const Row& row : kRows) list.push_back({row.name, row.description});
  return list;
}

std::optional<Scene> make_row(const std::string& name) {
  const auto found = std::find_if(kRows.begin(), kRows.end(), [&](const Row& row) { return name == row.name; });
  if (found == kRows.end()) return std::nullopt;
  return make_row(*found);
}

}  // namespace candela::content
