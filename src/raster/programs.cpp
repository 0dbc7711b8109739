#include "raster/programs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "base/error.h"
#include "raster/material_block.h"
#include "raster/opacity.h"
#include "raster/shader_files.h"
#include "scene/cutoff.h"

namespace candela::raster {

namespace {

constexpr std::size_t kMostLightSamplers = 12;  // of a shader for surfaces, besides its material's
const std::string kMeshFragment = "mesh.frag.glsl";
std::string read_embedded(const std::string& name) {
  const auto file = shader_files().find(name);
  if (file == shader_files().end()) throw Error("no such shader", name);
  return file->second;
}

std::string define(const std::string& name, int value = 1) {
  return "#define " + name + " " + std::to_string(value) + "\n";
}

/// With the texts that are made of the table of materials.
gl::ShaderText::Reader with_material_texts(gl::ShaderText::Reader files) {
  return [files = std::move(files)](const std::string& name) {
    if (name == "material_block.glsl") return material_block_text();
    if (name == "material_fetch.glsl") return material_fetch_text();
    return files(name);
  };
}

/// The samplers of the slots in `mask`, and macros that read them.
std::string slots_text(const MaterialKey& key, std::uint32_t mask) {
  std::string text;
  if (key.more_uvs > 0) text += define("MORE_UVS", key.more_uvs);
  for (std::size_t i = 0; i < kTextureSlots; ++i) {
    if ((mask >> i & 1u) == 0) continue;
    const std::string_view name = kTextureRows[i].name;
    const std::string uv = key.is_plain_uv ? "surface_uv.xy" : fmt::format("slot_uv({})", i);
    text += fmt::format("#define HAS_{0} 1\nuniform sampler2D {2};\n#define {0}_uv() {1}\n", name, uv, slot_sampler(i));
    text += fmt::format("#define {0}_texel() texture({2}, {1})\n", name, uv, slot_sampler(i));
    text += factor_texts(i);
  }
  return text;
}

/// Of numbers that have moved into another texture, the macros that read them there.
std::string channels_text(const Channels& channels) {
  std::string text;
  const auto add = [&text](NumberOrColor<Material> member, const Channel& channel) {
    const MaterialProperty& row = property_of(member);
    if (!channel || channel.slot == static_cast<int>(row.texture.index())) return;
    text += fmt::format("#define {}_factor() {}_texel().{}\n", row.name,
                        kTextureRows[static_cast<std::size_t>(channel.slot)].name,
                        "rgba"[static_cast<std::size_t>(channel.component)]);
  };
  add(&Material::metallic, channels.metallic);
  add(&Material::roughness, channels.roughness);
  add(&Material::occlusion_strength, channels.occlusion);
  return text;
}

/// The terms of a shading model other than the default one, as constants.
std::string model_text(const shade::ShadingModel& m) {
  return define("MODEL_DISTRIBUTION", m.distribution) + define("MODEL_MASKING", m.masking) +
         define("MODEL_FRESNEL", m.fresnel) + define("MODEL_DIFFUSE", m.diffuse) + define("MODEL_BLEND", m.blend) +
         define("MODEL_MULTISCATTER", m.multiscatter ? 1 : 0) +
         define("MODEL_LITERAL_LAYERS", m.literal_layers ? 1 : 0);
}

/// The bits of Part.
std::string parts_text() {
  return define("kDiffusePart", diffuse_part) + define("kSpecularPart", specular_part) +
         define("kCoatPart", coat_part) + define("kSheenPart", sheen_part) + define("kThroughPart", through_part) +
         define("kDirectPart", direct_part) + define("kEmissionPart", emission_part);
}

/// Where a blended surface is opaque, and where it is none; between them lies what blended passes draw. What is nearly
/// whole is drawn by both, so that none of it falls between two roundings.
std::string blend_text() {
  return define("ALPHA_BLEND") +
         fmt::format("#define kOpaqueAlpha {:.6f}\n#define kWholeAlpha {:.6f}\n#define kOpacityOfLayers {:.6f}\n",
                     kOpaqueAlpha, 0.25f * kOpaqueAlpha + 0.75f, kOpacityOfLayers) +
         "#define kLeastAlpha 0.001\n";
}

std::string mesh_preamble(const MaterialKey& key, const PassKey& pass, const shade::ShadingModel& model) {
  std::string text = slots_text(key, key.slots) + channels_text(key.channels) + define("LOBES", key.lobes) +
                     define("kMostLights", kMostLights) + define("kMostShadows", kMostShadows) +
                     define("kMostAreas", kMostAreas) + parts_text();
  const auto add = [&text](bool is_wanted, const std::string& name) {
    if (is_wanted) text += define(name);
  };
  const auto has = [&key](int lobe) { return (key.lobes & lobe) != 0; };
  text += has(shade::kLobeModel) ? model_text(model) : define("SHADE_DEFAULT_MODEL");
  add(key.has_tangents, "HAS_TANGENT");
  add(key.has_colors, "HAS_COLOR");
  add(key.has_body, "HAS_BODY");
  add(key.has_body || key.is_scattering || (key.slots >> height_slot & 1u) != 0, "HAS_SCALE");
  add(key.is_scattering, "IS_SCATTERING");
  add(key.is_unlit, "IS_UNLIT");
  add(key.is_specular_glossiness, "IS_SPECULAR_GLOSSINESS");
  add(key.lobes != 0, "HAS_LAYERS");
  add(has(shade::kLobesOfFibres), "HAS_FIBRES");
  for (const LobeRow& lobe : kLobes) add(has(lobe.bit), "LOBE_" + std::string(lobe.name));
  add(key.alpha_mode == AlphaMode::mask, "ALPHA_MASK");
  add(key.alpha_mode == AlphaMode::mask && pass.has_coverage, "ALPHA_TO_COVERAGE");
  if (key.alpha_mode == AlphaMode::blend) {
    text += blend_text();
    add(pass.blend_part == BlendPart::opaque, "OPAQUE_PART");
    add(pass.blend_part == BlendPart::rest, "BLENDED_PART");
  }
  add(pass.has_lights || pass.has_areas, "HAS_LIGHTS");
  add(pass.has_lights, "HAS_PUNCTUAL");
  add(pass.has_far_light, "HAS_FAR_LIGHT");
  add(pass.has_sheen_light, "HAS_SHEEN_LIGHT");
  add(pass.has_opaque_picture, "HAS_OPAQUE_PICTURE");
  add(pass.has_occlusion, "HAS_SCREEN_OCCLUSION");
  add(pass.has_areas, "HAS_AREAS");
  add(pass.has_probes, "HAS_PROBES");
  add(pass.has_soft_shadows, "HAS_SOFT_SHADOWS");
  add(pass.has_scattering, "HAS_SCATTERING");
  add(pass.has_through, "HAS_THROUGH");
  add(pass.has_veils, "HAS_VEILS");
  add(pass.is_in_body && !is_of_surface(pass.quantity), "IN_BODY");
  add(key.is_emissive, "IS_EMISSIVE");
  if (is_of_surface(pass.quantity)) {
    // "base-color" is SHOW_base_color.
    for (int i = 0; i < kQuantityCount; ++i) {
      std::string name = "SHOW_" + std::string(quantity_name(static_cast<Quantity>(i)));
      std::replace(name.begin(), name.end(), '-', '_');
      text += define(name, i);
    }
    text += define("SHOW", static_cast<int>(pass.quantity));
    add(pass.is_map, "SURFACE_MAP");
  }
  return text;
}

/// Without the texture of its last slot, whose factors then stand alone.
MaterialKey without_last_slot(MaterialKey key) {
  const int last = static_cast<int>(std::bit_width(key.slots)) - 1;
  key.slots &= ~(1u << last);
  for (Channel* c : {&key.channels.metallic, &key.channels.roughness, &key.channels.occlusion}) {
    if (c->slot == last) *c = {};
  }
  return key;
}

}  // namespace

const std::string& slot_sampler(std::size_t i) {
  static const std::array<std::string, kTextureSlots> kSamplers = [] {
    std::array<std::string, kTextureSlots> names;
    for (std::size_t k = 0; k < kTextureSlots; ++k) names[k] = std::string(kTextureRows[k].name) + "_texture";
    return names;
  }();
  return kSamplers[i];
}

Programs::Programs(const shade::ShadingModel& model, std::string folder, int most_textures)
    : model_(model),
      reader_(with_material_texts(folder.empty() ? gl::ShaderText::Reader(read_embedded)
                                                 : gl::read_from_folder(std::move(folder)))) {
  GLint units = 16;
  glGetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &units);
  most_textures_ = static_cast<std::size_t>(most_textures > 0 ? std::min(most_textures, units) : units);
}

