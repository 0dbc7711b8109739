#include "candela/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/named_row.h"
#include "candela/dataset_parts.h"
#include "image/image_file.h"
#include "io/camera_file.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

constexpr double kMillimetre = 1e-3;

struct InstancesInfo {
  InstanceKind kind;
  std::string_view name;
};
constexpr auto kInstanceKinds =
    std::to_array<InstancesInfo>({{InstanceKind::node, "node"}, {InstanceKind::scene, "scene"}});

Json box_json(const PixelMask& mask) {
  const auto box = box_of(mask);
  return box ? Json(*box) : Json(nullptr);
}

Json segmentation(const PixelMask& mask) {
  return {{"size", {mask.size.y, mask.size.x}}, {"counts", run_lengths(mask)}};
}

}  // namespace

DatasetKind parse_dataset(std::string_view name) { return row_named(kDatasets, name, "unknown data set").kind; }

InstanceKind parse_instances(std::string_view name) {
  return row_named(kInstanceKinds, name, "unknown kind of instances").kind;
}

void set_dataset(DatasetKind kind, Shot& shot) {
  const bool has_depth = kind == DatasetKind::bop || kind == DatasetKind::transforms;
  if (has_depth && shot.is_orthographic) throw Error("the format has no orthographic cameras", "--projection");
  if (has_depth) shot.layers.insert(Layer::depth);
  if (kind == DatasetKind::transforms) return;
  shot.layers.insert(Layer::instance);
  shot.has_masks = true;
}

void write_made(const fs::path& path, std::span<const std::byte> bytes) {
  std::error_code code;
  fs::create_directories(path.parent_path(), code);
  if (code) throw Error("cannot be made: " + code.message(), path.parent_path().string());
  write_file(path, bytes);
}

void write_json(const fs::path& path, const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  write_made(path, std::as_bytes(std::span(text)));
}

void write_mask(const fs::path& path, const PixelMask& mask) {
  std::vector<std::uint32_t> values(mask.bits.size());
  std::transform(mask.bits.begin(), mask.bits.end(), values.begin(), [](bool bit) { return bit ? 255u : 0u; });
  write_made(path, encode_grey_png(mask.size, 8, values));
}

bool write_depth(const fs::path& path, const Image& depth, double unit) {
  constexpr double kMost = 65535.0;
  bool is_too_large = false;
  std::vector<std::uint32_t> values(depth.pixels.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = std::round(static_cast<double>(depth.pixels[i]) / unit);
    if (!std::isfinite(value) || value < 0.0) continue;
    is_too_large |= value > kMost;
    if (value <= kMost) values[i] = static_cast<std::uint32_t>(value);
  }
  write_made(path, encode_grey_png({depth.width, depth.height}, 16, values));
  return is_too_large;
}

class Dataset::Impl {
 public:
  Impl(DatasetKind kind, fs::path folder, InstanceKind instances, Diagnostics* diagnostics)
      : kind_(kind), folder_(std::move(folder)), instance_kind_(instances), diagnostics_(diagnostics), bop_(folder_) {}

  fs::path pattern(std::size_t scene, std::size_t scenes, const std::string& stem, bool has_many) const {
    const std::string number = has_many ? "%06d.png" : "000000.png";
    const std::string name = scenes > 1 && kind_ != DatasetKind::bop ? stem + "-" + number : number;
    switch (kind_) {
      case DatasetKind::masks:
        return folder_ / name;
      case DatasetKind::bop:
        return BopWriter::scene_folder(folder_, scene) / "rgb" / name;
      default:
        return folder_ / "images" / name;
    }
  }

  void check(const std::vector<View>& views) const {
    if (kind_ != DatasetKind::bop && kind_ != DatasetKind::transforms) return;
    for (const View& view : views) {
      if (std::holds_alternative<OrthographicCamera>(view.projection)) {
        throw Error("the data set's format has no orthographic cameras, and the scene's is one", folder_.string());
      }
    }
  }

  void add(const TakenPicture& picture, const fs::path& file, std::size_t scene, const std::string& stem) {
    if (kind_ == DatasetKind::transforms) return add_pose(picture, file);
    const std::vector<Instance> instances = instances_of(*picture.scene, instance_kind_, stem);
    if (kind_ == DatasetKind::bop) return bop_.add(picture, file, scene, instances);
    if (kind_ == DatasetKind::coco) return add_annotations(picture, file, instances);
    add_masks(picture, file, instances, stem);
  }

  void finish() {
    switch (kind_) {
      case DatasetKind::masks:
        if (pictures_.empty()) return;
        return write_json(folder_ / "objects.json", {{"pictures", pictures_}});
      case DatasetKind::coco:
        if (pictures_.empty()) return;
        return write_json(folder_ / "annotations.json",
                          {{"info", {{"description", std::string("rendered by Candela ") + version()}}},
                           {"licenses", Json::array()},
                           {"images", pictures_},
                           {"annotations", annotations_},
                           {"categories", categories_}});
      case DatasetKind::bop:
        return bop_.finish();
      case DatasetKind::transforms:
        if (!cameras_.empty()) io::write_cameras(folder_ / "transforms.json", cameras_, *cameras_[0].size);
    }
  }

