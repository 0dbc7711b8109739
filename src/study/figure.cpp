#include "study/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "image/metrics.h"
#include "io/demo_scenes.h"
#include "scene/environment.h"

namespace candela::study {

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
  add_facet_figures(list);
  add_fresnel_figures(list);
  add_sphere_figures(list);
  add_light_figures(list);
  add_integral_figures(list);
  add_image_light_figures(list);
  add_camera_figures(list);
  add_model_figures(list);
  add_parameter_figures(list);
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
  if (settings_.stop != nullptr && settings_.stop->load()) throw FigureStopped{};
}

Film FigureContext::trace(const Scene& scene, const Environment& environment, const View& view,
                          const path::Settings& settings) {
  check_stop();
  path::Callbacks callbacks;
  callbacks.stop = settings_.stop;
  Film film = path::render(scene, environment, view, settings, nullptr, callbacks);
  check_stop();
  return film;
}

bool FigureContext::has_opengl() {
  if (!is_session_tried_) {
    is_session_tried_ = true;
    try {
      session_ = std::make_unique<raster::Session>();
    } catch (const Error& error) {
      diagnostics_.warn("what needs OpenGL is left out: " + error.message(), error.where());
    }
  }
  return session_ != nullptr;
}

std::optional<Film> FigureContext::draw(const Scene& scene, const Environment& environment, const View& view,
                                        const raster::Settings& settings) {
  check_stop();
  if (!has_opengl()) return std::nullopt;
  Film film;
  session_->draw(scene, environment, {view}, settings, diagnostics_,
                 [&film](std::size_t, Film drawn) { film = std::move(drawn); });
  return film;
}

// ----- what most figures need

namespace {

Image columns(const Image& image, int begin, int end) {
  Image part(end - begin, image.height, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = begin; x < end; ++x) part.set_rgb(x - begin, y, image.rgb(x, y));
  }
  return part;
}

}  // namespace

double relative_error(const Image& image, const Image& reference, int begin, int end) {
  const int last = end > 0 ? end : reference.width;
  const Image truth = columns(reference, begin, last);
  const double power = mse(Image(truth.width, truth.height, 3), truth);
  return power > 0.0 ? std::sqrt(mse(columns(image, begin, last), truth) / power) : 0.0;
}

std::string percent_text(double share) { return fmt::format("{:.{}f} %", 100.0 * share, share < 0.0995 ? 1 : 0); }

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

Scene sphere_grid(const std::vector<std::vector<Material>>& rows) {
  io::SceneBuilder builder("spheres");
  const int root = builder.node("grid", -1, io::rotation_y(kAzimuthDeg));
  const Primitive shape = io::sphere(1.0f, 96);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t i = 0; i < rows[row].size(); ++i) {
      Material material = rows[row][i];
      material.name = fmt::format("ball {} {}", row, i);
      const vec3 place((static_cast<float>(i) - 0.5f * static_cast<float>(rows[row].size() - 1)) * kSphereSpacing,
                       (0.5f * static_cast<float>(rows.size() - 1) - static_cast<float>(row)) * kSphereSpacing, 0.0f);
      const std::string name = material.name;
      builder.node(name, builder.mesh(name, shape, builder.material(std::move(material))), io::translation(place),
                   root);
    }
  }
  return builder.finish("studio", 1.0f);
}

Scene sphere_row(const std::vector<Material>& materials) { return sphere_grid({materials}); }

View sphere_view(int columns, int rows) {
  View view;
  view.world_from_camera = io::rotation_y(kAzimuthDeg) * io::translation(vec3(0.0f, 0.0f, 10.0f));
  view.projection = OrthographicCamera{.xmag = 0.5f * kSphereSpacing * static_cast<float>(columns),
                                       .ymag = 0.5f * kSphereSpacing * static_cast<float>(rows)};
  return view;
}

}  // namespace candela::study
