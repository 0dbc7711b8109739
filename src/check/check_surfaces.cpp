#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "check/check_parts.h"
#include "path/texture.h"
#include "scene/material_table.h"
#include "scene/metals.h"
#include "shade/fresnel.glsl.h"

// What the numbers of a material say at points spread over everything that wears it. docs/check.md has the sources of
// the limits.
namespace candela::check {

namespace {

// Below three codes of sRGB: what black glass and the best velvet have, and what is left black by mistake.
constexpr float kBlackest = 0.001f;
// Below and above these `metallic` means a dielectric and a metal; between them it is a blend of both.
constexpr float kDielectric = 0.1f;
constexpr float kMetal = 0.9f;
constexpr float kNoOcclusion = 0.02f;
// Shares of a material's surface below which a finding is a seam, a letter or a crevice.
constexpr double kWorthTelling = 0.1;
constexpr double kLarge = 0.5;
constexpr double kNearlyAll = 0.95;

/// What a material is at one point.
struct Reading {
  vec3 base_color{1.0f};
  float opacity = 1.0f;
  float metallic = 0.0f;
  float roughness = 0.0f;
  float specular = 0.0f;      ///< largest channel of the specular-glossiness workflow's F0; 0 in the other
  float transmission = 0.0f;  ///< clear or diffuse, the larger
  float occlusion = 1.0f;
  bool has_sheen = false;
  bool glows = false;
};

/// A material's textures, as the path tracer reads them.
class Reader {
 public:
  Reader(const Scene& scene, const Material& material)
      : factors_(material), textures_(path::texture_readers(scene, material)) {}

  Reading at(const SurfaceSample& point) const;

 private:
  template <TextureSlot Material::*kSlot>
  vec4 look_up(const SurfaceSample& point) const {
    const path::TextureReader& texture = textures_[texture_slot_index(kSlot)];
    return texture ? texture.sample(point.uv(texture.uv_set())) : vec4(1.0f);
  }

  const Material& factors_;
  std::array<path::TextureReader, kTextureSlots> textures_;  // by the rows of kTextureRows
};

Reading Reader::at(const SurfaceSample& point) const {
  const Material& m = factors_;
  const vec4 color = vec4(m.base_color, m.opacity) * point.color() * look_up<&Material::base_color_texture>(point);
  const vec4 metallic_roughness = look_up<&Material::metallic_roughness_texture>(point);
  Reading r;
  r.base_color = vec3(color);
  if (m.alpha_mode == AlphaMode::mask) r.opacity = color.w >= m.alpha_cutoff ? 1.0f : 0.0f;
  if (m.alpha_mode == AlphaMode::blend) r.opacity = color.w;
  r.metallic = m.metallic * metallic_roughness.z;
  r.roughness = m.roughness * metallic_roughness.y;
  if (m.specular_glossiness) {
    const vec4 texel = look_up<&Material::specular_glossiness_texture>(point);
    r.roughness = 1.0f - (1.0f - m.roughness) * texel.w;
    r.specular = max_component(m.specular_color * vec3(texel));
  }
  r.transmission = std::max(m.transmission * look_up<&Material::transmission_texture>(point).x,
                            m.diffuse_transmission * look_up<&Material::diffuse_transmission_texture>(point).w);
  r.occlusion = look_up<&Material::occlusion_texture>(point).x;
  r.has_sheen = max_component(m.sheen_color * vec3(look_up<&Material::sheen_color_texture>(point))) > 0.0f;
  r.glows = max_component(m.emission * vec3(look_up<&Material::emissive_texture>(point))) > 0.0f;
  return r;
}

/// Points that share a property, weighted by opacity.
struct Tally {
  double weight = 0.0;
  double sum = 0.0;  ///< of the property's measure
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();

