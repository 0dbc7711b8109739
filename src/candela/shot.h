#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "candela/candela.h"
#include "candela/part.h"
#include "candela/scene_keep.h"
#include "denoise/denoise.h"
#include "scene/posed_camera.h"

/// Recipes: the description of a picture, or of a set of them, for either engine, from the file to the exposure.
namespace candela {

enum class Engine { path, raster };

/// How the light of every point and spot light falls off.
struct FalloffChoice {
  Falloff kind = Falloff::gltf;
  std::optional<vec3> polynomial = {};  ///< empty = each light's own
};

/// A level ground under the subject, see Ground.
struct GroundChoice {
  /// Linear, below 1: paper that is the background as well, unless that is transparent. Empty: what shows is the
  /// background, and what the ground sends back into the scene has its colour, or is grey where it has none.
  std::optional<vec3> color = {};
  float mirror = 0.0f;
  std::optional<float> height = {};  ///< y, metres; empty = just below the subject in the first picture
};

/// Some of a set's pictures, counted from 1 in the order of the set.
struct PictureRange {
  std::size_t first = 1, last = 1;
  std::size_t count() const { return last - first + 1; }
};
/// "9-16", or "9". Throws Error for anything else.
PictureRange parse_pictures(const std::string& text);

/// The picture or pictures to make. Whatever is empty is the scene's own choice. An Error about a member names the
/// option of `candela render` that sets it.
struct Shot {
  std::string scene;  ///< a file, or "demo:NAME"
  LoadOptions load = {};
  Engine engine = Engine::path;

  // ----- the picture
  ivec2 size{1280, 720};
  std::set<Layer> layers = {};
  std::set<MatteKind> mattes = {};
  bool has_masks = false;  ///< Film::masks
  Background background = Background::environment;
  std::optional<GroundChoice> ground = {};
  bool environment_in_glass = false;  ///< with another background: glass still shows the environment behind it
  shade::ShadingModel shading = shade::shading_model_candela();
  std::string shading_name = {};                 ///< for the metadata; empty = the default model
  path::Settings traced = {};                    ///< for the path tracer only; the members above take precedence
  raster::Settings drawn = {};                   ///< for the rasterizer only, likewise
  std::optional<denoise::Method> denoiser = {};  ///< of traced pictures; Film::noisy has them as they were
  std::optional<PartRange> part = {};            ///< of the samples that are traced; the picture is one of its parts
  std::optional<PictureRange> pictures = {};     ///< of a set these alone, named and framed as in the whole set
  int probes = 0;                                ///< for the rasterizer: places where light within the scene is traced

  // ----- the viewpoint: the first of these that is given, else default_view()
  std::optional<CameraSphere> camera_sphere = {};  ///< a picture from each, which shows the whole subject
  std::vector<PosedCamera> cameras = {};           ///< a picture through each
  std::vector<std::string> views = {};             ///< a picture of each of kNamedViews
  std::optional<vec3> eye = {};
  std::optional<vec3> target = {};  ///< the point that the eye looks at and focuses on; empty = the subject's centre
  std::optional<Orbit> orbit = {};
  std::optional<std::string> camera = {};  ///< of the scene, by number or name
  bool ignores_planes = false;             ///< the near and far planes of the scene's cameras
  std::optional<float> yfov = {};
  bool ignores_own_camera = false;    ///< the subject is framed where none of the above is given
  bool is_orthographic = false;       ///< of what is no camera of the scene or of a list
  float margin = 0.08f;               ///< Framing::margin, where the subject is framed
  std::optional<int> turntable = {};  ///< number of pictures all around the subject

  // ----- the lens
  std::optional<float> f_number = {};
  std::optional<float> focus_distance = {};  ///< metres
  bool focuses_on_target = false;            ///< overrides the focus of the scene's own camera; implied by `f_number`
  int blades = 0;
  float vignetting = 0.0f;

  // ----- light
  std::optional<std::string> environment = {};  ///< a name for make_environment()
  float environment_rotation = 0.0f;            ///< radians
  float environment_intensity = 1.0f;
  std::optional<FalloffChoice> falloff = {};

  // ----- which of the file's looks and motions: a picture of each that is named, or where none is named of all
  std::optional<std::vector<std::string>> variants = {};
  std::optional<std::vector<std::string>> animations = {};  ///< as Pose::animation names them

  // ----- when
  std::optional<std::string> animation = {};  ///< as Pose::animation names it
  std::optional<double> moment_s = {};        ///< empty = at rest, or the animation's beginning
  double shutter_s = 0.0;                     ///< how long a picture is exposed while the scene moves
  std::optional<int> sequence = {};           ///< number of pictures over the animation

