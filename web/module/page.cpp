#include "page.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace candela::web {

namespace {

/// Of all materials' pictures, with their smaller levels: a page has 4 GiB for everything.
constexpr std::uint64_t kTextureMemory = std::uint64_t{1} << 30;
/// Light that was baked once stays, for the next scene and for a context that has to be made again.
constexpr const char* kCache = "/light";

LoadOptions load_options(const std::string& path, const std::string& variant) {
  return {.variant = variant,
          .root = std::filesystem::path(path).parent_path(),
          .texture_memory = kTextureMemory,
          .counts_texture_levels = true};
}

}  // namespace

void Page::load(const std::string& path, const std::string& variant) {
  Diagnostics told;
  Asset asset(path, &told, path.starts_with("demo:") ? LoadOptions{.variant = variant} : load_options(path, variant));
  auto scene = std::make_shared<const Scene>(asset.scene());
  Environment environment = environment_name_.empty() ? default_light(*scene, &told) : *environment_;
  Extent extent(*scene);
  const std::optional<std::size_t> camera = default_camera(*scene, 1.0f, &told);
  // From here on nothing fails.
  drawer_.reset();
  path_ = path;
  asset_ = std::move(asset);
  scene_ = at_rest_ = std::move(scene);
  extent_ = std::move(extent);
  camera_ = camera;
  environment_ = std::move(environment);
  develop_ = default_develop(*scene_, *environment_);
  metered_.reset();
  framed_aspect_ = 0.0f;
  diagnostics_ = std::move(told);
  told_ = 0;
}

void Page::set_environment(const std::string& name) {
  if (!name.empty()) {
    environment_ = make_environment(name, &diagnostics_);
  } else if (scene_ != nullptr) {
    environment_ = default_light(*scene_, &diagnostics_);
  }
  environment_name_ = name;
  if (scene_ == nullptr) return;
  develop_ = default_develop(*scene_, *environment_);
  metered_.reset();
  drawer_.reset();
}

void Page::set_variant(const std::string& variant) {
  auto scene = std::make_shared<const Scene>(asset_->scene(std::nullopt, variant));
  scene_ = at_rest_ = std::move(scene);
  extent_.emplace(*at_rest_);
  framed_aspect_ = 0.0f;
  metered_.reset();
  drawer_.reset();
}

void Page::set_pose(const std::optional<Pose>& pose) {
  scene_ = pose ? std::make_shared<const Scene>(asset_->scene(pose)) : at_rest_;
  if (drawer_ != nullptr) drawer_->set_scene(scene_);
}

raster::Drawer& Page::drawer() {
  if (drawer_ == nullptr) {
    if (device_ == nullptr) device_ = raster::Device::of_current_context();
    drawer_ = std::make_unique<raster::Drawer>(scene_, *environment_, shade::shading_model_candela(), device_);
  }
  return *drawer_;
}

raster::Settings Page::settings(ivec2 size) const {
  raster::Settings settings;
  settings.width = size.x;
  settings.height = size.y;
  settings.cache = kCache;
  return settings;
}

/// At first as `candela render` has it; then around the subject, at the same distance however wide it is from there.
View Page::view(const Look& look) {
  const float aspect = static_cast<float>(look.size.x) / static_cast<float>(look.size.y);
  if (framed_aspect_ != aspect) {
    framed_ = frame(*extent_, {.orbit = default_orbit(*at_rest_, extent_->bounds()), .aspect = aspect});
    framed_aspect_ = aspect;
  }
  const vec3 center = extent_->empty() ? vec3(0.0f) : extent_->bounds().center();
  orbit_ = default_orbit(*at_rest_, extent_->bounds());
  orbit_.azimuth = look.sight.azimuth.value_or(orbit_.azimuth);
  orbit_.elevation = look.sight.elevation.value_or(orbit_.elevation);
  orbit_.distance_scale = look.sight.distance_scale.value_or(1.0f);
  if (look.sight.distance) {
    const float framed = glm::distance(vec3(framed_.world_from_camera[3]), center);
    orbit_.distance_scale = *look.sight.distance / framed;
  }
  if (!look.sight.is_given() && camera_) return scene_camera(*scene_, scene_->nodes[*camera_], aspect);
  return moved_to(framed_, center, orbit_);
}

void Page::draw(const Look& look) {
  drawer().draw_frame(view(look), settings(look.size), {.diagnostics = &diagnostics_});
  std::optional<float> exposure = look.is_metered ? metered_ : look.exposure ? look.exposure : develop_.exposure;
  if (!exposure) {
    if (!metered_) metered_ = metered_exposure(drawer().read_frame());
    exposure = metered_;
  }
  drawer().present(look.size, *exposure, look.tone_curve);
}

DisplayImage Page::picture(const Look& look, int frames) {
  raster::Settings used = settings(look.size);
  used.frames = frames;
  const Film film = drawer().render(view(look), used, {.diagnostics = &diagnostics_});
  DevelopSettings develop = develop_;
  if (look.exposure) develop.exposure = look.exposure;
  if (look.is_metered) develop.exposure.reset();
  if (!develop.exposure) develop.exposure = metered_;
  develop.tone_curve = look.tone_curve;
  return candela::develop(film, develop);
}

Verdict Page::verdict() const {
  if (path_.starts_with("demo:")) return judge(path_);
  return judge(path_, LoadOptions{.root = std::filesystem::path(path_).parent_path()});
}

BakeResult Page::bake(const std::filesystem::path& folder, BakeOrder order) const {
  order.light.environment = environment_name_.empty() ? default_environment(*scene_) : environment_name_;
  BakeResult result = candela::bake(order);
  write_bake_files(folder, result);
  return result;
}

std::vector<std::string> Page::take_warnings() {
  std::vector<std::string> texts;
  for (; told_ < diagnostics_.warnings().size(); ++told_) texts.push_back(diagnostics_.warnings()[told_].text());
  return texts;
}

void Page::forget_drawing() {
  drawer_.reset();
  device_.reset();
}

}  // namespace candela::web
