#include "picture.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "arrays.h"
#include "background.h"
#include "base/error.h"
#include "cli/values.h"
#include "image/develop.h"
#include "image/png_bytes.h"
#include "io/camera_file.h"

namespace candela::python {

namespace {

/// Axes right, down, forwards in place of right, up, backwards, or the other way round.
glm::dmat4 with_turned_axes(glm::dmat4 world_from_camera) {
  world_from_camera[1] = -world_from_camera[1];
  world_from_camera[2] = -world_from_camera[2];
  return world_from_camera;
}

bool is_opencv(const std::string& axes) {
  if (axes == "opencv") return true;
  if (axes == "opengl") return false;
  throw Error("is neither \"opencv\" nor \"opengl\": \"" + axes + "\"", "axes");
}

ivec2 size_of(const CameraAt& camera) {
  if (!camera.size) throw Error("this camera is for pictures of no particular size");
  return *camera.size;
}

CameraAt make_pinhole(nb::handle k, nb::handle world_from_camera, std::pair<int, int> size, const std::string& axes) {
  if (size.first < 1 || size.second < 1) throw Error("is not positive", "size");
  glm::dmat4 pose = read_transform(world_from_camera, "world_from_camera");
  if (is_opencv(axes)) pose = with_turned_axes(pose);
  CameraAt camera;
  camera.size = ivec2(size.first, size.second);
  try {
    pose = glm::dmat4(rigid_part(pose));
  } catch (const Error& error) {
    throw Error(error.what(), "world_from_camera");
  }
  camera.view = view_of_matrix({.k = read_matrix3(k, "K"), .size = *camera.size}, mat4(pose));
  return camera;
}

nb::object pose_of(const CameraAt& camera, const std::string& axes) {
  glm::dmat4 pose(camera.view.world_from_camera);
  if (std::holds_alternative<PerspectiveCamera>(camera.view.projection)) {
    pose = matrix_of_view(camera.view, camera.size.value_or(ivec2(1))).world_from_camera;
  }
  return array_of(is_opencv(axes) ? with_turned_axes(pose) : pose);
}

std::filesystem::path path_of(const nb::object& path) {
  return nb::cast<std::string>(nb::module_::import_("os").attr("fspath")(path));
}

Film& film_of(const PictureOf& picture) { return picture.live->taken.film; }

/// "beauty", the layers, "noisy", "through": by the names of an EXR file.
std::vector<std::pair<std::string, Image*>> images_of(const PictureOf& picture) {
  Film& film = film_of(picture);
  std::vector<std::pair<std::string, Image*>> images = {{"beauty", &film.beauty}};
  for (auto& [layer, image] : film.layers) images.emplace_back(layer_name(layer), &image);
  if (!film.noisy.empty()) images.emplace_back("noisy", &film.noisy);
  if (!film.through.empty()) images.emplace_back("through", &film.through);
  return images;
}

std::vector<std::string> names_of(const PictureOf& picture) {
  std::vector<std::string> names;
  for (const auto& [name, image] : images_of(picture)) names.push_back(name);
  return names;
}

nb::object layer_of(const PictureOf& picture, const std::string& name) {
  std::string known;
  for (const auto& [is_called, image] : images_of(picture)) {
    if (is_called == name) return array_of(*image, picture.live);
    known += (known.empty() ? "" : ", ") + is_called;
  }
  throw nb::key_error(("the picture has no \"" + name + "\"; it has: " + known).c_str());
}

}  // namespace

DevelopSettings develop_settings(const PictureOf& picture, const nb::object& exposure, const nb::object& tone_curve,
                                 const nb::object& bloom, const nb::object& background) {
  DevelopSettings settings = picture.live->taken.develop;
  if (!exposure.is_none()) settings.exposure = parse_exposure(text_of(exposure));
  if (!tone_curve.is_none()) settings.tone_curve = parse_tone_curve(text_of(tone_curve));
  if (!bloom.is_none()) {
    settings.bloom = nb::cast<float>(bloom);
    if (!(settings.bloom >= 0.0f && settings.bloom <= 1.0f)) throw Error("lies outside 0 to 1", "bloom");
  }
  if (!background.is_none()) settings.background = read_color(background, "background");
  return settings;
}

DisplayImage developed(const PictureOf& picture, const DevelopSettings& settings) {
  DisplayImage image;
  run_without_lock([&] { image = develop(film_of(picture), settings); });
  return image;
}

namespace {

nb::bytes png_of(const PictureOf& picture) {
  const DisplayImage shown = developed(picture, picture.live->taken.develop);
  const std::vector<std::byte> bytes = encode_png(shown);
  return nb::bytes(bytes.data(), bytes.size());
}

nb::dict statistics_of(const PictureOf& picture) {
  const TakenPicture& taken = picture.live->taken;
  nb::dict result;
  const bool is_traced = taken.traced.samples > 0;
  if (is_traced) {
    const path::Statistics& s = taken.traced;
    result["build_seconds"] = s.build_s;
    result["render_seconds"] = s.render_s;
    result["samples_per_pixel"] = s.mean_samples_per_pixel;
    result["rays"] = s.camera_rays + s.bounce_rays + s.shadow_rays;
    result["triangles"] = s.triangles;
    result["non_finite_samples"] = s.non_finite_samples;
    if (s.noise) result["share_above_noise"] = s.noise->share_above;
    if (taken.is_denoised) result["denoise_seconds"] = taken.denoise_s;
  } else {
    const raster::Statistics& s = taken.drawn;
    result["driver"] = s.driver;
    result["open_seconds"] = s.open_s;
    result["light_seconds"] = s.light_s;
    result["upload_seconds"] = s.upload_s;
    result["compile_seconds"] = s.compile_s;
    result["frame_seconds"] = s.frame_s;
    result["frames"] = s.frames;
    result["triangles"] = s.triangles;
    result["non_finite_pixels"] = s.non_finite_pixels;
  }
  return result;
}

void bind_camera(nb::module_& module) {
  nb::class_<CameraAt>(module, "PosedCamera",
                       "A camera that stands somewhere. Pixels are counted from the picture's upper left corner, with "
                       "the middle of the first at (0.5, 0.5).")
      .def_ro("name", &CameraAt::name, "May be empty.")
      .def_prop_ro(
          "size", [](const CameraAt& c) { return std::pair(size_of(c).x, size_of(c).y); },
          "(width, height) of its pictures.", nb::sig("def size(self) -> tuple[int, int]"))
      .def_prop_ro(
          "K", [](const CameraAt& c) { return array_of(matrix_of_view(c.view, size_of(c)).matrix.k); },
          "(3, 3) float64: x = K (X / Z), pixels, with X along the axes right, down, forwards. Raises Error for an "
          "orthographic camera.",
          nb::sig("def K(self) -> numpy.typing.NDArray[numpy.float64]"))
      .def_prop_ro(
          "world_from_camera", [](const CameraAt& c) { return pose_of(c, "opencv"); },
          "(4, 4) float64, metres, rigid: the axes right, down, forwards (OpenCV's) and the place, in columns.",
          nb::sig("def world_from_camera(self) -> numpy.typing.NDArray[numpy.float64]"))
      .def("pose", &pose_of, nb::arg("axes") = "opengl",
           "(4, 4) float64: world from camera with the axes of \"opengl\" (right, up, backwards) or \"opencv\".",
           nb::sig("def pose(self, axes: str = 'opengl') -> numpy.typing.NDArray[numpy.float64]"))
      .def_prop_ro("is_orthographic",
                   [](const CameraAt& c) { return std::holds_alternative<OrthographicCamera>(c.view.projection); })
      .def("__repr__", [](const CameraAt& c) {
        const vec3 p(c.view.world_from_camera[3]);
        return "PosedCamera(at (" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) +
               "))";
      });
  module.def(
      "pinhole", &make_pinhole, nb::arg("K"), nb::arg("world_from_camera"), nb::arg("size"), nb::arg("axes") = "opencv",
      nb::sig("def pinhole(K: numpy.typing.ArrayLike, world_from_camera: numpy.typing.ArrayLike, size: tuple[int, "
              "int], axes: str = 'opencv') -> PosedCamera"),
      "A camera of the computer vision kind, for pictures of `size` (width, height).\n\n"
      "K: (3, 3), pixels, [fx s cx; 0 fy cy; 0 0 1]; the axis may be anywhere, pixels need not be square.\n"
      "world_from_camera: (4, 4), rigid, metres.\n"
      "axes: of the camera in it: \"opencv\" (right, down, forwards) or \"opengl\" (right, up, backwards).\n\n"
      "Raises Error for a matrix that is none.");
  module.def(
      "read_cameras",
      [](const std::string& path, std::pair<int, int> size) {
        std::vector<CameraAt> cameras;
        const ivec2 wanted(size.first, size.second);
        for (PosedCamera& camera : io::read_cameras(path, wanted)) {
          cameras.push_back({std::move(camera.name), camera.view, camera.size.value_or(wanted)});
        }
        return cameras;
      },
      nb::arg("path"), nb::arg("size"));
}

}  // namespace

