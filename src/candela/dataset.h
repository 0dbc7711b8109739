#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "candela/objects.h"
#include "candela/shot.h"

/// Pictures with what is known of them, in the formats that machine learning reads.
namespace candela {

enum class DatasetKind { masks, coco, bop, transforms };

struct DatasetInfo {
  DatasetKind kind;
  std::string_view name;  ///< on the command line
  bool has_objects;       ///< tells objects apart, so that it may hold several scenes
};
inline constexpr auto kDatasets = std::to_array<DatasetInfo>({
    {DatasetKind::masks, "masks", true},
    {DatasetKind::coco, "coco", true},
    {DatasetKind::bop, "bop", true},
    {DatasetKind::transforms, "transforms", false},
});
DatasetKind parse_dataset(std::string_view name);     ///< throws Error that lists what there is
InstanceKind parse_instances(std::string_view name);  ///< the same

/// Gives a shot the layers and masks that the data set is made of. Throws Error for what it cannot say: BOP and
/// transforms.json know no orthographic cameras.
void set_dataset(DatasetKind kind, Shot& shot);

/// A data set that is being written. Boxes are x, y, width and height in pixels, x and y of the upper left corner; a
/// pixel belongs to what is at its centre.
///
/// - masks: pictures; beside NAME.png a NAME-instance.png, 16 bits, of the instances' numbers, 0 where none is; of each
///   instance NAME-mask-N.png (255 where it is seen) and NAME-amodal-N.png (where it would be, were nothing before it);
///   objects.json with their names, boxes and counts of pixels.
/// - coco: images/ and annotations.json, cocodataset.org/#format-data ("object detection"), segmentations as compressed
///   run lengths; beyond it `amodal_bbox`, `amodal_segmentation`, `visible_fraction`.
/// - bop: github.com/thodan/bop_toolkit/blob/master/docs/bop_datasets_format.md: camera.json, models/ with
/// models_info.json
///   and, for each scene, train_pbr/NNNNNN/ with rgb, depth, mask, mask_visib, scene_camera.json, scene_gt.json and
///   scene_gt_info.json. Millimetres; a node's scale is in its model. What is skinned or morphed has the shape that it
///   has in the first picture.
/// - transforms: images/, depth/ (16 bits, millimetres, 0 where nothing is) and transforms.json as NeRFs read it.
class Dataset {
 public:
  /// Warnings go to `diagnostics`, which must outlive it.
  Dataset(DatasetKind kind, std::filesystem::path folder, InstanceKind instances, Diagnostics* diagnostics = nullptr);
  ~Dataset();
  Dataset(const Dataset&) = delete;
  Dataset& operator=(const Dataset&) = delete;

  /// The name of a scene's pictures, with a printf pattern for their number where there are several. `stem` differs
  /// from scene to scene.
  std::filesystem::path pattern(std::size_t scene, std::size_t scenes, const std::string& stem, bool has_many) const;

  /// Throws Error for cameras that the format does not know; to be called before hours of rendering.
  void check(const std::vector<View>& views) const;
  /// What a picture shows, once it is written to `file`. Pictures of a scene follow each other. Throws Error for a
  /// number that the format has no room for, and where a file cannot be written.
  void add(const TakenPicture& picture, const std::filesystem::path& file, std::size_t scene, const std::string& stem);
  /// Writes what stands for all pictures, if there are any; call it at the end, or after a stop. Throws Error.
  void finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace candela