void Programs::reload() {
  mesh_.clear();
  depth_.clear();
  fullscreen_.clear();
}

std::unique_ptr<gl::Program> Programs::compile(const std::string& vertex, const std::string& fragment,
                                               const std::string& preamble, bool has_layers) {
  const auto text_of = [&](const std::string& name) {
    gl::ShaderText text(reader_);
    text.add_text("defines", define("SHADE_FILTERED_TABLES"));
    text.add_text("defines of " + name, preamble);
    if (name == kMeshFragment && !has_layers) text.add_header("no_layers.glsl");
    text.add_header(name);
    return text;
  };
  const gl::ShaderText vertex_text = text_of(vertex), fragment_text = text_of(fragment);
  std::unique_ptr<gl::Program> program;
  try {
    program = std::make_unique<gl::Program>(vertex_text.text(), fragment_text.text());
  } catch (const Error& error) {
    const gl::ShaderText& text = error.where() == "vertex" ? vertex_text : fragment_text;
    throw Error("the driver refuses a shader: " + text.explain(error.message()),
                error.where() == "vertex" ? vertex : fragment);
  }
  program->bind_block("Frame", frame_binding);
  program->bind_block("Material", material_binding);
  program->bind_block("Lights", lights_binding);
  return program;
}

SurfaceProgram Programs::compile_mesh(MaterialKey material, const PassKey& pass) {
  const std::uint32_t wanted = material.slots;
  for (;; material = without_last_slot(material)) {
    SurfaceProgram result;
    try {
      result.program =
          compile("mesh.vert.glsl", kMeshFragment, mesh_preamble(material, pass, model_), material.lobes != 0);
    } catch (const Error&) {
      // A driver may refuse what has more samplers than it can bind.
      if (material.slots == 0 ||
          static_cast<std::size_t>(std::popcount(material.slots)) + kMostLightSamplers <= most_textures_)
        throw;
    }
    result.left_out = wanted & ~material.slots;
    if (result.program != nullptr && (result.program->samplers().size() <= most_textures_ || material.slots == 0))
      return result;
  }
}

