#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "scene/material.h"

/// The uniform block that a material's numbers lie in, made of the table of materials: every property, what follows
/// from several of them, and how each slot turns its texture coordinates. C++ and the shaders' text come from one list.
namespace candela::raster {

struct BlockField {
  std::string name;  ///< as the driver has it: "Material.roughness"
  std::size_t offset = 0;
};

std::vector<BlockField> material_block_fields();
std::size_t material_block_size();

/// Fills material_block_size() bytes. `more_sets`: the uv sets besides 0 and 1 that vertices have, ascending.
void write_material_block(const Material& material, std::span<const int> more_sets, std::byte* to);

/// The block in GLSL, whose instance is called `material`.
std::string material_block_text();

/// void fetch_factors(inout SurfaceParams): the material's numbers times what its textures hold, except that colours of
/// vertices and the workflow of specular-glossiness are the caller's. NAME_factor() has to be defined for each property
/// with a texture (factor_texts).
std::string material_fetch_text();

/// The macros NAME_factor() of the properties that read the texture of a slot.
std::string factor_texts(std::size_t slot);

/// Whether light that enters comes back out near by: a body whose scattering hides what is behind it.
bool is_scattering(const Material& material);

}  // namespace candela::raster
