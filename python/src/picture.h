#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <optional>
#include <string>

#include "candela/live_scene.h"
#include "image/develop.h"
#include "scene/posed_camera.h"

namespace candela::python {

namespace nb = nanobind;

/// A camera that stands somewhere: K and pose where it is a pinhole.
struct CameraAt {
  std::string name;
  View view;
  std::optional<ivec2> size;  ///< of the pictures that it is for
};

/// What render() returns. Arrays that are handed out share its pixels, and keep them alive.
struct PictureOf {
  std::shared_ptr<LivePicture> live;
  ivec2 size;
};

/// How the picture is shown: as it was asked for, unless it is said otherwise here; None = not.
DevelopSettings develop_settings(const PictureOf& picture, const nb::object& exposure, const nb::object& tone_curve,
                                 const nb::object& bloom, const nb::object& background);
DisplayImage developed(const PictureOf& picture, const DevelopSettings& settings);

void bind_picture(nb::module_& module);

}  // namespace candela::python
