#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "candela/shot.h"

/// From where the pictures of a shot are taken.
namespace candela {

struct Viewpoint {
  View view;
  std::string description;  ///< for the metadata
};

/// What the names of a shot's viewpoints have in place of {view} or {camera}, one for each without its turns; one empty
/// pair where there is only one that has no name.
struct ViewpointName {
  std::string view;
  std::string camera;
};
std::vector<ViewpointName> viewpoint_names(const Shot& shot);

/// Whether a shot frames the subject, in place of looking through a camera.
bool frames_subject(const Shot& shot, std::optional<std::size_t> camera_node);

/// What there is to see from a camera.
struct Seen {
  const Scene& scene;
  const Extent& extent;                    ///< at all moments of the shot
  std::optional<std::size_t> camera_node;  ///< the scene's own camera, used if no other is chosen
};

/// One for each of viewpoint_names(), each turned all around for a turntable. Throws Error for what the scene lacks.
std::vector<Viewpoint> choose_viewpoints(const Shot& shot, const Seen& seen);

}  // namespace candela