  // ----- how it is shown
  std::optional<std::optional<float>> exposure = {};  ///< a factor, or empty: metered
  ToneCurve tone_curve = ToneCurve::pbr_neutral;
  float bloom = 0.0f;
  float background_opacity = 1.0f;            ///< of that colour
  std::optional<vec3> background_color = {};  ///< linear; shows through where the picture is transparent

  /// Whether it may be more than one, which is known once the file is open.
  bool has_many_pictures() const {
    return turntable || sequence || variants || animations || camera_sphere || cameras.size() > 1 || views.size() > 1;
  }
  /// Whether one picture of them is all that is made.
  bool makes_one_picture() const { return pictures ? pictures->count() == 1 : !has_many_pictures(); }
};

/// Which of a shot's pictures one is: what distinguishes it from the others, by the names that the shot gives them.
struct PictureLabel {
  std::string variant = {};
  std::string animation = {};
  std::string view = {};
  std::string camera = {};  ///< of a list without names its number

  bool operator==(const PictureLabel&) const = default;
};

/// How good a picture shall be, in the words of people who wait for it.
enum class Quality {
  draft,  ///< to see what there is
  good,   ///< to show
  final   ///< to keep
};

/// What a quality asks of either engine; Shots that set_quality() has not touched have none of it.
struct QualityInfo {
  Quality quality;
  std::string_view name;  ///< on the command line
  int samples;            ///< path::Settings: at most
  float noise;            ///< the noise of what is shown at which a pixel has enough; 0 = all samples are taken
  int frames;             ///< raster::Settings
};
/// All are denoised by what is built in. Chosen by the errors and seconds in docs/denoising.md.
inline constexpr auto kQualities = std::to_array<QualityInfo>({
    {Quality::draft, "draft", 16, 0.0f, 1},
    {Quality::good, "good", 128, 0.02f, 8},
    {Quality::final, "final", 2048, 0.005f, 32},
});
/// Throws Error that lists what there is.
Quality parse_quality(std::string_view name);

/// Gives a shot the samples, the noise target and the denoiser, and the frames, that the quality means.
void set_quality(Quality quality, Shot& shot);

/// A place to photograph products in: light, ground, background and exposure that fit each other.
enum class Studio {
  white,       ///< white paper, which stays white
  grey,        ///< grey paper
  dark,        ///< contours on polished black
  three_point  ///< key, fill and back light
};

struct StudioInfo {
  Studio studio;
  std::string_view name;  ///< on the command line
  std::string_view environment;
  vec3 paper;  ///< linear
  float mirror;
};
inline constexpr auto kStudios = std::to_array<StudioInfo>({
    {Studio::white, "white", "studio", vec3(1.0f), 0.0f},
    {Studio::grey, "grey", "studio", vec3(0.31f, 0.315f, 0.325f), 0.0f},
    {Studio::dark, "dark", "studio:dark", vec3(0.006f, 0.0065f, 0.0075f), 0.15f},
    {Studio::three_point, "three-point", "studio:three-point", vec3(0.06f, 0.064f, 0.07f), 0.0f},
});
/// Throws Error that lists what there is.
Studio parse_studio(std::string_view name);

/// Gives a shot the environment and the ground of a studio. The environment's exposure holds unless the shot has one.
void set_studio(Studio studio, Shot& shot);

/// `view` turned about the vertical axis through `center` in `count` equal steps; the first is not turned.
std::vector<View> all_around(const View& view, vec3 center, int count);

/// The settings of each engine for a shot.
path::Settings traced_settings(const Shot& shot);
raster::Settings drawn_settings(const Shot& shot);
/// Most bytes that one picture of it takes, without the scene.
std::uint64_t picture_bytes(const Shot& shot);

/// What several shots share: environments by their names, and the OpenGL device.
class Stage {
 public:
  /// make_environment(), once per name; every call warns again.
  const Environment& environment(const std::string& name, Diagnostics* diagnostics = nullptr);
  /// Opened by the first call. Throws Error without OpenGL.
  std::shared_ptr<raster::Device> device();
  /// The light of that key, prepared for tracing; the last one is kept.
  std::shared_ptr<const path::FarLight> far_light(const std::string& key, const Environment& environment);
  /// Of the takes on this stage, none unless it is given a capacity.
  SceneKeep& scenes() { return scenes_; }