 private:
  static fs::path beside(const fs::path& file, const std::string& ending) {
    return file.parent_path() / (file.stem().string() + ending + ".png");
  }

  std::string name_of(const fs::path& file) const { return file.lexically_relative(folder_).generic_string(); }

  void add_masks(const TakenPicture& picture, const fs::path& file, const std::vector<Instance>& all,
                 const std::string& stem) {
    constexpr std::uint32_t kMost = 65535;
    const ivec2 size(picture.film.width(), picture.film.height());
    std::vector<std::uint32_t> numbers(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
    Json instances = Json::array();
    for_instances(picture, all, [&](const InstanceView& view) {
      const std::uint32_t number = view.instance->number;
      if (number > kMost)
        throw Error("an instance's number is above what 16 bits hold: " + std::to_string(number), stem);
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (view.visible.bits[i]) numbers[i] = number;
      }
      write_mask(beside(file, fmt::format("-mask-{}", number)), view.visible);
      write_mask(beside(file, fmt::format("-amodal-{}", number)), view.amodal);
      instances.push_back({{"instance", number},
                           {"name", view.instance->name},
                           {"category", view.instance->category},
                           {"pixels", count(view.visible)},
                           {"box", box_json(view.visible)},
                           {"amodal_pixels", count(view.amodal)},
                           {"amodal_box", box_json(view.amodal)},
                           {"visible_fraction", view.visible_fraction()}});
    });
    write_made(beside(file, "-instance"), encode_grey_png(size, 16, numbers));
    pictures_.push_back(
        {{"file", name_of(file)}, {"width", size.x}, {"height", size.y}, {"scene", stem}, {"instances", instances}});
  }

  int category(const std::string& name) {
    const auto [found, is_new] = category_numbers_.try_emplace(name, static_cast<int>(category_numbers_.size()) + 1);
    if (is_new) categories_.push_back({{"id", found->second}, {"name", name}, {"supercategory", ""}});
    return found->second;
  }

  void add_annotations(const TakenPicture& picture, const fs::path& file, const std::vector<Instance>& instances) {
    const std::size_t image = pictures_.size() + 1;
    pictures_.push_back({{"id", image},
                         {"file_name", name_of(file)},
                         {"width", picture.film.width()},
                         {"height", picture.film.height()}});
    for_instances(picture, instances, [&](const InstanceView& view) {
      const int number = category(view.instance->category);
      if (count(view.visible) == 0) return;
      annotations_.push_back({{"id", annotations_.size() + 1},
                              {"image_id", image},
                              {"category_id", number},
                              {"segmentation", segmentation(view.visible)},
                              {"area", count(view.visible)},
                              {"bbox", box_json(view.visible)},
                              {"iscrowd", 0},
                              {"amodal_segmentation", segmentation(view.amodal)},
                              {"amodal_bbox", box_json(view.amodal)},
                              {"visible_fraction", view.visible_fraction()},
                              {"instance", view.instance->number},
                              {"name", view.instance->name}});
    });
  }

  void add_pose(const TakenPicture& picture, const fs::path& file) {
    const fs::path depth = folder_ / "depth" / file.filename();
    if (write_depth(depth, picture.film.layers.at(Layer::depth), kMillimetre) && diagnostics_ != nullptr &&
        !has_told_) {
      diagnostics_->warn("depths beyond 65.535 m are written as 0, unknown", depth.string());
      has_told_ = true;
    }
    cameras_.push_back({.name = file.stem().string(),
                        .view = picture.view,
                        .size = ivec2(picture.film.width(), picture.film.height()),
                        .picture = name_of(file),
                        .depth = name_of(depth)});
  }

  DatasetKind kind_;
  fs::path folder_;
  InstanceKind instance_kind_;
  Diagnostics* diagnostics_;
  BopWriter bop_;
  Json pictures_ = Json::array(), annotations_ = Json::array(), categories_ = Json::array();
  std::map<std::string, int> category_numbers_;
  std::vector<PosedCamera> cameras_;
  bool has_told_ = false;
};

Dataset::Dataset(DatasetKind kind, fs::path folder, InstanceKind instances, Diagnostics* diagnostics)
    : impl_(std::make_unique<Impl>(kind, std::move(folder), instances, diagnostics)) {}

Dataset::~Dataset() = default;

fs::path Dataset::pattern(std::size_t scene, std::size_t scenes, const std::string& stem, bool has_many) const {
  return impl_->pattern(scene, scenes, stem, has_many);
}

void Dataset::check(const std::vector<View>& views) const { impl_->check(views); }

void Dataset::add(const TakenPicture& picture, const fs::path& file, std::size_t scene, const std::string& stem) {
  impl_->add(picture, file, scene, stem);
}

void Dataset::finish() { impl_->finish(); }

}  // namespace candela