  void add(double w, double value) {
    if (w <= 0.0) return;
    weight += w;
    sum += w * value;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  double mean() const { return weight > 0.0 ? sum / weight : 0.0; }
};

struct Tallies {
  double all = 0.0;               ///< weight
  double paper = 0.0, ink = 0.0;  ///< weight of what is nearly white, and nearly black
  Tally too_bright, too_dark, metal, dark_metal, between, mirror, occluded;
  double least_opacity = 1.0;
};

/// Whether the base colour at a point is the reflectance of a surface that one can see: of no metal, which in the
/// specular-glossiness workflow reflects more at the normal than any dielectric, and of nothing clear.
bool shows_albedo(const Reading& r) {
  constexpr float kMostSpecular = 0.2f;  // diamond has 0.17
  return r.metallic <= kDielectric && r.specular <= kMostSpecular && r.transmission <= 0.5f;
}

void count(const Material& m, const Reading& r, const Limits& limits, Tallies& t) {
  constexpr float kPaper = 0.7f, kInk = 0.05f;
  const double w = r.opacity;
  const float y = luminance(r.base_color);
  t.all += w;
  t.least_opacity = std::min(t.least_opacity, static_cast<double>(r.opacity));
  if (shows_albedo(r)) {
    t.paper += y > kPaper ? w : 0.0;
    t.ink += y < kInk ? w : 0.0;
    if (y > static_cast<float>(limits.brightest_albedo)) t.too_bright.add(w, y);
    // What glows or has pile gives light in another way.
    if (max_component(r.base_color) < static_cast<float>(limits.darkest_albedo) && !r.glows && !r.has_sheen)
      t.too_dark.add(w, y);
  }
  if (r.metallic >= kMetal && !m.is_conductor()) {
    t.metal.add(w, y);
  } else if (r.metallic > kDielectric && r.metallic < kMetal) {
    t.between.add(w, r.metallic);
  }
  if (r.roughness < static_cast<float>(limits.least_roughness) && r.transmission <= 0.5f) t.mirror.add(w, r.roughness);
  if (r.occlusion < kNoOcclusion) t.occluded.add(w, r.occlusion);
}

/// Luminance of the darkest measured metal, at the normal.
struct DarkestMetal {
  std::string_view name;
  float luminance = kInfinity;
};
DarkestMetal darkest_metal() {
  DarkestMetal darkest;
  for (const Metal& metal : metals()) {
    const float y = luminance(shade::fresnel_conductor3(1.0f, metal.n, metal.k));
    if (y < darkest.luminance) darkest = {metal.name, y};
  }
  return darkest;
}

Finding finding(Severity severity, const char* code, int material, double share, std::string message) {
  Finding f;
  f.severity = severity;
  f.code = code;
  f.material = material;
  f.share = share;
  f.message = std::move(message);
  return f;
}

class MaterialJudge {
 public:
  MaterialJudge(const Scene& scene, int index, const MaterialSurface& surface, const Limits& limits,
                std::vector<Finding>& findings)
      : limits_(limits),
        material_(scene.materials[static_cast<std::size_t>(index)]),
        index_(index),
        base_texture_(material_.base_color_texture.texture),
        points_(samples_per_material(scene.materials.size())),
        findings_(findings) {
    const Reader reader(scene, material_);
    for (std::uint32_t i = 0; i < points_; ++i) {
      const SurfaceSample point = surface.sample(i);
      if (point.is_normal_turned()) ++turned_;
      if (is_flat_ && !lies_flat(point)) is_flat_ = false;
      const Reading r = reader.at(point);
      count(material_, r, limits_, t_);
      if (r.metallic >= kMetal && !material_.is_conductor() &&
          luminance(r.base_color) < static_cast<float>(limits_.darkest_metal)) {
        t_.dark_metal.add(r.opacity, luminance(r.base_color));
      }
    }
  }

  void judge() {
    if (material_.is_lamp) return;
    judge_normals();
    if (t_.all <= 0.0) {
      findings_.push_back(finding(Severity::warning, "invisible", index_, 1.0,
                                  "its opacity is 0 at every point; nothing of it can be seen"));
      return;
    }
    judge_albedo();
    judge_metal();
    judge_rest();
  }

 private:
  double share(const Tally& tally) const { return tally.weight / t_.all; }
  void add(Finding f, int texture, const Tally& tally) {
    f.texture = texture;
    f.measured.emplace_back("mean", tally.mean());
    f.measured.emplace_back("least", tally.least);
    f.measured.emplace_back("most", tally.most);
    findings_.push_back(std::move(f));
  }
  bool lies_flat(const SurfaceSample& point);
  bool is_label() const;
  void judge_normals();
  void judge_albedo();
  void judge_metal();
  void judge_rest();