void bind_picture(nb::module_& module) {
  bind_camera(module);
  nb::class_<PictureOf>(
      module, "Picture",
      "A picture: linear Rec.709 radiance and layers, by name. Arrays share the picture's memory: what "
      "is written into \"beauty\" is in the files that are saved afterwards.")
      .def_prop_ro("names", &names_of, "\"beauty\", then the layers; \"noisy\" where it was denoised.")
      .def("__getitem__", &layer_of, nb::arg("name"),
           nb::sig("def __getitem__(self, name: str) -> numpy.typing.NDArray[numpy.float32]"),
           "float32, (h, w) or (h, w, channels), row 0 at the top. \"beauty\": (h, w, 4), premultiplied by alpha. "
           "\"depth\": (h, w), metres along the camera's axis, inf where nothing is. \"id\": (h, w), 1 + number of the "
           "node, 0 = "
           "nothing. \"normal\": (h, w, 3), world space, unit. \"position\": (h, w, 3), metres. Raises KeyError.")
      .def("__contains__",
           [](const PictureOf& p, const std::string& name) {
             const std::vector<std::string> names = names_of(p);
             return std::find(names.begin(), names.end(), name) != names.end();
           })
      .def("__len__", [](const PictureOf& p) { return names_of(p).size(); })
      .def(
          "__iter__", [](const PictureOf& p) { return nb::iter(nb::cast(names_of(p))); },
          nb::sig("def __iter__(self) -> typing.Iterator[str]"))
      .def_prop_ro(
          "size", [](const PictureOf& p) { return std::pair(p.size.x, p.size.y); }, "(width, height), pixels.",
          nb::sig("def size(self) -> tuple[int, int]"))
      .def_prop_ro(
          "camera",
          [](const PictureOf& p) {
            return CameraAt{"", p.live->view, p.size};
          },
          "The camera that it was taken through, for another render() as well.")
      .def_prop_ro(
          "metadata", [](const PictureOf& p) { return film_of(p).metadata; },
          "Scene, camera, environment, samples, version…, as EXR files have them.")
      .def_prop_ro("statistics", &statistics_of, "Times and counts of the engine that made it.",
                   nb::sig("def statistics(self) -> dict[str, typing.Any]"))
      .def_prop_ro(
          "is_complete", [](const PictureOf& p) { return p.live->taken.is_whole(); },
          "False where a progress callback stopped it on the way.")
      .def_prop_ro("is_denoised", [](const PictureOf& p) { return p.live->taken.is_denoised; })
      .def(
          "save",
          [](const PictureOf& p, const nb::object& path, const nb::object& exposure, const nb::object& tone_curve,
             const nb::object& bloom, const nb::object& background) {
            const std::filesystem::path to = path_of(path);
            check_output_extension(to);
            const DevelopSettings settings = develop_settings(p, exposure, tone_curve, bloom, background);
            run_without_lock([&] { write_film(to, film_of(p), settings); });
          },
          nb::arg("path"), nb::kw_only(), nb::arg("exposure") = nb::none(), nb::arg("tone_curve") = nb::none(),
          nb::arg("bloom") = nb::none(), nb::arg("background") = nb::none(),
          nb::sig(
              "def save(self, path: str | os.PathLike[str], *, exposure: str | float | None = None, tone_curve: str | "
              "None = None, bloom: float | None = None, background: numpy.typing.ArrayLike | None = None) -> None"),
          "Writes .png, .jpg or .webp as it is shown, or .exr (with all layers) or .hdr, which stay linear; whole or "
          "not "
          "at all. None: as render() was told. Raises Error.\n\n"
          "exposure: \"auto\" (metered), stops, or \"f/8,1/125,100\".\n"
          "tone_curve: \"pbr-neutral\", \"agx\", \"aces\", \"reinhard\", \"hable\", \"exponential\", \"linear\".\n"
          "bloom: share of the light that the lens scatters, 0 to 1.\n"
          "background: what shows through where the picture is transparent.")
      .def(
          "to_png",
          [](const PictureOf& p, const nb::object& path, const nb::object& exposure, const nb::object& tone_curve,
             const nb::object& bloom, const nb::object& background) {
            const std::filesystem::path to = path_of(path);
            const DisplayImage image = developed(p, develop_settings(p, exposure, tone_curve, bloom, background));
            run_without_lock([&] { write_png(to, image); });
          },
          nb::arg("path"), nb::kw_only(), nb::arg("exposure") = nb::none(), nb::arg("tone_curve") = nb::none(),
          nb::arg("bloom") = nb::none(), nb::arg("background") = nb::none(),
          nb::sig(
              "def to_png(self, path: str | os.PathLike[str], *, exposure: str | float | None = None, tone_curve: str "
              "| None = None, bloom: float | None = None, background: numpy.typing.ArrayLike | None = None) -> None"),
          "Writes a PNG, whatever the name ends with. Arguments as of save().")
      .def(
          "develop",
          [](const PictureOf& p, const nb::object& exposure, const nb::object& tone_curve, const nb::object& bloom,
             const nb::object& background) {
            DisplayImage image = developed(p, develop_settings(p, exposure, tone_curve, bloom, background));
            return array_of_bytes(std::move(image.rgba), {static_cast<std::size_t>(image.height),
                                                          static_cast<std::size_t>(image.width), std::size_t{4}});
          },
          nb::kw_only(), nb::arg("exposure") = nb::none(), nb::arg("tone_curve") = nb::none(),
          nb::arg("bloom") = nb::none(), nb::arg("background") = nb::none(),
          nb::sig(
              "def develop(self, *, exposure: str | float | None = None, tone_curve: str | None = None, bloom: float "
              "| None = None, background: numpy.typing.ArrayLike | None = None) -> numpy.typing.NDArray[numpy.uint8]"),
          "As it is shown: (h, w, 4) uint8, sRGB, straight alpha. Arguments as of save().")
      .def("_repr_png_", &png_of)
      .def("__repr__", [](const PictureOf& p) {
        std::string names;
        for (const std::string& name : names_of(p)) names += (names.empty() ? "" : ", ") + name;
        return "Picture(" + std::to_string(p.size.x) + "x" + std::to_string(p.size.y) + ": " + names + ")";
      });
}

}  // namespace candela::python
