#include "files.h"

#include <fmt/format.h>
#include <fmt/printf.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "arrays.h"
#include "background.h"
#include "base/error.h"
#include "candela/dataset.h"
#include "candela/instance_view.h"
#include "image/develop.h"
#include "image/movie.h"
#include "io/camera_file.h"
#include "objects.h"
#include "picture.h"

namespace candela::python {

namespace fs = std::filesystem;

namespace {

// ----- films

/// A film that is being written, by whichever thread adds to it.
class MovieOf {
 public:
  MovieOf(fs::path path, double frame_rate) : path_(std::move(path)), frame_rate_(frame_rate) {
    // What is wrong with the name and the rate is told before anything is rendered.
    check_movie(path_, {.size = ivec2(2), .frame_rate = frame_rate_});
  }

  void add(const DisplayImage& picture) {
    run_without_lock([&] {
      const std::lock_guard lock(mutex_);
      if (is_finished_) throw Error("is finished", path_.string());
      if (writer_ == nullptr) writer_ = open_movie(path_, settings_of(picture));
      writer_->add(picture);
      ++count_;
    });
  }

  void finish() {
    run_without_lock([&] {
      const std::lock_guard lock(mutex_);
      if (std::exchange(is_finished_, true)) return;
      if (writer_ == nullptr) throw Error("no picture was added", path_.string());
      writer_->finish();
      writer_.reset();
    });
  }

  void give_up() {
    const std::lock_guard lock(mutex_);
    is_finished_ = true;
    writer_.reset();
  }

  std::size_t count() const { return count_; }
  std::string path() const { return path_.string(); }

 private:
  /// Those of a film whose first picture it is.
  MovieSettings settings_of(const DisplayImage& picture) const {
    MovieSettings settings{.size = {picture.width, picture.height}, .frame_rate = frame_rate_};
    for (std::size_t i = 3; i < picture.rgba.size() && !settings.has_alpha; i += 4) {
      settings.has_alpha = picture.rgba[i] != 255;
    }
    return settings;
  }

  fs::path path_;
  double frame_rate_;
  std::mutex mutex_;
  std::unique_ptr<MovieWriter> writer_;
  std::size_t count_ = 0;
  bool is_finished_ = false;
};

/// A picture as it is shown, or an array of bytes.
DisplayImage display_image(nb::handle source, const nb::object& exposure, const nb::object& tone_curve,
                           const nb::object& bloom, const nb::object& background) {
  if (nb::isinstance<PictureOf>(source)) {
    const auto& picture = nb::cast<const PictureOf&>(source);
    return developed(picture, develop_settings(picture, exposure, tone_curve, bloom, background));
  }
  if (!exposure.is_none() || !tone_curve.is_none() || !bloom.is_none() || !background.is_none()) {
    throw Error("is an array of bytes, which is neither exposed nor developed", "picture");
  }
  TextureImage image = read_texture(source, "picture");
  if (image.bits != 8) throw Error("is neither a Picture nor an array of uint8", "picture");
  return {.width = image.width,
          .height = image.height,
          .rgba = std::vector<std::uint8_t>(image.pixels.begin(), image.pixels.end())};
}

// ----- data sets

/// A data set that is being written, by whichever thread adds to it.
class DatasetOf {
 public:
  DatasetOf(const std::string& kind, fs::path folder, const std::string& instances)
      : kind_(parse_dataset(kind)),
        folder_(std::move(folder)),
        dataset_(std::make_unique<Dataset>(kind_, folder_, parse_instances(instances), &diagnostics_)) {
    const bool has_objects = kDatasets[static_cast<std::size_t>(kind_)].has_objects;
    if (!has_objects && parse_instances(instances) == InstanceKind::scene)
      throw Error("the format " + kind + " has no objects", "instances");
  }

  std::string add(const PictureOf& picture, const std::string& name) {
    const TakenPicture& taken = picture.live->taken;
    if (taken.scene == nullptr) throw Error("was rendered without objects=True", "picture");
    const std::string& stem = name.empty() ? taken.scene->name : name;
    fs::path file;
    Diagnostics fresh;
    run_without_lock([&] {
      const std::lock_guard lock(mutex_);
      if (dataset_ == nullptr) throw Error("is finished", folder_.string());
      dataset_->check({taken.view});
      const bool has_scenes = kind_ == DatasetKind::bop;
      const std::size_t scene = has_scenes ? scene_number(picture.live->taken_of, stem) : 0;
      const std::string pattern = dataset_->pattern(scene, 1, stem, true).string();
      file = fmt::sprintf(pattern, counts_[scene]);
      std::error_code code;
      fs::create_directories(file.parent_path(), code);
      if (code) throw Error("cannot be made: " + code.message(), file.parent_path().string());
      write_film(file, taken.film, taken.develop);
      dataset_->add(taken, file, scene, stem);
      ++counts_[scene];
      for (; told_ < diagnostics_.warnings().size(); ++told_) {
        const Diagnostic& warning = diagnostics_.warnings()[told_];
        fresh.warn(warning.message, warning.where);
      }
    });
    tell_warnings(fresh);
    return file.string();
  }

