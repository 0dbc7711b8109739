#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "image/develop.h"
#include "image/film.h"
#include "image/job.h"
#include "path/render.h"
#include "raster/render.h"
#include "scene/scene.h"
#include "scene/view.h"

// The figures of the field, each computed when it is asked for: curves from the functions of src/shade, pictures by the
// renderers. figure_book.h writes them.

namespace candela::figures {

/// One picture of a figure, in a file of its own.
struct Panel {
  std::string file;                                 ///< its name: .svg or .png
  std::variant<std::string, DisplayImage> content;  ///< SVG, or what becomes a PNG
  std::string caption;                              ///< what is seen
  std::string error = {};                           ///< numbers printed under it: how far it is from the truth
  std::vector<std::string> scale = {};              ///< under equal parts of its width
  bool is_wide = false;                             ///< takes all columns
};

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

struct Figure {
  std::vector<std::string> text;       ///< paragraphs
  std::vector<std::string> formulas;   ///< as mathml() reads them; those of one line between semicolons
  std::vector<std::string> sources;    ///< author, year, title
  std::vector<std::string> functions;  ///< of this code that computed it
  std::vector<std::string> commands;   ///< that make parts of it, or the like
  std::vector<Panel> panels;
  int columns = 1;  ///< of panels, where the page is wide enough
  Table table;
  std::vector<std::string> left_out;  ///< what could not be made here, and why
};

/// Chapters of the book, in its order. `parameters` have pages of their own.
enum class Chapter { facets, fresnel, spheres, light, integrals, image_light, camera, models, parameters };
std::string_view chapter_title(Chapter chapter);
inline constexpr int kChapterCount = static_cast<int>(Chapter::parameters) + 1;

class FigureContext;

struct FigureInfo {
  std::string name;  ///< as on the command line, and the beginning of its files' names
  std::string title;
  Chapter chapter = Chapter::facets;
  std::function<Figure(FigureContext&)> make;
};

/// All figures by chapter.
std::vector<FigureInfo> figures();

struct FigureSettings {
  int samples = 64;     ///< per pixel of a path traced picture
  int reference = 512;  ///< of a picture that others are measured against
  float size = 1.0f;    ///< scales the width of pictures
};

/// What figures share while they are made: renderers, environments, settings.
class FigureContext {
 public:
  FigureContext(const FigureSettings& settings, const Job& job) : settings_(settings), job_(job) {}

  const FigureSettings& settings() const { return settings_; }
  /// A width or height of pixels at this size, at least 8.
  int pixels(int at_full_size) const;

  /// make_environment(), once per name.
  const Environment& environment(const std::string& name);

  /// Path traced; throws Interrupted.
  Film trace(const Scene& scene, const Environment& environment, const View& view, const path::Settings& settings,
             const shade::ShadingModel& shading = shade::shading_model_candela());
  /// Drawn by the rasterizer; none where there is no OpenGL, which is warned of once.
  std::optional<Film> draw(const Scene& scene, const Environment& environment, const View& view,
                           const raster::Settings& settings);
  bool has_opengl();
  void check_stop() const;  ///< throws Interrupted

 private:
  const FigureSettings& settings_;
  Job job_;  ///< stop and diagnostics
  std::map<std::string, Environment> environments_;
  std::shared_ptr<raster::Device> device_;
  bool is_device_tried_ = false;
};

// ----- what most figures need

/// Root of the mean squared difference over the root mean square of the reference, over the colour channels of columns
/// [begin, end); end 0 = all. Pixels that a surface covers in part in either picture, by their alpha, do not count: how
/// edges are smoothed is another matter.
double relative_error(const Image& image, const Image& reference, int begin = 0, int end = 0);
/// "12 %", "3.2 %", "0.054 %", "< 0.01 %".
std::string percent_text(double share);

/// f at `count` even steps from `low` to `high`.
std::vector<dvec2> sampled(double low, double high, int count, const std::function<double(double)>& f);

/// Least squares of log y over log x; points that have no logarithm are left out.
double logarithmic_slope(const std::vector<dvec2>& points);

/// Balls of radius 1 beside each other, as the studio's camera sees them by parallel rays, `kSphereSpacing` apart.
inline constexpr float kSphereSpacing = 2.3f;
Scene sphere_row(const std::vector<Material>& materials);
/// Sees `count` of them in a picture `count` times as wide as high.
View sphere_view(int count);

/// A square picture of each of `count` things beside each other.
Film beside(int count, const std::function<Film(int)>& picture);
/// Path traced balls, each alone in the world: none is mirrored in another, which prefiltered light does not know
/// either. `settings` are of one square picture.
Film trace_balls(FigureContext& context, const std::vector<Material>& materials, const path::Settings& settings);
/// How far each of `count` square pictures beside each other is from the truth.
std::vector<std::string> errors_of_each(const Film& film, const Film& truth, int count);

// ----- the chapters

void add_facet_figures(std::vector<FigureInfo>& list);
void add_fresnel_figures(std::vector<FigureInfo>& list);
void add_sphere_figures(std::vector<FigureInfo>& list);
void add_light_figures(std::vector<FigureInfo>& list);
void add_integral_figures(std::vector<FigureInfo>& list);
void add_image_light_figures(std::vector<FigureInfo>& list);
void add_camera_figures(std::vector<FigureInfo>& list);
void add_model_figures(std::vector<FigureInfo>& list);
/// Of several chapters: drawings by hand, terms and models on balls, points, environments and the parts of a picture.
void add_sketch_figures(std::vector<FigureInfo>& list);
void add_surface_figures(std::vector<FigureInfo>& list);
void add_sampling_figures(std::vector<FigureInfo>& list);
void add_surroundings_figures(std::vector<FigureInfo>& list);
void add_parameter_figures(std::vector<FigureInfo>& list);

}  // namespace candela::figures