 private:
  struct Loaded {
    Environment environment;
    Diagnostics diagnostics;
  };
  std::map<std::string, Loaded> environments_;
  std::shared_ptr<raster::Device> device_;
  std::string far_light_key_;
  std::shared_ptr<const path::FarLight> far_light_;
  SceneKeep scenes_;
};

/// One picture of a take.
struct TakenPicture {
  std::size_t index = 0;
  PictureLabel label = {};
  View view = {};
  std::shared_ptr<const Scene> scene = {};  ///< as it stands in the picture, or when its exposure begins
  Film film = {};                           ///< with metadata: scene, camera, environment, samples, …
  DevelopSettings develop = {};             ///< with the take's one exposure
  path::Statistics traced = {};             ///< of the engine that made it
  raster::Statistics drawn = {};
  double denoise_s = 0.0;
  bool is_denoised = false;                      ///< not where a stop came first
  std::shared_ptr<const PicturePart> part = {};  ///< where Shot::part is: what write_part() takes
  bool is_whole() const { return !traced.interrupted && !drawn.interrupted; }
};

/// The outcome of a take.
struct TakeResult {
  std::size_t asked = 0;
  std::size_t done = 0;
  bool interrupted = false;         ///< with samples, frames or pictures left
  bool is_last_unfinished = false;  ///< of those that are done
  path::Statistics traced = {};     ///< of all, by the engine that made them
  raster::Statistics drawn = {};
  double denoise_s = 0.0;
};

/// Where a picture is kept while it is traced, so that little of the work is lost with the machine.
struct Checkpoint {
  std::filesystem::path file;
  double interval_s = 5.0;  ///< at least; longer where writing takes more than a tenth of it
  bool resumes = false;     ///< goes on from the file where it is there
};

/// A shot in progress: its file is open, its pictures can be made. Warnings go to `diagnostics`, which must outlive it.
///
/// Pictures come in this order, the last of them changing first: variants, animations, the moments of a sequence,
/// viewpoints, turns. What is the same for several of them is made once: the file is read once; one acceleration
/// structure, or what is uploaded, serves all viewpoints. They have one exposure, where it is metered that of the
/// first; where only some of them are made that of a small first, so that all ranges have the same.
class Take {
 public:
  /// Opens the file. Throws Error.
  explicit Take(Shot shot, Diagnostics* diagnostics = nullptr, std::shared_ptr<Stage> stage = nullptr);
  ~Take();
  Take(const Take&) = delete;
  Take& operator=(const Take&) = delete;

  /// All files that the scene is read from.
  std::vector<io::ReferencedFile> files() const { return asset_.files(); }
  /// Of every picture, in their order.
  std::vector<PictureLabel> labels() const;
  /// Loads scene and light and chooses views and moments; otherwise render() does it. Throws Error for what the scene
  /// lacks.
  void prepare();
  /// The same for pictures that shall be compared with those of `reference`, which it prepares too: from the same
  /// places, which frame the subjects of both, a camera of the reference's scene as it stands at the first moment;
  /// under the environment that the reference has, but for image-based light of the scene's own; on one ground, in one
  /// exposure. Throws Error where the two do not make the same pictures.
  void prepare_beside(Take& reference);
  /// Keeps the picture so far in a file while it is traced, and removes it once the picture is handed over. Of shots of
  /// one traced picture. Call it before render(). Throws Error.
  void set_checkpoint(Checkpoint checkpoint);
  /// A number that pictures have in common which are made of the same files, by the same version, with the same
  /// settings: parts of them can be merged. After prepare().
  std::string key() const;
  /// How its pictures are developed, as far as known; after prepare().
  const DevelopSettings& develop() const { return develop_; }
  /// From where every picture is taken, in their order, at the shot's first moment; after prepare().
  std::vector<View> views() const;
  /// The scene as it stands in a picture, or when its exposure begins, and from where the picture is taken; after
  /// prepare().
  std::shared_ptr<const Scene> scene(std::size_t index) { return scene_of(index); }
  View view(const Scene& scene, std::size_t index) const { return view_at(scene, index); }
  /// What lights all of them from far away; after prepare().
  const Environment& environment() const { return environment_; }
  /// Of a sequence: how many pictures a second show it as fast as it moves.
  std::optional<double> real_time_rate(std::size_t index) const;

  /// Makes the pictures one after the other and passes each to `take`. After a stop the current one is passed as it is,
  /// and no other is begun; throws Interrupted if there is none. Partial pictures have their metadata. Throws Error as
  /// the engines do.
  TakeResult render(const std::function<void(TakenPicture)>& take, const Job& job = {});

