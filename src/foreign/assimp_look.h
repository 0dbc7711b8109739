#pragma once

#include <assimp/material.h>
#include <assimp/scene.h>

#include "foreign/formats.h"
#include "foreign/look.h"

namespace candela::foreign {

/// What Assimp knows of a surface.
Look look_of(const aiScene& scene, const aiMaterial& material, Format format);

/// What has no material: light grey, or white where vertices have colours, halfway rough.
Look plain_look(bool has_colors);

}  // namespace candela::foreign