  const Limits& limits_;
  const Material& material_;
  int index_;
  int base_texture_;
  std::uint32_t points_;
  std::uint32_t turned_ = 0;  ///< points whose normal looks to the back
  bool is_flat_ = true;       ///< so far every primitive lies in a plane
  std::map<const Primitive*, vec3> planes_;
  std::vector<Finding>& findings_;
  Tallies t_;
};

void MaterialJudge::judge_normals() {
  const double turned = static_cast<double>(turned_) / points_;
  if (turned <= kWorthTelling) return;
  Finding f = finding(Severity::warning, "normals-against-winding", index_, turned,
                      "normals look to the side that the winding of the triangles makes the back");
  f.fix = "reverse the winding of these triangles, or their normals";
  findings_.push_back(std::move(f));
}

bool MaterialJudge::lies_flat(const SurfaceSample& point) {
  constexpr float kParallel = 0.9999f;  // within a degree
  const std::vector<vec3>& corners = point.primitive->positions;
  const uvec3 t = point.triangle;
  const vec3 cross = glm::cross(corners[t.y] - corners[t.x], corners[t.z] - corners[t.x]);
  const float length = glm::length(cross);
  if (!(length > 0.0f)) return true;
  const auto [plane, is_first] = planes_.try_emplace(point.primitive, cross / length);
  return is_first || std::abs(glm::dot(plane->second, cross)) > kParallel * length;
}

/// Print on a chart: a picture on flat primitives that is nearly all paper and some ink, or the reverse. Its black and
/// white are those of the display that it was drawn for; nobody took them for a measured albedo.
bool MaterialJudge::is_label() const {
  constexpr double kMostly = 0.7, kTraces = 0.005, kBoth = 0.85;
  const double paper = t_.paper / t_.all, ink = t_.ink / t_.all;
  const double least = std::min(paper, ink), most = std::max(paper, ink);
  return base_texture_ >= 0 && is_flat_ && least > kTraces && most > kMostly && least + most > kBoth;
}

void MaterialJudge::judge_albedo() {
  if (is_label()) return;
  if (share(t_.too_bright) > kWorthTelling) {
    Finding f = finding(Severity::warning, "albedo-too-bright", index_, share(t_.too_bright),
                        fmt::format("base colour of luminance {:.2f} where it is no metal; only fresh snow and pressed "
                                    "white powders return more than {:.2g}",
                                    t_.too_bright.mean(), limits_.brightest_albedo));
    f.measured.emplace_back("limit", limits_.brightest_albedo);
    add(std::move(f), base_texture_, t_.too_bright);
  }
  if (share(t_.too_dark) > kWorthTelling) {
    const Severity severity = t_.too_dark.mean() < kBlackest ? Severity::warning : Severity::note;
    Finding f =
        finding(severity, "albedo-too-dark", index_, share(t_.too_dark),
                fmt::format("base colour of luminance {:.3f} where it is no metal; charcoal returns 0.02, only black "
                            "glass, lacquer and velvet less",
                            t_.too_dark.mean()));
    f.measured.emplace_back("limit", limits_.darkest_albedo);
    add(std::move(f), base_texture_, t_.too_dark);
  }
}

void MaterialJudge::judge_metal() {
  if (share(t_.dark_metal) > kWorthTelling) {
    static const DarkestMetal darkest = darkest_metal();
    Finding f = finding(Severity::warning, "metal-too-dark", index_, share(t_.dark_metal),
                        fmt::format("metal that reflects {:.2f} at the normal; the darkest of the measured metals, {}, "
                                    "reflects {:.2f}",
                                    t_.dark_metal.mean(), darkest.name, darkest.luminance));
    f.fix = material_.metallic == 1.0f && !material_.metallic_roughness_texture
                ? "metallicFactor 0, if it is no metal (in glTF it is 1 unless given)"
                : "where it is paint, rust or dirt, metallic is 0";
    f.measured.emplace_back("limit", limits_.darkest_metal);
    f.measured.emplace_back("metal_share", share(t_.metal));
    add(std::move(f), base_texture_, t_.dark_metal);
  }
  if (share(t_.between) > kWorthTelling) {
    Finding f = finding(Severity::note, "metallic-between", index_, share(t_.between),
                        fmt::format("metallic is {:.2f} on average where it is neither below {} nor above {}; matter "
                                    "is a metal or not, between lie only blends of both",
                                    t_.between.mean(), kDielectric, kMetal));
    add(std::move(f), material_.metallic_roughness_texture.texture, t_.between);
  }
}

void MaterialJudge::judge_rest() {
  if (share(t_.mirror) > kLarge) {
    Finding f =
        finding(Severity::note, "roughness-zero", index_, share(t_.mirror),
                fmt::format("roughness below {}: a perfect mirror, smoother than any polish", limits_.least_roughness));
    add(std::move(f), material_.metallic_roughness_texture.texture, t_.mirror);
  }
  if (material_.occlusion_texture && material_.occlusion_strength > 0.0f && share(t_.occluded) > kNearlyAll) {
    Finding f = finding(Severity::warning, "occlusion-black", index_, share(t_.occluded),
                        "occlusion is 0: a rasterizer shows it without any light from the environment");
    f.fix = "leave occlusionTexture out, or put occlusion into its red channel";
    add(std::move(f), material_.occlusion_texture.texture, t_.occluded);
  }
  if (material_.alpha_mode == AlphaMode::blend && t_.least_opacity > 0.999) {
    Finding f = finding(Severity::note, "blend-but-opaque", index_, 1.0,
                        "alphaMode is BLEND and opacity is 1 at every point; rasterizers sort it for nothing");
    f.texture = base_texture_;
    f.fix = "alphaMode OPAQUE";
    findings_.push_back(std::move(f));
  }
}

/// Textures that a factor of 0 hides.
void find_hidden_textures(const Material& m, int index, std::vector<Finding>& findings) {
  const auto slots = texture_slots(m);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (!*slots[i] || has_effect(m, i)) continue;
    Finding f;
    f.severity = Severity::note;
    f.code = "texture-without-effect";
    f.material = index;
    f.texture = slots[i]->texture;
    f.message = fmt::format("{} is multiplied by 0 and changes nothing", kTextureRows[i].source.key);
    f.fix = "set the factor beside it (in glTF it is 0 unless given), or remove the texture";
    findings.push_back(std::move(f));
  }
}

/// Factors that no matter has, whatever textures say.
void judge_factors(const Material& m, int index, std::vector<Finding>& findings) {
  // Rutile, the highest of clear minerals, has 2.6 to 2.9.
  constexpr float kLargestIor = 2.9f;
  const auto add = [&](Severity severity, const char* code, std::string message, const char* name, double value) {
    Finding f;
    f.severity = severity;
    f.code = code;
    f.material = index;
    f.message = std::move(message);
    f.measured.emplace_back(name, value);
    findings.push_back(std::move(f));
  };
  if (!m.specular_glossiness && m.metallic < 1.0f && m.ior > kLargestIor) {
    add(Severity::warning, "ior-too-high",
        fmt::format("index of refraction {:.3g}; no clear matter exceeds {} (rutile)", m.ior, kLargestIor), "ior",
        m.ior);
  }
  // Diamond reflects 0.17 at the normal, rutile 0.2.
  constexpr float kMostReflectance = 0.24f;
  const float reflectance = shade::f0_from_eta(std::max(m.ior, 1.0f)) * m.specular * max_component(m.specular_color);
  if (!m.specular_glossiness && m.metallic < 1.0f && m.ior <= kLargestIor && reflectance > kMostReflectance) {
    add(Severity::warning, "specular-too-bright",
        fmt::format("a dielectric that reflects {:.2f} at the normal; no clear matter exceeds {} (rutile)", reflectance,
                    kMostReflectance),
        "reflectance", reflectance);
  }
  // 20 / Abbe number: rutile has 2.0, dense flint glass 1.1.
  constexpr float kMostDispersion = 2.1f;
  if (m.dispersion > kMostDispersion) {
    add(Severity::warning, "dispersion-too-strong",
        fmt::format("dispersion {:.3g}, an Abbe number of {:.2g}; rutile has 9.9", m.dispersion, 20.0f / m.dispersion),
        "dispersion", m.dispersion);
  }
  if (m.has_volume() && m.transmission == 0.0f && m.diffuse_transmission == 0.0f) {
    add(Severity::note, "volume-without-transmission",
        fmt::format("thicknessFactor {:.3g}, but no transmission lets light in: the volume has no effect", m.thickness),
        "thickness", m.thickness);
  }
}

}  // namespace

void check_surfaces(const Scene& scene, const std::vector<MaterialSurface>& surfaces, const Limits& limits,
                    std::vector<Finding>& findings) {
  std::vector<std::vector<Finding>> of_material(surfaces.size());
  parallel_for(0, surfaces.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Material& material = scene.materials[i];
      if (surfaces[i].empty() || material.unlit) continue;
      MaterialJudge(scene, static_cast<int>(i), surfaces[i], limits, of_material[i]).judge();
      find_hidden_textures(material, static_cast<int>(i), of_material[i]);
      judge_factors(material, static_cast<int>(i), of_material[i]);
    }
  });
  for (auto& list : of_material) {
    findings.insert(findings.end(), std::make_move_iterator(list.begin()), std::make_move_iterator(list.end()));
  }
}

}  // namespace candela::check