 private:
  /// Of what a picture is.
  struct Planned {
    std::optional<std::string> variant;
    std::string animation;
    double moment_s = 0.0;      ///< from the animation's start
    double step_s = 0.0;        ///< to the next moment of it
    std::size_t viewpoint = 0;  ///< of viewpoints_
    PictureLabel label;

    bool has_same_scene(const Planned& other) const {
      return variant == other.variant && animation == other.animation && moment_s == other.moment_s;
    }
  };
  struct Viewpoints;

  std::vector<std::string> chosen_variants() const;
  void plan();
  std::size_t first_index() const { return shot_.pictures ? shot_.pictures->first - 1 : 0; }
  std::size_t end_index() const { return shot_.pictures ? shot_.pictures->last : planned_.size(); }
  double make_traceable(std::size_t index);
  Shot small_shot() const;
  void meter_traced(const Job& job);
  void meter_drawn(std::unique_ptr<raster::Drawer>& drawer, const Job& job);
  bool meters_apart() const { return shot_.pictures && !develop_.exposure && shot_.has_many_pictures(); }
  bool is_shown(std::size_t index) const { return shown_ && planned_[index].has_same_scene(planned_[*shown_]); }
  void plan_moments(const std::optional<std::string>& variant, const std::string& animation, PictureLabel label);
  Extent extent_of_all(const Scene& first);
  void load_scene();
  void choose_light(const std::string& wished);
  void choose_camera();
  void choose_views(const Extent& extent);
  Scene scene_at(const Planned& planned, double moment_s);
  std::shared_ptr<const Scene> scene_of(std::size_t index);
  std::shared_ptr<const Scene> first_scene();
  const path::FarLight& far_light();
  path::Tracer new_tracer(std::shared_ptr<const Scene> scene);
  View view_at(const Scene& scene, std::size_t index) const;
  std::map<std::string, std::string> metadata(std::size_t index, double samples_per_pixel, bool is_denoised) const;
  void hand_over(TakenPicture picture, TakeResult& result, const std::function<void(TakenPicture)>& take);
  path::Settings settings_of_trace() const;
  TakeResult trace(const std::function<void(TakenPicture)>& take, const Job& job);
  std::optional<double> step_of(std::size_t index) const;
  std::size_t next_viewpoint(std::size_t index) const;
  Image motion_of(const TakenPicture& picture);
  void complete(TakenPicture& picture);
  Film trace_one(std::size_t index, const Job& job, path::Statistics& statistics);
  Film trace_kept(std::size_t index, Job job, path::Statistics& statistics);
  void keep(const path::Picture& picture, const std::string& key) const;
  bool resume(path::Picture& picture, const std::string& key) const;
  std::shared_ptr<const PicturePart> part_of(const TakenPicture& picture) const;
  Film trace_moving(std::size_t index, const Job& job, path::Statistics& statistics);
  TakeResult draw(const std::function<void(TakenPicture)>& take, const Job& job);
  void make_drawable(std::size_t index, std::unique_ptr<raster::Drawer>& drawer, const Job& job);
  Film draw_one(std::size_t index, raster::Drawer& drawer, const Job& job, raster::Statistics& statistics);
  void warn(std::string message) const;

  Shot shot_;
  Diagnostics* diagnostics_;
  std::shared_ptr<Stage> stage_;
  Asset asset_;
  bool is_prepared_ = false;
  bool is_moving_ = false;  ///< an animation is shown
  std::vector<Planned> planned_;
  std::optional<std::size_t> camera_node_;  ///< the scene's own camera, used if no other is chosen
  bool has_own_camera_ = false;             ///< it may move
  std::optional<Ground> ground_;            ///< once a scene is there to stand on it
  std::shared_ptr<const Scene> scene_;      ///< of the first picture
  Environment environment_;
  bool has_own_light_ = false;                       ///< that is of the scene's file
  std::shared_ptr<const path::FarLight> far_light_;  ///< once something is traced
  double light_s_ = 0.0;                             ///< what it took to prepare that, until a picture counts it
  std::unique_ptr<Viewpoints> viewpoints_;
  DevelopSettings develop_;
  std::optional<path::Tracer> tracer_;        ///< of the scene that was traced last
  std::optional<std::size_t> shown_;          ///< the picture whose scene is at hand, for either engine
  std::shared_ptr<const Scene> scene_shown_;  ///< of the picture at hand
  std::optional<Checkpoint> checkpoint_;
  std::vector<std::byte> sums_;  ///< of the part at hand
  bool has_through_ = false;     ///< likewise
};

}  // namespace candela
