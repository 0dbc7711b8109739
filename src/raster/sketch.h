#pragma once

#include <memory>

#include "image/develop.h"
#include "raster/render.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace candela::raster {

/// A scene in the plain colours of its materials under a lamp at the eye: something to see while images are decoded,
/// light is baked and programs are compiled. To be used only on the thread of its device.
class Sketch {
 public:
  /// Reads meshes, nodes and factors, so that images need not be decoded (LoadOptions::decode_images).
  Sketch(const Scene& scene, std::shared_ptr<Device> device);
  ~Sketch();
  Sketch(const Sketch&) = delete;
  Sketch& operator=(const Sketch&) = delete;

  /// Throws Error without OpenGL, and where the driver runs out of memory.
  DisplayImage draw(const View& view, ivec2 size);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace candela::raster
