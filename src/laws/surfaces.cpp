#include "laws/surfaces.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <sstream>

#include "scene/metals.h"

namespace candela::laws {

namespace {

using shade::SurfaceParams;
using shade::vec2;
using shade::vec3;

constexpr std::array<float, 5> kRoughnesses = {0.0f, 0.1f, 0.3f, 0.6f, 1.0f};

class Table {
 public:
  /// One row for each roughness.
  void add(const std::string& group, const SurfaceParams& params, const Promise& promise, bool is_core,
           const std::vector<float>& roughnesses = {kRoughnesses.begin(), kRoughnesses.end()}) {
    for (const float roughness : roughnesses) {
      std::ostringstream name;
      name << group << ", roughness " << roughness;
      NamedSurface row{name.str(), group, params, promise, is_core};
      row.params.roughness = roughness;
      rows_.push_back(std::move(row));
    }
  }

  std::vector<NamedSurface> rows() && { return std::move(rows_); }

 private:
  std::vector<NamedSurface> rows_;
};

SurfaceParams white(float metallic) {
  SurfaceParams p = shade::surface_params_default();
  p.metallic = metallic;
  return p;
}

std::string number(float x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

// ----- what a lobe is where it is alone or among others

void with_coat(SurfaceParams& p, float roughness) {
  p.lobes |= shade::kLobeClearcoat;
  p.clearcoat = 1.0f;
  p.clearcoat_roughness = roughness;
}

void with_sheen(SurfaceParams& p, float roughness) {
  p.lobes |= shade::kLobeSheen;
  p.sheen_color = vec3(1.0f);
  p.sheen_roughness = roughness;
}

void with_fuzz(SurfaceParams& p, float roughness) {
  p.lobes |= shade::kLobeFuzz;
  p.fuzz = 1.0f;
  p.fuzz_roughness = roughness;
}

void with_anisotropy(SurfaceParams& p) {
  p.lobes |= shade::kLobeAnisotropy;
  p.anisotropy = 0.7f;
}

void with_film(SurfaceParams& p) {
  p.lobes |= shade::kLobeIridescence;
  p.iridescence = 1.0f;
}

void with_diffuse_roughness(SurfaceParams& p, float roughness) {
  p.lobes |= shade::kLobeDiffuseRoughness;
  p.diffuse_roughness = roughness;
}

// A metal that absorbs less than half a thousandth.
void with_conductor(SurfaceParams& p) {
  p.lobes |= shade::kLobeConductor;
  p.conductor_n = vec3(1e-3f);
  p.conductor_k = vec3(3.0f);
}

void with_diffuse_transmission(SurfaceParams& p) {
  p.lobes |= shade::kLobeDiffuseTransmission;
  p.diffuse_transmission = 0.5f;
}

enum class Glass { none, thin, outside, inside };
constexpr std::array<Glass, 4> kGlasses = {Glass::none, Glass::thin, Glass::outside, Glass::inside};
constexpr std::array<const char*, 4> kGlassNames = {"dielectric", "thin glass", "glass from outside",
                                                    "glass from inside"};

void with_glass(SurfaceParams& p, Glass glass, float ior = 1.5f) {
  if (glass == Glass::none) return;
  p.lobes |= shade::kLobeTransmission;
  p.transmission = 1.0f;
  p.ior = ior;
  p.is_thin = glass == Glass::thin;
  p.eta = glass == Glass::inside ? 1.0f / ior : ior;
}

// ----- one lobe at a time

void add_plain(Table& table) {
  struct Look {
    const char* name;
    float ior;
    float specular;
    vec3 specular_color;
    vec3 base_color;
  };
  const vec3 one(1.0f);
  const vec3 ochre(0.8f, 0.5f, 0.2f);
  const vec3 red(1.0f, 0.2f, 0.1f);
  const std::array<Look, 12> looks = {{
      {"white", 1.5f, 1.0f, one, one},
      {"water", 1.33f, 1.0f, one, one},
      {"diamond", 2.42f, 1.0f, one, one},
      {"matched ior", 1.0f, 1.0f, one, one},
      {"no specular", 1.5f, 0.0f, one, one},
      {"half specular", 1.5f, 0.5f, one, one},
      {"ochre", 1.5f, 1.0f, one, ochre},
      {"black", 1.5f, 1.0f, one, vec3(0.0f)},
      {"ior 0", 0.0f, 1.0f, one, ochre},
      {"red specular", 1.5f, 1.0f, red, one},
      {"red half specular diamond", 2.42f, 0.5f, red, ochre},
      {"black without specular", 1.5f, 0.0f, one, vec3(0.0f)},
  }};
  for (const float metallic : {0.0f, 0.5f, 1.0f}) {
    for (const Look& look : looks) {
      SurfaceParams p = white(metallic);
      p.base_color = look.base_color;
      p.ior = look.ior;
      p.specular = look.specular;
      p.specular_color = look.specular_color;
      Promise promise;
      promise.is_white = look.base_color == one && look.specular_color == one;
      table.add(std::string("plain ") + look.name + ", metallic " + number(metallic), p, promise, true,
                {0.0f, 0.05f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f});
    }
  }
}

void add_layers(Table& table) {
  for (const float metallic : {0.0f, 1.0f}) {
    const std::string matter = metallic > 0.0f ? " on metal" : " on dielectric";
    for (const float roughness : {0.0f, 0.1f, 0.2f, 0.5f, 1.0f}) {
      SurfaceParams p = white(metallic);
      with_coat(p, roughness);
      table.add("coat of roughness " + number(roughness) + matter, p, {}, true);
    }
    for (const float roughness : {0.0f, 0.2f, 0.5f, 1.0f}) {
      SurfaceParams p = white(metallic);
      with_sheen(p, roughness);
      table.add("sheen of roughness " + number(roughness) + matter, p, {}, true);
    }
    SurfaceParams tilted = white(metallic);
    with_coat(tilted, 0.2f);
    tilted.clearcoat_normal = glm::normalize(vec3(0.2f, -0.1f, 1.0f));
    Promise promise;
    promise.is_reciprocal = false;  // each normal brings its own cosine
    promise.is_white = false;       // and its own hemisphere
    table.add("coat with a normal of its own" + matter, tilted, promise, true);
  }
}

void add_matter(Table& table) {
  for (const float ior : {1.1f, 1.5f, 2.42f}) {
    for (std::size_t i = 1; i < kGlasses.size(); ++i) {
      SurfaceParams p = white(0.0f);
      with_glass(p, kGlasses[i], ior);
      table.add(std::string(kGlassNames[i]) + " of index " + number(ior), p, {}, true);
    }
  }
  // The table over two widths, azimuth and cosine is coarse: a little more than half a percent.
  for (const float strength : {0.3f, 1.0f}) {
    SurfaceParams p = white(1.0f);
    with_anisotropy(p);
    p.anisotropy = strength;
    table.add("anisotropic metal, strength " + number(strength), p, {true, true, 0.006, 0.007}, true,
              {0.1f, 0.2f, 0.3f, 0.6f, 1.0f});
  }
  SurfaceParams anisotropic = white(0.0f);
  with_anisotropy(anisotropic);
  table.add("anisotropic dielectric", anisotropic, {true, true, 0.006, 0.007}, true, {0.1f, 0.2f, 0.3f, 0.6f, 1.0f});
  for (const float share : {0.5f, 1.0f}) {
    SurfaceParams p = white(0.0f);
    with_diffuse_transmission(p);
    p.diffuse_transmission = share;
    table.add("diffuse transmission " + number(share), p, {}, true);
  }
  for (const float share : {0.5f, 1.0f}) {
    for (const float forward : {0.0f, 0.25f, 1.0f}) {
      SurfaceParams p = white(0.0f);
      with_glass(p, Glass::thin);
      p.lobes |= shade::kLobeDiffuseTransmission;
      p.scatter = share;
      p.scatter_anisotropy = 2.0f * forward - 1.0f;
      table.add("thin glass that scatters " + number(share) + ", forwards " + number(forward), p, {}, true);
    }
  }
  for (const float thickness_nm : {150.0f, 400.0f, 1000.0f}) {
    for (const float metallic : {0.0f, 1.0f}) {
      SurfaceParams p = white(metallic);
      with_film(p);
      p.film_nm = thickness_nm;
      table.add("film of " + number(thickness_nm) + " nm on " + (metallic > 0.0f ? "metal" : "dielectric"), p, {},
                true);
    }
  }
  SurfaceParams ideal = white(1.0f);
  with_conductor(ideal);
  table.add("ideal conductor", ideal, {}, true);
  for (const char* name : {"gold", "aluminium"}) {
    const Metal* metal = find_metal(name);
    SurfaceParams p = white(1.0f);
    p.lobes = shade::kLobeConductor;
    p.conductor_n = metal->n;
    p.conductor_k = metal->k;
    table.add(name, p, {true, false, 1.0, 0.005}, true);
  }
}

// ----- all at once

void add_combinations(Table& table) {
  for (int bits = 0; bits < 32; ++bits) {
    for (std::size_t g = 0; g < 5; ++g) {
      const bool is_metal = g == 4;
      const bool has_coat = (bits & 1) != 0;
      const bool has_sheen = (bits & 2) != 0;
      const bool has_anisotropy = (bits & 4) != 0;
      const bool has_film = (bits & 8) != 0;
      const bool has_fifth = (bits & 16) != 0;  // of metal: measured; of the rest: diffuse transmission
      const bool has_glass = g >= 1 && g <= 3;
      const int lobes = (has_coat ? 1 : 0) + (has_sheen ? 1 : 0) + (has_anisotropy ? 1 : 0) + (has_film ? 1 : 0) +
                        (has_fifth ? 1 : 0) + (has_glass ? 1 : 0);
      if (lobes < 2) continue;
      SurfaceParams p = white(is_metal ? 1.0f : 0.0f);
      std::string name = is_metal ? "metal" : kGlassNames[g];
      if (has_glass) with_glass(p, kGlasses[g]);
      if (has_fifth && is_metal) with_conductor(p);
      if (has_fifth && !is_metal) with_diffuse_transmission(p);
      if (has_fifth && has_glass) p.transmission = 0.5f;
      if (has_anisotropy) with_anisotropy(p);
      if (has_film) with_film(p);
      if (has_sheen) with_sheen(p, 0.4f);
      if (has_coat) with_coat(p, 0.1f);
      if (has_fifth) name += is_metal ? " by n + ik" : " + diffuse transmission";
      if (has_anisotropy) name += " + anisotropy";
      if (has_film) name += " + film";
      if (has_sheen) name += " + sheen";
      if (has_coat) name += " + coat";
      // A streak as thin as a mirror's and as wide as a diffuse lobe is beyond quadrature, and beyond sight.
      // Two at a time and more: the factors of each are exact alone, and their product is not. Streaks on bodies are
      // known to the tables by a round lobe.
      Promise promise{true, true, 0.02, 0.015};
      // Seen from within, what a layer on a body would send back is lost.
      if ((has_sheen || has_coat) && has_glass && !p.is_thin) promise.loss = 0.055;
      if (has_sheen && has_coat) promise.loss = 0.085;
      // What rough glass loses is found without its film.
      if (has_film && has_glass && !p.is_thin) promise.gain = 0.03;
      if (has_anisotropy) promise.gain = std::max(promise.gain, 0.03);
      if (has_anisotropy) promise.loss = std::max(promise.loss, 0.08);
      if (has_anisotropy && has_glass) promise.gain = std::max(promise.gain, 0.075);
      if (has_anisotropy && has_glass) promise.loss = 0.16;
      table.add(name, p, promise, false, {has_anisotropy ? 0.1f : 0.0f, 0.3f, 1.0f});
    }
  }
}

/// Every weight somewhere in its middle, and colours: materials as files have them.
void add_mixtures(Table& table) {
  std::uint32_t state = 12345;
  const auto next = [&state] {  // Numerical Recipes' generator is enough to vary materials
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) * 0x1p-24f;
  };
  const auto color = [&next] {
    const float r = next();
    const float g = next();
    return vec3(r, g, next());
  };
  for (int i = 0; i < 24; ++i) {
    SurfaceParams p = white(i % 3 == 0 ? 0.0f : 0.7f * next());
    p.base_color = color();
    p.specular = next();
    p.specular_color = color();
    p.ior = 1.05f + next();
    if (i % 2 == 0) with_coat(p, next());
    p.clearcoat *= next();
    if (i % 3 == 1) with_sheen(p, next());
    p.sheen_color *= color();
    if (i % 4 >= 2) with_anisotropy(p);
    p.anisotropy *= next();
    if (i % 5 == 2) with_film(p);
    p.iridescence *= next();
    p.film_nm = 100.0f + 900.0f * next();
    if (i % 6 >= 3) with_glass(p, kGlasses[static_cast<std::size_t>(1 + i % 3)], p.ior);
    p.transmission *= next();
    if (i % 7 >= 4) with_diffuse_transmission(p);
    p.diffuse_transmission *= next();
    p.diffuse_transmission_color = color();
    table.add("mixture " + std::to_string(i), p, {true, false, 1.0, 0.015}, i < 12, {0.02f + 0.98f * next()});
  }
}

/// What engines and texts use, and what a specification prints: exempt where their formulas break the laws.
void add_models(Table& table) {
  struct Model {
    const char* name;
    shade::ShadingModel model;
    std::array<vec2, 2> loss_and_gain;  // of the dielectric and of the metal
  };
  const std::array<Model, 5> models = {
      {{"gltf", shade::shading_model_gltf(), {vec2(0.03f, 0.73f), vec2(0.7f, 0.005f)}},
       {"ue4", shade::shading_model_ue4(), {vec2(0.005f, 0.8f), vec2(0.93f, 0.005f)}},
       {"learnopengl", shade::shading_model_learnopengl(), {vec2(0.03f, 0.73f), vec2(0.93f, 0.005f)}},
       {"thesis", shade::shading_model_thesis(), {vec2(0.71f, 0.005f), vec2(0.545f, 0.005f)}},
       {"blinn-phong", shade::shading_model_blinn_phong(), {vec2(0.005f, 0.79f), vec2(1.0f, 0.005f)}}}};
  const auto exempt = [](bool is_reciprocal, vec2 loss_and_gain) {
    return Promise{is_reciprocal, true, static_cast<double>(loss_and_gain.x), static_cast<double>(loss_and_gain.y),
                   true};
  };
  for (const Model& model : models) {
    for (const bool is_metal : {false, true}) {
      const float metallic = is_metal ? 1.0f : 0.0f;
      SurfaceParams p = white(metallic);
      p.lobes = shade::kLobeModel;
      p.model = model.model;
      // Half-vector and sum are reciprocal; the view-dependent blend and layers are not.
      const bool is_reciprocal = model.model.blend != shade::kBlendView || is_metal;
      table.add(std::string("model ") + model.name + ", metallic " + number(metallic), p,
                exempt(is_reciprocal, model.loss_and_gain[is_metal ? 1 : 0]), true);
      if (std::string(model.name) != "gltf") continue;
      SurfaceParams coated = p;
      with_coat(coated, 0.1f);
      table.add("model gltf + coat, metallic " + number(metallic), coated,
                exempt(false, is_metal ? vec2(0.67f, 0.005f) : vec2(0.045f, 0.13f)), true);
      SurfaceParams sheened = p;
      with_sheen(sheened, 0.4f);
      table.add("model gltf + sheen, metallic " + number(metallic), sheened,
                exempt(false, is_metal ? vec2(0.69f, 0.005f) : vec2(0.03f, 0.245f)), true);
    }
  }

  // The default with other curves of reflectance keeps every law.
  for (const bool is_f82 : {false, true}) {
    for (const float metallic : {0.0f, 1.0f}) {
      SurfaceParams p = white(metallic);
      p.lobes = shade::kLobeModel;
      p.model.fresnel = is_f82 ? shade::kFresnelF82 : shade::kFresnelSchlick;
      const std::string name = std::string("model candela by ") + (is_f82 ? "F82" : "Schlick");
      table.add(name + ", metallic " + number(metallic), p, {}, true);
      with_coat(p, 0.2f);
      // What a coat leaves of the lobe below is tabulated for the exact curve.
      table.add(name + " + coat, metallic " + number(metallic), p, {true, true, 0.015, 0.015}, true);
    }
  }
}

/// The drafts that add to KHR_materials_clearcoat.
void add_coats(Table& table) {
  for (const float metallic : {0.0f, 1.0f}) {
    const std::string matter = metallic > 0.0f ? " on metal" : " on dielectric";
    for (const float ior : {1.1f, 1.2f, 2.0f}) {
      SurfaceParams p = white(metallic);
      with_coat(p, 0.2f);
      p.clearcoat_ior = ior;
      // What a coat leaves of the lobe below is tabulated for 1.5.
      table.add("coat of index " + number(ior) + matter, p, {true, true, 0.03, 0.0125}, true);
    }
    SurfaceParams red = white(metallic);
    with_coat(red, 0.1f);
    red.clearcoat_color = vec3(0.9f, 0.3f, 0.2f);
    red.clearcoat_ior = 1.7f;
    table.add("red coat" + matter, red, {true, false, 1.0, 0.0125}, true);
    SurfaceParams dark = white(metallic);
    with_coat(dark, 0.1f);
    dark.clearcoat_darkening = 1.0f;
    table.add("coat that darkens white" + matter, dark, {}, true);
    for (const float strength : {0.5f, 1.0f}) {
      SurfaceParams streaked = white(metallic);
      with_coat(streaked, 0.3f);
      streaked.lobes |= shade::kLobeCoatAnisotropy;
      streaked.clearcoat_anisotropy = strength;
      streaked.clearcoat_direction = vec3(0.6f, 0.8f, 0.0f);
      table.add("coat of anisotropy " + number(strength) + matter, streaked, {true, true, 0.005, 0.0175}, true);
    }
    dark.base_color = vec3(0.5f, 0.2f, 0.1f);
    table.add("coat that darkens" + matter, dark, {true, false, 1.0, 0.005}, true);
  }
}

/// EXT_materials_specular_edge_color.
void add_edge_colors(Table& table) {
  for (const float metallic : {0.0f, 0.5f, 1.0f}) {
    const std::string name = "edge color, metallic " + number(metallic);
    SurfaceParams p = white(metallic);
    p.lobes = shade::kLobeEdgeColor;
    table.add("white " + name, p, {}, true);
    p.specular_color = vec3(1.0f, 0.3f, 0.0f);
    p.base_color = vec3(0.9f, 0.8f, 0.5f);
    table.add("red " + name, p, {true, false, 1.0, 0.005}, true);
    p.specular_color = vec3(4.0f, 1.0f, 0.5f);
    p.ior = 1.8f;
    table.add("bright " + name, p, {true, false, 1.0, 0.005}, true);
    with_coat(p, 0.2f);
    table.add("coated " + name, p, {true, false, 1.0, 0.015}, false);
  }
  SurfaceParams glass = white(0.0f);
  with_glass(glass, Glass::outside);
  glass.lobes |= shade::kLobeEdgeColor;
  glass.specular_color = vec3(1.0f, 0.3f, 0.0f);
  table.add("glass of an edge color", glass, {true, false, 1.0, 0.005}, true);
}

/// KHR_materials_fuzz: alone it is a sheen, on a coat it dims that too.
void add_fuzz(Table& table) {
  for (const float metallic : {0.0f, 1.0f}) {
    const std::string matter = metallic > 0.0f ? " on metal" : " on dielectric";
    for (const float roughness : {0.2f, 0.5f, 1.0f}) {
      SurfaceParams p = white(metallic);
      with_fuzz(p, roughness);
      table.add("fuzz of roughness " + number(roughness) + matter, p, {}, true);
    }
    SurfaceParams coated = white(metallic);
    with_fuzz(coated, 0.4f);
    with_coat(coated, 0.1f);
    table.add("fuzz on a coat" + matter, coated, {true, true, 0.006, 0.0125}, true);
    SurfaceParams soot = white(metallic);
    with_fuzz(soot, 0.8f);
    soot.fuzz = 0.7f;
    soot.fuzz_color = vec3(0.0f, 0.01f, 0.02f);
    table.add("soot" + matter, soot, {true, false, 1.0, 0.005}, true);
    SurfaceParams tilted = coated;
    tilted.clearcoat_normal = glm::normalize(vec3(0.2f, -0.1f, 1.0f));
    table.add("fuzz on a coat with a normal of its own" + matter, tilted, {false, false, 1.0, 0.2}, true);
  }
}

/// Extensions that are no ratified part of glTF yet. Below all others, so that laws which take every third row keep
/// theirs.
void add_drafts(Table& table) {
  add_coats(table);
  add_fuzz(table);
  add_edge_colors(table);
  for (const float metallic : {0.0f, 1.0f}) {
    const std::string matter = metallic > 0.0f ? "metal" : "dielectric";
    for (const float share : {0.5f, 1.0f}) {
      SurfaceParams p = white(metallic);
      p.lobes |= shade::kLobeRetroreflection;
      p.retroreflection = share;
      // The search for all random numbers that lead to one direction does not find both halves of a blend.
      table.add(matter + " that sends back " + number(share), p, {}, share == 1.0f);
      with_coat(p, 0.2f);
      with_sheen(p, 0.4f);
      table.add(matter + " that sends back " + number(share) + " below sheen and coat", p, {true, true, 0.085, 0.015},
                false);
    }
  }
  for (const float roughness : {0.5f, 1.0f}) {
    SurfaceParams p = white(0.0f);
    with_diffuse_roughness(p, roughness);
    table.add("diffuse roughness " + number(roughness), p, {}, true);
    SurfaceParams ochre = p;
    ochre.base_color = vec3(0.8f, 0.5f, 0.2f);
    table.add("ochre of diffuse roughness " + number(roughness), ochre, {true, false, 1.0, 0.005}, true);
    with_diffuse_transmission(p);
    table.add("diffuse roughness " + number(roughness) + " that lets light through", p, {}, true);
  }
}

}  // namespace

std::vector<NamedSurface> law_surfaces() {
  Table table;
  add_plain(table);
  add_layers(table);
  add_matter(table);
  add_combinations(table);
  add_mixtures(table);
  add_models(table);
  add_drafts(table);
  return std::move(table).rows();
}

}  // namespace candela::laws
