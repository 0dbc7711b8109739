#pragma once

#include <compare>
#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "gl/gl.h"
#include "gl/shader_text.h"
#include "raster/blocks.h"
#include "raster/packing.h"
#include "raster/quantity.h"
#include "shade/model.glsl.h"

namespace candela::raster {

/// What of a material decides the text of its shader; everything else is data.
struct MaterialKey {
  int lobes = 0;
  std::uint32_t slots = 0;  ///< bit i: texture_slots(material)[i] has a texture
  Channels channels;
  bool has_tangents = false;
  bool has_colors = false;
  bool has_body = false;
  bool is_scattering = false;  ///< a body whose light is spread over its neighbourhood
  bool is_unlit = false;
  bool is_specular_glossiness = false;
  bool is_plain_uv = false;  ///< every slot reads the first set as it is
  int more_uvs = 0;          ///< pairs of uv sets beyond the first two
  bool is_emissive = false;
  AlphaMode alpha_mode = AlphaMode::opaque;

  auto operator<=>(const MaterialKey&) const = default;  // NOLINT(modernize-use-nullptr): there is none
};

/// Which of a blended surface a pass draws.
enum class BlendPart {
  all,     ///< or the surface is not blended
  opaque,  ///< where nothing shows through, without blending
  rest,    ///< elsewhere, of a slice of depth
};

/// What of a pass does.
struct PassKey {
  bool has_lights = false;
  bool has_far_light = false;  ///< baked light of an environment, or of probes
  bool has_sheen_light = false;
  bool has_opaque_picture = false;
  bool has_occlusion = false;  ///< of the screen
  bool has_areas = false;
  bool has_probes = false;
  bool has_soft_shadows = false;
  bool has_scattering = false;  ///< the picture has layers of light that has yet to spread
  bool has_through = false;     ///< glass shows a background that is not in the picture
  bool has_coverage = false;    ///< masks become coverage of several samples
  bool has_veils = false;       ///< blended surfaces dim the light of lamps
  bool is_in_body = false;      ///< the eye is in a body that absorbs
  BlendPart blend_part = BlendPart::all;
  Quantity quantity = Quantity::light;  ///< light, or one of a surface
  bool is_map = false;                  ///< with Quantity::object_id: which draw, which triangle, and where in it

  auto operator<=>(const PassKey&) const = default;  // NOLINT(modernize-use-nullptr): there is none
};

/// A program for surfaces.
struct SurfaceProgram {
  std::unique_ptr<gl::Program> program;
  std::uint32_t left_out = 0;  ///< slots of the key for whose textures the driver has no room
};

/// What a pass without shading draws of a surface.
enum class DepthPass {
  solid,  ///< depth of what is there as far as light is concerned: masks cut out, of blended surfaces the opaque part
  first_layer,   ///< depth of blended surfaces where something shows through
  next_layer,    ///< the same beyond the depth of `last_layer`
  first_veil,    ///< the share of light that passes those at the depth of `last_layer`
  passing_veil,  ///< the share alone
};

/// The programs, each compiled when it is first asked for.
class Programs {
 public:
  /// `folder` holds shaders to be read instead of those in the program: its files by name, src/shade's as shade/….
  /// A shader reads `most_textures` at once, or as many as the driver lets it.
  explicit Programs(const shade::ShadingModel& model, std::string folder = {}, int most_textures = 0);

  const SurfaceProgram& mesh(const MaterialKey& material, const PassKey& pass);
  /// Depth alone; `is_shadow`: as shadow maps have it.
  const gl::Program& depth(const MaterialKey& material, DepthPass pass = DepthPass::solid, bool is_shadow = false);
  /// A fragment shader over the whole picture: "present.frag.glsl".
  const gl::Program& fullscreen(const std::string& fragment, const std::string& preamble = {});
  /// `has_culled`: there are surfaces that the eye does not see, and light does.
  const gl::Program& occlusion(bool has_culled);
  const gl::Program& background(bool has_panorama, int sun_count);

  /// Forgets what was compiled, so that changed files are read again.
  void reload();
  std::size_t count() const { return mesh_.size() + depth_.size() + fullscreen_.size(); }

 private:
  std::unique_ptr<gl::Program> compile(const std::string& vertex, const std::string& fragment,
                                       const std::string& preamble, bool has_layers);
  const gl::Program& depth(const MaterialKey& material, bool is_shadow);
  SurfaceProgram compile_mesh(MaterialKey material, const PassKey& pass);

  shade::ShadingModel model_;
  gl::ShaderText::Reader reader_;
  std::size_t most_textures_ = 0;
  std::map<std::pair<MaterialKey, PassKey>, SurfaceProgram> mesh_;
  std::map<std::tuple<MaterialKey, DepthPass, bool>, std::unique_ptr<gl::Program>> depth_;
  std::map<std::pair<std::string, std::string>, std::unique_ptr<gl::Program>> fullscreen_;
};

/// The sampler that reads the texture of a row of kTextureRows.
const std::string& slot_sampler(std::size_t i);

}  // namespace candela::raster
