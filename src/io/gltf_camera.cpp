#include "io/gltf_camera.h"

#include <fmt/format.h>

#include <cmath>

namespace candela::io {

namespace {

/// The planes between which a camera sees (glTF 2.0 §5.13.3 and §5.14); what makes no sense is left out.
void read_planes(const JsonView& projection, bool is_perspective, Camera& camera, Warnings& warnings) {
  const float near = projection.real_or("znear", 0.0f);
  const auto zfar = projection.find("zfar");
  const float far = zfar ? zfar->real() : kInfinity;
  const bool has_near = near > 0.0f || (near == 0.0f && (!is_perspective || !projection.find("znear")));
  if (!has_near) {
    warnings.warn(fmt::format("a znear of {} is out of range; the camera sees what is near, too", near), projection);
  } else {
    camera.near_plane = near;
  }
  if (far > camera.near_plane) {
    camera.far_plane = far;
  } else {
    warnings.warn(
        fmt::format("a zfar of {} is not beyond the znear of {}; the camera sees what is far, too", far, near),
        projection);
  }
}

/// The lens of EXT_camera_physical; how far it sees to the sides is the core's own to say.
void read_lens(const JsonView& json, Camera& camera, Warnings& warnings) {
  const auto read = [&](const char* key, float fallback) {
    const float value = json.real_or(key, fallback);
    if (value >= 0.0f && (value > 0.0f || !json.find(key))) return value;
    warnings.warn(fmt::format("a {} of {} is out of range and is left out", key, value), json);
    return 0.0f;
  };
  camera.focal_length = read("focalLength", 0.0f);
  camera.f_number = read("fStop", 0.0f);
  camera.focus_distance = read("focusDistance", 0.0f);
}

}  // namespace

Camera read_camera(const JsonView& json, Warnings& warnings) {
  Camera camera;
  camera.name = json.string_or("name");
  const std::string type = json.at("type").string();
  if (type == "perspective") {
    const JsonView perspective = json.at("perspective");
    PerspectiveCamera result;
    result.yfov = perspective.at("yfov").real();
    if (!(result.yfov > 0 && result.yfov < kPi)) throw perspective.at("yfov").error("must lie between 0 and pi");
    if (const auto ratio = perspective.find("aspectRatio")) {
      result.aspect_ratio = ratio->real();
      if (!(*result.aspect_ratio > 0)) throw ratio->error("must be positive");
    }
    camera.projection = result;
    read_planes(perspective, true, camera, warnings);
    if (const auto lens = json.extension("EXT_camera_physical")) read_lens(*lens, camera, warnings);
  } else if (type == "orthographic") {
    const JsonView orthographic = json.at("orthographic");
    OrthographicCamera result;
    // A negative value mirrors the picture; glTF 2.0 §5.12.1 asks not to write one.
    result.xmag = std::fabs(orthographic.at("xmag").real());
    result.ymag = std::fabs(orthographic.at("ymag").real());
    if (result.xmag == 0 || result.ymag == 0) throw orthographic.error("xmag and ymag must not be 0");
    camera.projection = result;
    read_planes(orthographic, false, camera, warnings);
  } else {
    throw json.at("type").error("must be perspective or orthographic");
  }
  return camera;
}

}  // namespace candela::io
