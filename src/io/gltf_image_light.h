#pragma once

#include <map>
#include <memory>
#include <optional>

#include "io/gltf_document.h"
#include "io/gltf_warnings.h"
#include "scene/file_survey.h"
#include "scene/scene.h"

namespace candela::io {

/// Panoramas of the lights of a file that were read for an earlier scene, by the light's index, before they are turned.
using KeptPanoramas = std::map<std::size_t, std::shared_ptr<const Image>>;

/// What EXT_lights_image_based lights scene `scene` of the file with; none where it names no light. The environment is
/// level 0 of the cube, which is not filtered. Its faces are +x -x +y -y +z -z, as someone inside sees them; an alpha
/// channel divides (image/rgbd.h), KTX 2 is light as it stands. Without `decode` the headers alone are read, and there
/// is no map. `kept` (or null) is looked into and added to.
///
/// Throws Error where the light or a face of level 0 is absent or cannot be read, and where the numbers or sizes of
/// faces do not agree.
std::optional<ImageLight> read_image_light(const JsonView& root, std::size_t scene, GltfBuffers& buffers,
                                           const UriReader& uris, bool decode, KeptPanoramas* kept, Warnings& warnings);

/// What the light that lights scene `scene` says of irradiance, which is not drawn by. `root` is of a file whose light
/// read_image_light has taken.
FileSurvey::Irradiance read_irradiance(const JsonView& root, std::size_t scene);

}  // namespace candela::io
