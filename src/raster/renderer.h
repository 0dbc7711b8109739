#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "image/develop.h"
#include "raster/areas.h"
#include "raster/body.h"
#include "raster/camera.h"
#include "raster/depth_range.h"
#include "raster/gpu_scene.h"
#include "raster/image_light.h"
#include "raster/lights.h"
#include "raster/render.h"

namespace candela::raster {

/// Draws frames of one scene under one environment into buffers of its own. Needs a current gl::Context. What sits on
/// it decides when to draw and where a frame goes.
class Renderer {
 public:
  /// `scene` and `environment` must outlive it. Until set_light() nothing arrives from far away but suns.
  Renderer(const Scene& scene, const Environment& environment, const shade::ShadingModel& shading,
           const Settings& settings, Diagnostics& diagnostics);
  void set_light(const BakedLight& light);
  /// Another environment, of which the light that set_light() gives next is. It must outlive what is drawn in it.
  void set_environment(const Environment& environment);
  /// From here on light from far away is turned by so much more than it was baked with, and multiplied. What the
  /// environment says of its rotation and intensity counts for background and suns.
  void turn_light(float radians, float factor);
  /// Of long frames every surface is drawn in so many bands, between which the caller's StopScope counts: a stop leaves
  /// the frame as it is.
  void set_bands(int bands) { bands_ = bands; }
  /// After a frame that was left as it is: the driver's state as a frame begins with.
  static void reset_state();
  /// Instead of what set_light() gave, for draws as near to them as to no other.
  void set_probes(const std::vector<Probe>& probes);
  /// Another moment of the same scene; it must outlive what is drawn of it. begin() has to follow, and set_light()
  /// where it lacks_sheen_light().
  void set_scene(const Scene& scene);
  /// Whether something has a sheen since, for which the light was not baked.
  bool lacks_sheen_light() const;

  /// Lets the driver compile what the frames of a view need, without drawing any pixel that counts.
  void warm_up(const View& view);
  /// Places lights and draws their shadows for a view, before its frames; again before each where lights have an extent
  /// and frames are many, each time with another `point` of them.
  void begin(const View& view, LightPoint point = LightPoint(0.5f));
  bool has_extended_lights() const;
  /// Draws one frame of the view that begin() was given; see frame_camera for `jitter` and `aperture`. `frame`, its
  /// number within the picture from 1, turns the noise of what is spread over the frames.
  void draw(const View& view, vec2 jitter = vec2(0.0f), vec2 aperture = vec2(0.0f), int frame = 0);
  /// The last frame: linear, 4 channels, premultiplied, row 0 at the top.
  Image read();
  /// What a background would be multiplied by where glass shows it, over what alpha lets through: 4 channels of the
  /// last frame, or nothing where glass does not show it.
  Image read_through();
  /// Shows the last frame in the framebuffer of a window of `size` pixels.
  void present(ivec2 size, float exposure, ToneCurve tone_curve);
  /// The same as a picture of the frame's own size.
  DisplayImage read_shown(float exposure, ToneCurve tone_curve);
  /// Frames of another size from here on, of another part of the light, with other shadows; begin() has to follow.
  void change(const Settings& settings);
  /// A layer that has a mean, as the first surface at each pixel's centre has it.
  Image read_layer(const View& view, Layer layer);
  /// What is at each pixel's centre; see frame_camera for `jitter` and `aperture`.
  SurfaceMap read_surfaces(const View& view, vec2 jitter = vec2(0.0f), vec2 aperture = vec2(0.0f));
  /// Where each node would be, were nothing before it.
  std::vector<InstanceMask> read_masks(const View& view);

  const GpuScene& scene() const { return gpu_; }
  Programs& programs() { return programs_; }

 private:
  /// A probe as the driver has it.
  struct GpuProbe {
    vec3 position{0.0f};
    Box3 box;
    int levels = 1;
    gl::Texture specular, diffuse, sheen;
  };

  /// Which of the blended surfaces are drawn where there is glass: all, those before it or the others.
  enum class GlassSide { any, before, not_before };

  /// A picture to draw into.
  struct Target {
    gl::Framebuffer framebuffer;
    gl::Renderbuffer color, depth;
  };

