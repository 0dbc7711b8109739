#include "candela/preview.h"

#include <memory>
#include <utility>

#include "candela/preview_sheet.h"
#include "content/make_environment.h"
#include "denoise/denoise.h"
#include "scene/framing.h"

namespace candela {

namespace {

constexpr float kYfov = radians(30.0f);  // long enough for sides to look like sides

std::vector<PreviewView> preview_views() {
  std::vector<PreviewView> views;
  for (const char* name : {"front", "right", "top", "three-quarter"}) views.push_back({name, named_orbit(name)});
  return views;
}

/// Pictures of one scene by either engine, before nothing.
class ModelPictures {
 public:
  ModelPictures(std::shared_ptr<const Scene> scene, const PreviewSettings& settings)
      : scene_(std::move(scene)), settings_(settings), extent_(*scene_) {
    const Environment light = settings.environment ? make_environment(*settings.environment) : default_light(*scene_);
    develop_ = default_develop(*scene_, light);
    if (settings.engine == Engine::path) {
      tracer_.emplace(scene_, light);
    } else {
      drawer_ = std::make_unique<raster::Drawer>(scene_, light);
    }
  }

  /// Where it is best seen from.
  Orbit default_orbit() const { return candela::default_orbit(*scene_, extent_.bounds()); }

  /// All have one exposure, that of the first.
  DisplayImage picture(const Orbit& orbit, const std::optional<vec3>& background, const Job& job) {
    const View view = frame(extent_, {.orbit = orbit, .yfov = kYfov});
    const Film film = tracer_ ? traced(view, job) : drawn(view, job);
    if (job.is_stopped()) throw Interrupted("the pictures are not done");
    if (!develop_.exposure) develop_.exposure = metered_exposure(film);
    develop_.background = background;
    return develop(film, develop_);
  }

 private:
  Film traced(const View& view, const Job& job) const {
    path::Settings s;
    s.width = s.height = settings_.view_size;
    s.samples = settings_.samples;
    s.background = Background::transparent;
    s.has_features = true;
    Film film = tracer_->render(view, s, job);
    denoise::denoise(film, denoise::Method::regression, job);
    return film;
  }
  Film drawn(const View& view, const Job& job) {
    raster::Settings s;
    s.width = s.height = settings_.view_size;
    s.background = Background::transparent;
    return drawer_->render(view, s, job);
  }

  std::shared_ptr<const Scene> scene_;
  const PreviewSettings& settings_;
  Extent extent_;
  DevelopSettings develop_;
  std::optional<path::Tracer> tracer_;
  std::unique_ptr<raster::Drawer> drawer_;
};

void check_engine(const PreviewSettings& settings) {
  settings.engine == Engine::path ? path::check_built() : raster::check_built();
}

LoadOptions load_options(const PreviewSettings& settings) {
  LoadOptions options = settings.load;
  options.counts_texture_levels |= settings.engine == Engine::raster;
  return options;
}

void count(const Scene& scene, Preview& preview) {
  preview.bounds = world_bounds(scene);
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) preview.vertices += primitive.positions.size();
  }
  for (const auto& image : scene.images) preview.image_bytes += image->pixels.size();
  for (const Material& material : scene.materials) preview.materials.push_back(material.name);
  preview.meshes = scene.meshes.size();
  preview.nodes = scene.nodes.size();
  preview.images = scene.images.size();
  preview.cameras = scene.cameras.size();
  preview.lights = scene.lights.size();
}

Preview described(JudgedScene& judged) {
  Preview preview;
  preview.verdict = std::move(judged.verdict);
  preview.animations = std::move(judged.info.animations);
  preview.variants = std::move(judged.info.variants);
  count(judged.scene, preview);
  return preview;
}

}  // namespace

Preview describe(const std::string& scene, const PreviewSettings& settings, const Job& job) {
  JudgedScene judged = judge_scene(scene, settings.load, job, settings.limits);
  return described(judged);
}

Preview make_preview(const std::string& scene, const PreviewSettings& settings, const Job& job) {
  constexpr vec3 kPaper(0.8f);
  check_engine(settings);
  const std::vector<PreviewView> views = preview_views();
  const JobParts parts(job, views.size() + 1);
  JudgedScene judged = judge_scene(scene, load_options(settings), parts.part(0, "judging, "), settings.limits);
  Preview preview = described(judged);
  preview.view_size = settings.view_size;
  preview.views = views;
  ModelPictures pictures_of(std::make_shared<const Scene>(std::move(judged.scene)), settings);
  std::vector<DisplayImage> pictures;
  // What fills the picture most says most of its light.
  for (std::size_t i = 0; i < views.size(); ++i) {
    pictures.push_back(pictures_of.picture(views[i].orbit, kPaper, parts.part(i + 1, views[i].name + ", ")));
  }
  lay_out_sheet(pictures, preview);
  return preview;
}

DisplayImage make_thumbnail(const std::string& scene, const PreviewSettings& settings, const Job& job) {
  check_engine(settings);
  ModelPictures pictures_of(std::make_shared<const Scene>(load(scene, job.diagnostics, load_options(settings))),
                            settings);
  return pictures_of.picture(pictures_of.default_orbit(), std::nullopt, job);
}

}  // namespace candela
