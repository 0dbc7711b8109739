#include "figures/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "content/demo_scenes.h"
#include "content/make_environment.h"
#include "scene/environment.h"

namespace candela::figures {

std::string_view chapter_title(Chapter chapter) {
  constexpr std::array<std::string_view, kChapterCount> kTitles{"Facets",     "Fresnel",
                                                                "Spheres",    "Lamps",
                                                                "Integrals",  "Light from an image",
                                                                "The camera", "Models and workflows",
                                                                "Parameters"};
  return kTitles[static_cast<std::size_t>(chapter)];
}

std::vector<FigureInfo> figures() {
  std::vector<FigureInfo> list;
  add_sketch_figures(list);
  add_surface_figures(list);
  add_sampling_figures(list);
  add_surroundings_figures(list);
  add_facet_figures(list);
  add_fresnel_figures(list);
  add_sphere_figures(list);
  add_light_figures(list);
  add_integral_figures(list);
  add_image_light_figures(list);
  add_camera_figures(list);
  add_model_figures(list);
  add_parameter_figures(list);
  std::stable_sort(list.begin(), list.end(),
                   [](const FigureInfo& a, const FigureInfo& b) { return a.chapter < b.chapter; });
  return list;
}

int FigureContext::pixels(int at_full_size) const {
  return std::max(8, static_cast<int>(std::lround(static_cast<float>(at_full_size) * settings_.size)));
}

const Environment& FigureContext::environment(const std::string& name) {
  const auto found = environments_.find(name);
  return found != environments_.end() ? found->second
                                      : environments_.emplace(name, make_environment(name)).first->second;
}

void FigureContext::check_stop() const {
  if (job_.is_stopped()) throw Interrupted("while a figure was made");
}

Film FigureContext::trace(const Scene& scene, const Environment& environment, const View& view,
                          const path::Settings& settings, const shade::ShadingModel& shading) {
  check_stop();
  Film film = path::Tracer(borrowed(scene), environment, shading).render(view, settings, job_);
  check_stop();
  return film;
}

bool FigureContext::has_opengl() {
  if (!is_device_tried_) {
    is_device_tried_ = true;
    try {
      device_ = std::make_shared<raster::Device>();
    } catch (const Error& error) {
      if (job_.diagnostics != nullptr) {
        job_.diagnostics->warn("what needs OpenGL is left out: " + error.message(), error.where());
      }
    }
  }
  return device_ != nullptr;
}

std::optional<Film> FigureContext::draw(const Scene& scene, const Environment& environment, const View& view,
                                        const raster::Settings& settings) {
  check_stop();
  if (!has_opengl()) return std::nullopt;
  raster::Drawer drawer(borrowed(scene), environment, shade::shading_model_candela(), device_);
  Film film = drawer.render(view, settings, job_);
  check_stop();
  return film;
}

// ----- what most figures need

namespace {

/// Where neither picture shows a surface in part.
bool is_whole(const Image& image, int x, int y) {
  if (image.channels < 4) return true;
  const float alpha = image.at(x, y)[3];
  constexpr float kRounding = 1e-4f;
  return alpha < kRounding || alpha > 1.0f - kRounding;
}

}  // namespace

double relative_error(const Image& image, const Image& reference, int begin, int end) {
  const int last = end > 0 ? end : reference.width;
  double error = 0.0, power = 0.0;
  for (int y = 0; y < reference.height; ++y) {
    for (int x = begin; x < last; ++x) {
      if (!is_whole(image, x, y) || !is_whole(reference, x, y)) continue;
      const dvec3 truth(reference.rgb(x, y)), off = dvec3(image.rgb(x, y)) - truth;
      error += glm::dot(off, off);
      power += glm::dot(truth, truth);
    }
  }
  return power > 0.0 ? std::sqrt(error / power) : 0.0;
}

std::string percent_text(double share) {
  const double percent = 100.0 * share;
  if (percent >= 9.95) return fmt::format("{:.0f} %", percent);
  if (percent >= 0.995 || percent == 0.0) return fmt::format("{:.1f} %", percent);
  return percent < 0.01 ? "< 0.01 %" : fmt::format("{:.2g} %", percent);
}

std::vector<dvec2> sampled(double low, double high, int count, const std::function<double(double)>& f) {
  std::vector<dvec2> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double x = low + (high - low) * i / (count - 1);
    points.emplace_back(x, f(x));
  }
  return points;
}

double logarithmic_slope(const std::vector<dvec2>& points) {
  double n = 0.0;
  dvec2 mean(0.0);
  for (const dvec2 p : points) {
    if (!(p.x > 0.0) || !(p.y > 0.0)) continue;
    mean += glm::log(p);
    n += 1.0;
  }
  mean /= std::max(n, 1.0);
  double xx = 0.0, xy = 0.0;
  for (const dvec2 p : points) {
    if (!(p.x > 0.0) || !(p.y > 0.0)) continue;
    const dvec2 d = glm::log(p) - mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
  }
  return xx > 0.0 ? xy / xx : 0.0;
}

namespace {

/// The studio's lamps stand around a camera at this azimuth.
constexpr float kAzimuthDeg = 35.0f;

}  // namespace

Scene sphere_row(const std::vector<Material>& materials) {
  content::SceneBuilder builder("spheres");
  const int root = builder.node("row", -1, content::rotation_y(kAzimuthDeg));
  const Primitive shape = content::sphere(1.0f, 96);
  const auto middle = 0.5f * static_cast<float>(materials.size() - 1);
  for (std::size_t i = 0; i < materials.size(); ++i) {
    Material material = materials[i];
    material.name = fmt::format("ball {}", i);
    const std::string name = material.name;
    const vec3 place((static_cast<float>(i) - middle) * kSphereSpacing, 0.0f, 0.0f);
    builder.node(name, builder.mesh(name, shape, builder.material(std::move(material))), content::translation(place),
                 root);
  }
  return builder.finish("studio", 1.0f);
}

View sphere_view(int count) {
  View view;
  view.world_from_camera = content::rotation_y(kAzimuthDeg) * content::translation(vec3(0.0f, 0.0f, 10.0f));
  view.projection =
      OrthographicCamera{.xmag = 0.5f * kSphereSpacing * static_cast<float>(count), .ymag = 0.5f * kSphereSpacing};
  return view;
}

Film beside(int count, const std::function<Film(int)>& picture) {
  Film all;
  for (int i = 0; i < count; ++i) {
    const Image one = picture(i).beauty;
    if (all.beauty.empty()) all.beauty = Image(count * one.width, one.height, one.channels);
    for (int y = 0; y < one.height; ++y) {
      const auto* const row = one.pixels.data() + one.index(0, y);
      std::copy_n(row, one.width * one.channels, all.beauty.pixels.data() + all.beauty.index(i * one.width, y));
    }
  }
  return all;
}

Film trace_balls(FigureContext& context, const std::vector<Material>& materials, const path::Settings& settings) {
  const Environment& studio = context.environment("studio");
  return beside(static_cast<int>(materials.size()), [&](int i) {
    return context.trace(sphere_row({materials[static_cast<std::size_t>(i)]}), studio, sphere_view(1), settings);
  });
}

std::vector<std::string> errors_of_each(const Film& film, const Film& truth, int count) {
  std::vector<std::string> errors;
  errors.reserve(static_cast<std::size_t>(count));
  const int side = truth.width() / count;
  for (int i = 0; i < count; ++i) {
    errors.push_back(percent_text(relative_error(film.beauty, truth.beauty, i * side, (i + 1) * side)));
  }
  return errors;
}

}  // namespace candela::figures