  void finish() {
    run_without_lock([&] {
      const std::lock_guard lock(mutex_);
      if (dataset_ == nullptr) return;
      const std::unique_ptr<Dataset> last = std::move(dataset_);
      last->finish();
    });
  }

 private:
  using Owner = std::weak_ptr<const void>;

  std::size_t scene_number(const Owner& owner, const std::string& stem) {
    return scenes_[owner].try_emplace(stem, scene_count_).second ? scene_count_++ : scenes_[owner][stem];
  }

  DatasetKind kind_;
  fs::path folder_;
  Diagnostics diagnostics_;
  std::size_t told_ = 0;  ///< of its warnings
  std::mutex mutex_;
  std::unique_ptr<Dataset> dataset_;  ///< until it is finished
  std::map<Owner, std::map<std::string, std::size_t>, std::owner_less<Owner>> scenes_;
  std::size_t scene_count_ = 0;
  std::map<std::size_t, int> counts_;  ///< of pictures, by scene
};

nb::object array_of(const PixelMask& mask) {
  auto* kept = new std::vector<std::uint8_t>(mask.bits.begin(), mask.bits.end());
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<std::uint8_t>*>(p); });
  const std::size_t shape[2] = {static_cast<std::size_t>(mask.size.y), static_cast<std::size_t>(mask.size.x)};
  return nb::cast(nb::ndarray<nb::numpy, bool>(kept->data(), 2, shape, owner));
}

nb::object box_object(const PixelMask& mask) {
  const auto box = box_of(mask);
  if (!box) return nb::none();
  return nb::make_tuple((*box)[0], (*box)[1], (*box)[2], (*box)[3]);
}

/// What a picture shows of its objects, by the names of SeenObject.
nb::list seen_objects(const PictureOf& picture, const std::string& instances, const std::string& name) {
  const TakenPicture& taken = picture.live->taken;
  if (taken.scene == nullptr) throw Error("was rendered without objects=True", "picture");
  const std::string& stem = name.empty() ? taken.scene->name : name;
  nb::list result;
  for_instances(taken, instances_of(*taken.scene, parse_instances(instances), stem), [&](const InstanceView& view) {
    nb::dict one;
    one["number"] = view.instance->number;
    one["name"] = view.instance->name;
    one["category"] = view.instance->category;
    one["mask"] = array_of(view.visible);
    one["amodal"] = array_of(view.amodal);
    one["box"] = box_object(view.visible);
    one["amodal_box"] = box_object(view.amodal);
    one["visible_fraction"] = view.visible_fraction();
    result.append(one);
  });
  return result;
}

// ----- lists of cameras

void write_cameras(const std::string& path, const std::vector<CameraAt>& cameras,
                   const std::optional<std::vector<std::string>>& files) {
  if (cameras.empty()) throw Error("there are none", "cameras");
  if (files && files->size() != cameras.size()) {
    throw Error(fmt::format("has {} names for {} cameras", files->size(), cameras.size()), "files");
  }
  std::vector<PosedCamera> posed;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const CameraAt& camera = cameras[i];
    if (!camera.size) throw Error(fmt::format("number {} is for pictures of no particular size", i), "cameras");
    if (*camera.size != *cameras[0].size) {
      throw Error(fmt::format("number {} is for pictures of {}x{} pixels, the first of {}x{}", i, camera.size->x,
                              camera.size->y, cameras[0].size->x, cameras[0].size->y),
                  "cameras");
    }
    posed.push_back({.name = camera.name,
                     .view = camera.view,
                     .size = camera.size,
                     .picture = files ? (*files)[i] : std::string()});
  }
  io::check_camera_file_name(path);
  io::write_cameras(path, posed, *cameras[0].size);
}

#define CANDELA_SHOWN                                                                                            \
  "exposure: str | float | None = None, tone_curve: str | None = None, bloom: float | None = None, background: " \
  "numpy.typing.ArrayLike | None = None"