const SurfaceProgram& Programs::mesh(const MaterialKey& material, const PassKey& pass) {
  PassKey key = pass;
  if (material.alpha_mode != AlphaMode::blend) key.blend_part = BlendPart::all;
  SurfaceProgram& program = mesh_[{material, key}];
  if (program.program == nullptr) program = compile_mesh(material, key);
  return program;
}

const gl::Program& Programs::depth(const MaterialKey& material, DepthPass pass, bool is_shadow) {
  // All but alpha is the same to a shadow.
  MaterialKey key;
  key.alpha_mode = material.alpha_mode;
  if (key.alpha_mode != AlphaMode::opaque) {
    key.slots = material.slots & (1u << base_color_slot);
    key.is_plain_uv = material.is_plain_uv;
    key.more_uvs = key.slots != 0 ? material.more_uvs : 0;
  }
  std::unique_ptr<gl::Program>& program = depth_[{key, pass, is_shadow}];
  if (program == nullptr) {
    std::string text = slots_text(key, key.slots);
    if (key.alpha_mode == AlphaMode::mask) text += define("ALPHA_MASK");
    if (key.alpha_mode == AlphaMode::blend) text += blend_text();
    if (pass == DepthPass::solid) text += define("OPAQUE_PART");
    if (pass == DepthPass::next_layer) text += define("BEYOND_LAST_LAYER");
    if (pass == DepthPass::first_veil) text += define("AT_LAST_LAYER");
    if (pass == DepthPass::first_veil || pass == DepthPass::passing_veil) text += define("HAS_PASSING");
    if (is_shadow) text += define("IS_SHADOW");
    program = compile("depth.vert.glsl", "depth.frag.glsl", text, false);
  }
  return *program;
}

const gl::Program& Programs::fullscreen(const std::string& fragment, const std::string& preamble) {
  std::unique_ptr<gl::Program>& program = fullscreen_[{fragment, preamble}];
  if (program == nullptr) program = compile("fullscreen.vert.glsl", fragment, preamble, false);
  return *program;
}

const gl::Program& Programs::occlusion(bool has_culled) {
  return fullscreen("occlusion.frag.glsl", has_culled ? define("HAS_CULLED") : "");
}

const gl::Program& Programs::background(bool has_panorama, int sun_count) {
  return fullscreen("background.frag.glsl",
                    (has_panorama ? define("HAS_PANORAMA") : "") + (sun_count > 0 ? define("kSuns", sun_count) : ""));
}

}  // namespace candela::raster