  bool wants_scattering() const;
  bool wants_opaque_picture() const;
  void make_targets();
  void make_occlusion_targets();
  void draw_occlusion(const std::vector<std::size_t>& opaque, const FrameCamera& camera);
  void upload_table();
  void bind_frame(const FrameCamera& camera);
  void bind_light(const gl::Program& program) const;
  void tell_left_out(const GpuMaterial& material, std::uint32_t slots);
  void find_area_lights(Diagnostics& diagnostics);
  View relative(View view) const;
  void draw_shadows();
  void draw_casters(int layer);
  /// Ready to draw into a shadow map.
  static void use_shadow_program(const gl::Program& program, const ShadowEntry& shadow);
  void draw_depth(const std::vector<std::size_t>& order, const FrameCamera& camera, bool has_cut_out);
  void draw_scattering(const FrameCamera& camera);
  void draw_background(const FrameCamera& camera);
  void draw_ground_depth(const FrameCamera& camera);
  bool draw_culled(const std::vector<std::size_t>& opaque, const FrameCamera& camera);
  /// Whether to the eye a material has both sides.
  bool has_both_sides(const GpuMaterial& material) const;
  bool casts_veil(const GpuMaterial& material) const;
  void draw_veils();
  bool draw_layer(std::vector<std::size_t> order, const mat4& clip_from_world, DepthPass pass, GLenum culled,
                  GLuint last_layer = 0, const ShadowEntry* shadow = nullptr);
  void make_depth_layers();
  void attach_depth_layer(int layer);
  void find_depth_layers(const std::vector<std::size_t>& transmissive, const std::vector<std::size_t>& blended,
                         const FrameCamera& camera);
  int find_slices(const std::vector<std::size_t>& blended, const FrameCamera& camera);
  void draw_blended(const std::vector<std::size_t>& blended, PassKey pass, const FrameCamera& camera, GlassSide side);
  /// Draws those of `order` with the programs of `pass`.
  void draw_surfaces(const std::vector<std::size_t>& order, const PassKey& pass, const FrameCamera& camera);
  void bind_probe(std::size_t draw, const gl::Program& program);
  /// Numbers of all draws; of those at one place the last is what a picture shows: what is opaque lies below glass, and
  /// that below what is blended.
  std::vector<std::size_t> all_draws() const;
  void draw_quantity(Quantity quantity, const FrameCamera& camera);
  Target make_float_target() const;
  void clear_floats(float value) const;
  void draw_map(const std::vector<std::size_t>& draws, const FrameCamera& camera);
  void draw_some(std::size_t first, std::size_t count, const PassKey& pass);
  void draw_in_bands(std::size_t first, std::size_t count, const PassKey& pass);
  void draw_shown(GLuint framebuffer, ivec2 size, float exposure, ToneCurve tone_curve);
  void resolve(GLuint framebuffer);
  void resolve_through();

  const Scene* scene_;
  const Environment* environment_;
  Settings settings_;
  Diagnostics& diagnostics_;
  Programs programs_;
  GpuScene gpu_;
  std::vector<GpuProbe> probes_;
  SceneLights lights_;
  bool is_moved_light_ = false;   ///< shadows are seen from a point of each light that was not the middle
  std::vector<AreaLight> areas_;  ///< of the scene as it stands
  std::vector<int> own_areas_;    ///< of each draw; bit i: area light i is part of it
  /// What of a draw is not part of an area light that it is part of: it casts shadows in its light.
  std::map<std::pair<int, std::size_t>, GpuTriangles> beside_lamps_;
  DepthRange range_;  ///< of the view that begin() was given
  float sky_ = 0.0f;  ///< mean luminance from far away
  bool is_begun_ = false;
  Diagnostics told_;  ///< warnings that were given before
  std::set<GLintptr> told_materials_;
  bool has_light_ = false;
  bool has_sheen_light_ = false;
  bool expects_light_ = false;  ///< the environment is more than suns
  int frame_ = 0;
  int bands_ = 1;
  vec3 light_turn_{1.0f, 0.0f, 1.0f};  ///< as FrameBlock has it
  int light_levels_ = 1;
  int picture_levels_ = 1;
  gl::Texture table_, ggx_table_, specular_, diffuse_, sheen_, profiles_, shadows_, panorama_;
  gl::Texture depth_map_, culled_map_;
  std::array<gl::Texture, 2> visibility_;  ///< as found, and its mean
  gl::Framebuffer depth_framebuffer_, culled_framebuffer_;
  std::array<gl::Framebuffer, 2> visibility_framebuffer_;
  bool has_scattering_ = false;           ///< something may spread light, and the picture shows it
  bool has_opaque_picture_ = false;       ///< something may let light through
  std::array<gl::Texture, 2> scattered_;  ///< light that spreads, and how wide
  std::array<gl::Renderbuffer, 2> scattered_samples_;
  std::array<gl::Framebuffer, 2> scattered_framebuffer_;
  bool has_veils_ = false;                 ///< blended surfaces dim the lamps of the frame
  std::optional<Body> body_;               ///< that the eye is in
  float near_plane_ = 0.0f;                ///< of the view
  float rays_start_ = 0.0f;                ///< along the view, see start_of_rays()
  int slice_count_ = 0;                    ///< of the frame's blended surfaces
  bool is_slice_deep_ = false;             ///< several surfaces may lie in the slice that is drawn
  bool has_glass_before_blended_ = false;  ///< or behind it
  glm::ivec4 slice_{-1};                   ///< which of them is drawn, as the shader has it
  glm::ivec3 layers_size_{0};              ///< of depth_layers_
  gl::Texture veils_, veil_depth_, depth_layers_;
  std::array<gl::Texture, 2> last_layers_;
  gl::Framebuffer veil_framebuffer_, copy_framebuffer_, layer_framebuffer_;
  gl::Sampler depth_sampler_;  ///< reads shadow maps without comparing
  bool has_through_ = false;   ///< glass shows a background that is not in the picture
  gl::Texture through_;
  gl::Renderbuffer through_samples_;
  gl::Framebuffer through_framebuffer_;
  gl::Texture resolved_, opaque_picture_;
  gl::Framebuffer resolved_framebuffer_, picture_framebuffer_, shadow_framebuffer_;
  gl::Buffer frame_block_, lights_block_;
  gl::VertexArray nothing_;
  Target target_;
};

}  // namespace candela::raster