void bind_movie(nb::module_& module) {
  nb::class_<MovieOf>(module, "Movie",
                      "A film that grows picture by picture: .webp and .gif by candela itself, .mp4 and .webm through "
                      "ffmpeg where it is installed. Use it in a `with`: the file appears at its end, whole, or after "
                      "an exception not at all.")
      .def(
          "__init__", [](MovieOf* self, const nb::object& path, double fps) { new (self) MovieOf(path_of(path), fps); },
          nb::arg("path"), nb::kw_only(), nb::arg("fps") = 24.0,
          nb::sig("def __init__(self, path: str | os.PathLike[str], *, fps: float = 24.0) -> None"),
          "fps: pictures per second. Raises Error where no such film can be written.")
      .def(
          "add",
          [](MovieOf& movie, const nb::object& picture, const nb::object& exposure, const nb::object& tone_curve,
             const nb::object& bloom, const nb::object& background) {
            movie.add(display_image(picture, exposure, tone_curve, bloom, background));
          },
          nb::arg("picture"), nb::kw_only(), nb::arg("exposure") = nb::none(), nb::arg("tone_curve") = nb::none(),
          nb::arg("bloom") = nb::none(), nb::arg("background") = nb::none(),
          nb::sig("def add(self, picture: Picture | numpy.typing.ArrayLike, *, " CANDELA_SHOWN ") -> None"),
          "The next picture, of the size of the first: a Picture, shown as Picture.save() would, or an array (h, w), "
          "(h, w, 3) or (h, w, 4) of uint8. Raises Error.")
      .def("finish", &MovieOf::finish, "Makes the file appear. A `with` does it.")
      .def("__len__", &MovieOf::count, "The pictures so far.")
      .def(
          "__enter__", [](nb::object self) { return self; }, nb::sig("def __enter__(self) -> Movie"))
      .def(
          "__exit__",
          [](MovieOf& movie, const nb::object& kind, const nb::object&, const nb::object&) {
            if (kind.is_none()) {
              movie.finish();
            } else {
              movie.give_up();
            }
          },
          nb::arg("kind").none(), nb::arg("error").none(), nb::arg("trace").none(),
          nb::sig("def __exit__(self, kind: object, error: object, trace: object) -> None"))
      .def("__repr__", [](const MovieOf& m) { return fmt::format("Movie('{}': {} pictures)", m.path(), m.count()); });
}

void bind_dataset(nb::module_& module) {
  nb::class_<DatasetOf>(module, "Dataset",
                        "A data set for machine learning that grows picture by picture, as `candela render --dataset` "
                        "writes it (docs/data.md). Use it in a `with`: what stands for all pictures is written at its "
                        "end.")
      .def(
          "__init__",
          [](DatasetOf* self, const std::string& kind, const nb::object& folder, const std::string& instances) {
            new (self) DatasetOf(kind, path_of(folder), instances);
          },
          nb::arg("kind"), nb::arg("folder"), nb::kw_only(), nb::arg("instances") = "node",
          nb::sig("def __init__(self, kind: str, folder: str | os.PathLike[str], *, instances: str = 'node') -> None"),
          "kind: \"coco\", \"bop\", \"transforms\" (as NeRFs read it) or \"masks\".\n"
          "instances: what an object is: every \"node\" with a mesh, its category the mesh's name, or the whole "
          "\"scene\", its category the scene's name.\n\n"
          "Raises Error.")
      .def("add", &DatasetOf::add, nb::arg("picture"), nb::kw_only(), nb::arg("name") = "",
           "Writes a picture of render(…, objects=True) and what is known of it; returns its file. name: of its scene, "
           "else Scene.name. Pictures of several scenes may be in one set; \"bop\" tells scenes apart by name and "
           "object. Raises Error for cameras that the format does not know, and where a file cannot be written.",
           nb::sig("def add(self, picture: Picture, *, name: str = '') -> str"))
      .def("finish", &DatasetOf::finish, "Writes what stands for all pictures. A `with` does it.")
      .def(
          "__enter__", [](nb::object self) { return self; }, nb::sig("def __enter__(self) -> Dataset"))
      .def(
          "__exit__",
          [](DatasetOf& dataset, const nb::object&, const nb::object&, const nb::object&) {
            dataset.finish();  // of the pictures that are there
          },
          nb::arg("kind").none(), nb::arg("error").none(), nb::arg("trace").none(),
          nb::sig("def __exit__(self, kind: object, error: object, trace: object) -> None"));
}

}  // namespace

void bind_files(nb::module_& module) {
  bind_movie(module);
  bind_dataset(module);
  module.def("seen_objects", &seen_objects, nb::arg("picture"), nb::arg("instances"), nb::arg("name"),
             nb::sig("def seen_objects(picture: Picture, instances: str, name: str) -> list[dict[str, typing.Any]]"));
  module.def(
      "run_lengths",
      [](const nb::object& source) {
        Bits bits = read_bits(source, "mask");
        const PixelMask mask{bits.size, std::move(bits.values)};
        nb::dict result;
        nb::list size;
        size.append(mask.size.y);
        size.append(mask.size.x);
        result["size"] = size;
        result["counts"] = run_lengths(mask);
        return result;
      },
      nb::arg("mask"), nb::sig("def run_lengths(mask: numpy.typing.ArrayLike) -> dict[str, typing.Any]"),
      "COCO's compressed run lengths of a mask (h, w) of bool: what a `segmentation` in its JSON is, and what "
      "pycocotools.mask takes. Raises Error.");
  module.def("write_cameras", &write_cameras, nb::arg("path"), nb::arg("cameras"), nb::arg("files").none());
}

}  // namespace candela::python
