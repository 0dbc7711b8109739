#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "candela/shot.h"
#include "candela/verdict.h"
#include "image/develop.h"
#include "math/box.h"

/// A model at one glance: pictures from four sides, what it holds, and what is wrong with it.
namespace candela {

struct PreviewSettings {
  int view_size = 320;  ///< pixels of each view, both ways
  int samples = 4;      ///< per pixel, denoised
  Engine engine = Engine::path;
  LoadOptions load = {};
  std::optional<std::string> environment = {};  ///< a name for make_environment(); empty = the scene's own choice
  check::Limits limits = {};
};

/// One of the pictures, and where it lies on the sheet.
struct PreviewView {
  std::string name;  ///< "front", "right", "top", "three-quarter"
  Orbit orbit;
  ivec2 corner{0};  ///< left upper, pixels
};

struct Preview {
  Verdict verdict;  ///< with the file's name, and its number of triangles and materials
  Box3 bounds;      ///< metres; empty if nothing has a mesh
  std::size_t vertices = 0, meshes = 0, nodes = 0, images = 0, cameras = 0, lights = 0;
  std::uint64_t image_bytes = 0;       ///< decoded
  std::vector<std::string> materials;  ///< names, empty where one has none
  std::vector<io::AnimationInfo> animations;
  std::vector<std::string> variants;
  int view_size = 0;
  std::vector<PreviewView> views;
  DisplayImage sheet;  ///< opaque
};

/// Loads a file once, judges it, and draws the sheet. Throws Error for what cannot be read, Interrupted after a stop.
Preview make_preview(const std::string& scene, const PreviewSettings& settings = {}, const Job& job = {});
/// The same without pictures and sheet.
Preview describe(const std::string& scene, const PreviewSettings& settings = {}, const Job& job = {});

/// One picture of the whole model from the front, the right and above, before nothing.
DisplayImage make_thumbnail(const std::string& scene, const PreviewSettings& settings = {}, const Job& job = {});

}  // namespace candela
