#include "recipes.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <filesystem>
#include <optional>
#include <tuple>
#include <utility>

#include "arrays.h"
#include "background.h"
#include "base/error.h"
#include "base/parallel.h"
#include "candela/bake.h"
#include "candela/difference.h"
#include "candela/verdict.h"
#include "cli/json_text.h"
#include "cli/verdict_json.h"
#include "laws/matrix.h"
#include "scene.h"

namespace candela::python {

namespace {

// ----- checks

std::string check_file(const std::string& name, const std::string& root, const nb::object& progress) {
  Verdict verdict;
  const LoadOptions options{.refuse_unknown_required = false, .root = root};
  run_in_background(progress, [&](const Job& job) { verdict = judge(name, options, job); });
  return cli::json_text(cli::verdict_json(verdict));
}

std::string check_scene(const SharedScene& scene, const nb::object& progress) {
  const std::shared_ptr<const Scene> held = scene->live.snapshot();
  Verdict verdict;
  run_in_background(progress, [&](const Job& job) {
    validate(*held);
    verdict = judge(held->name, check::CheckInput{.scene = *held}, job);
  });
  return cli::json_text(cli::verdict_json(verdict));
}

// ----- image-based light

nb::object array_of_cube(const CubeFaces& faces) {
  std::vector<float> values;
  for (const Image& face : faces) values.insert(values.end(), face.pixels.begin(), face.pixels.end());
  const auto size = static_cast<std::size_t>(faces[0].width);
  return array_of(std::move(values), {6, size, size, 3});
}

nb::object array_of_sh(const ibl::Sh& sh) {
  std::vector<float> values;
  for (const dvec3& c : sh.coefficients) {
    for (int i = 0; i < 3; ++i) values.push_back(static_cast<float>(c[i]));
  }
  return array_of(std::move(values), {sh.coefficients.size(), 3});
}

nb::dict dict_of(const ibl::Level& level) {
  nb::dict result;
  result["roughness"] = level.roughness;
  result["error_at_texels"] = level.proof.at_texels.max;
  result["error_between"] = level.proof.between.max;
  return result;
}

struct BakeArguments {
  int size, levels, irradiance_size, sh_order, samples;
  bool sheen;
  nb::object position;
};

/// Lit by an environment, or what a point of a scene sees.
nb::dict bake_light(const std::optional<EnvironmentOf>& environment, const SharedScene& scene,
                    const BakeArguments& arguments, const nb::object& progress) {
  ibl::BakeSettings settings;
  settings.size = arguments.size;
  settings.levels = arguments.levels;
  settings.sheen = arguments.sheen;
  settings.irradiance_size = arguments.irradiance_size;
  settings.sh_order = arguments.sh_order;
  check_order({.light = {.environment = "environment"}, .settings = settings});
  std::shared_ptr<const Scene> held = scene != nullptr ? scene->live.snapshot() : nullptr;
  const vec3 position = scene != nullptr ? read_vec3(arguments.position, "position") : vec3(0.0f);
  const std::shared_ptr<LiveStage> stage = the_stage();
  const std::optional<std::string> name = scene != nullptr ? scene->environment_name : std::nullopt;
  ibl::Bake bake;
  run_in_background(progress, [&](const Job& job) {
    std::shared_ptr<const Environment> light = environment ? environment->environment : nullptr;
    if (held == nullptr) {
      const LoadedLight loaded{.source = ibl::make_source(*light), .faces = {}, .is_panorama = light->map != nullptr};
      bake = candela::bake_light(loaded, settings, job);
      return;
    }
    if (light == nullptr && !name && held->image_light) light = {held, &held->image_light->environment};
    if (light == nullptr) light = stage->environment(name.value_or(default_environment(*held)));
    const JobParts parts(job, 2);
    const path::Tracer tracer(held, *light);
    const LoadedLight loaded = trace_light(tracer, position, arguments.samples, settings.size, parts.part(0));
    bake = candela::bake_light(loaded, settings, parts.part(1));
  });
  nb::dict result;
  nb::list levels, proofs, sheen;
  for (const CubeFaces& faces : bake.specular.levels) levels.append(array_of_cube(faces));
  for (const ibl::Level& level : bake.levels) proofs.append(dict_of(level));
  for (const CubeFaces& faces : bake.sheen.levels) sheen.append(array_of_cube(faces));
  result["levels"] = levels;
  result["proofs"] = proofs;
  result["sheen"] = sheen;
  result["irradiance"] = array_of_cube(bake.irradiance);
  result["irradiance_proof"] = dict_of(bake.irradiance_level);
  result["sh"] = array_of_sh(bake.sh);
  return result;
}

// ----- the laws of the materials

nb::list furnace(bool all, const nb::object& progress) {
  std::vector<laws::MatrixRow> matrix;
  run_in_background(progress, [&](const Job& job) {
    matrix = laws::law_matrix(all, job);
    if (job.is_stopped()) throw Interrupted("the laws are measured in part");
  });
  nb::list rows;
  for (const laws::MatrixRow& row : matrix) {
    nb::dict result;
    const laws::Measurement& m = row.worst;
    result["surface"] = row.group;
    result["count"] = row.surfaces;
    result["reciprocity_error"] = m.reciprocity;
    result["furnace_least"] = m.furnace.least;
    result["furnace_most"] = m.furnace.most;
    result["pdf_error"] = m.pdf;
    result["not_finite"] = m.flaws.count;
    result["kept"] = row.holds;
    rows.append(result);
  }
  return rows;
}

nb::object furnace_sheet(const nb::object& progress) {
  Image sheet;
  run_in_background(progress, [&](const Job& job) {
    sheet = laws::furnace_sheet(job);
    if (job.is_stopped()) throw Interrupted("the sheet is drawn in part");
  });
  return array_of(std::move(sheet));
}

// ----- differences

nb::dict dict_of(PictureDifference difference) {
  nb::dict result;
  nb::list layers;
  for (const LayerDifference& layer : difference.layers) {
    nb::dict one;
    one["layer"] = layer.layer;
    one["mean"] = layer.mean;
    one["max"] = layer.max;
    one["changed"] = layer.changed;
    one["broken"] = layer.broken;
    layers.append(one);
  }
  result["flip"] = difference.flip;
  result["flip_max"] = difference.flip_max;
  result["layers"] = layers;
  result["error"] = array_of(std::move(difference.error));
  return result;
}

/// An OpenEXR file of linear radiance, (h, w, 3) or (h, w, 4).
void save_array(const std::string& path, nb::handle source, const std::string& name) {
  Floats floats = read_floats(source, name, {-1, -1, -1});
  const std::size_t channels = floats.shape[2];
  if (channels != 3 && channels != 4) {
    throw Error("has " + std::to_string(channels) + " channels, not 3 or 4", name);
  }
  Film film;
  film.beauty = Image(static_cast<int>(floats.shape[1]), static_cast<int>(floats.shape[0]), 4);
  for (std::size_t i = 0; i < floats.shape[0] * floats.shape[1]; ++i) {
    for (std::size_t c = 0; c < 4; ++c) {
      film.beauty.pixels[4 * i + c] = c < channels ? floats.values[channels * i + c] : 1.0f;
    }
  }
  write_exr(path, film);
}

DifferenceSettings difference_settings(const nb::object& exposure, const std::string& tone_curve, double tolerance) {
  DifferenceSettings settings;
  if (!exposure.is_none()) settings.exposure = parse_exposure(text_of(exposure));
  settings.tone_curve = parse_tone_curve(tone_curve);
  settings.tolerance = tolerance;
  return settings;
}

}  // namespace

void bind_recipes(nb::module_& module) {
  module.def("check_file", &check_file, nb::arg("name"), nb::arg("root"), nb::arg("progress").none());
  module.def("check_scene", &check_scene, nb::arg("scene"), nb::arg("progress").none());
  module.def(
      "bake",
      [](const std::optional<EnvironmentOf>& environment, const SharedScene& scene, int size, int levels, bool sheen,
         int irradiance_size, int sh_order, const nb::object& position, int samples, const nb::object& progress) {
        return bake_light(environment, scene, {size, levels, irradiance_size, sh_order, samples, sheen, position},
                          progress);
      },
      nb::arg("environment").none(), nb::arg("scene").none(), nb::arg("size"), nb::arg("levels"), nb::arg("sheen"),
      nb::arg("irradiance_size"), nb::arg("sh_order"), nb::arg("position"), nb::arg("samples"),
      nb::arg("progress").none(),
      nb::sig("def bake(environment: Environment | None, scene: Scene | None, size: int, levels: int, sheen: bool, "
              "irradiance_size: int, sh_order: int, position: numpy.typing.ArrayLike, samples: int, progress: "
              "collections.abc.Callable[[Progress], object] | None) -> dict[str, typing.Any]"));
  module.def("furnace", &furnace, nb::arg("all"), nb::arg("progress").none(),
             nb::sig("def furnace(all: bool, progress: collections.abc.Callable[[Progress], object] | None) -> "
                     "list[dict[str, typing.Any]]"));
  module.def("furnace_sheet", &furnace_sheet, nb::arg("progress").none(),
             nb::sig("def furnace_sheet(progress: collections.abc.Callable[[Progress], object] | None) -> "
                     "numpy.typing.NDArray[numpy.float32]"));
  module.def("save_array", &save_array, nb::arg("path"), nb::arg("source"), nb::arg("name"),
             nb::sig("def save_array(path: str, source: object, name: str) -> None"));
  module.def(
      "diff_files",
      [](const std::string& first, const std::string& second, const nb::object& exposure, const std::string& tone_curve,
         double tolerance) {
        const DifferenceSettings settings = difference_settings(exposure, tone_curve, tolerance);
        PictureDifference difference;
        run_in_background(nb::none(), [&](const Job&) {
          difference = compare_pictures(parse_image_name(first), parse_image_name(second), settings);
        });
        return dict_of(std::move(difference));
      },
      nb::arg("first"), nb::arg("second"), nb::arg("exposure").none(), nb::arg("tone_curve"), nb::arg("tolerance"),
      nb::sig(
          "def diff_files(first: str, second: str, exposure: str | float | None, tone_curve: str, tolerance: float) -> "
          "dict[str, typing.Any]"));
}

}  // namespace candela::python
