#include "parity/tables.h"

#include <array>

#include "base/error.h"
#include "shade/tables.glsl.h"

namespace candela::parity {

namespace {

/// The tables of shade/tables.glsl.h in rows of 256, as shade_table reads them.
Table shade_tables() {
  constexpr int kWidth = 256;
  Table table;
  table.uniform = "shade_table_texels";
  table.target = GL_TEXTURE_2D;
  table.width = kWidth;
  table.height = (shade::kTableCount + kWidth - 1) / kWidth;
  table.texels.assign(shade::kTableEntries, shade::kTableEntries + shade::kTableCount);
  table.texels.resize(static_cast<std::size_t>(kWidth) * static_cast<std::size_t>(table.height));
  return table;
}

}  // namespace

const std::vector<Table>& tables() {
  static const std::vector<Table> kTables = {shade_tables()};
  return kTables;
}

gl::Texture upload(const Table& table) {
  static constexpr std::array<GLint, 4> kInternal = {GL_R32F, GL_RG32F, GL_RGB32F, GL_RGBA32F};
  static constexpr std::array<GLenum, 4> kFormat = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
  const auto channels = static_cast<std::size_t>(table.channels - 1);
  const auto floats = static_cast<std::size_t>(table.width) * static_cast<std::size_t>(table.height) *
                      static_cast<std::size_t>(table.depth) * (channels + 1);
  if (channels >= kFormat.size() || table.texels.size() != floats)
    throw Error("its texels are not its size", table.uniform);

  gl::Texture texture;
  glBindTexture(table.target, texture);
  if (table.target == GL_TEXTURE_2D) {
    glTexImage2D(table.target, 0, kInternal[channels], table.width, table.height, 0, kFormat[channels], GL_FLOAT,
                 table.texels.data());
  } else {
    glTexImage3D(table.target, 0, kInternal[channels], table.width, table.height, table.depth, 0, kFormat[channels],
                 GL_FLOAT, table.texels.data());
  }
  for (const GLenum which : {GLenum{GL_TEXTURE_MIN_FILTER}, GLenum{GL_TEXTURE_MAG_FILTER}}) {
    glTexParameteri(table.target, which, table.filter);
  }
  for (const GLenum which : {GLenum{GL_TEXTURE_WRAP_S}, GLenum{GL_TEXTURE_WRAP_T}, GLenum{GL_TEXTURE_WRAP_R}}) {
    glTexParameteri(table.target, which, GL_CLAMP_TO_EDGE);
  }
  gl::check("upload of " + table.uniform);
  return texture;
}

}  // namespace candela::parity
