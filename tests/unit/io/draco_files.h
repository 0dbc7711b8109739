#pragma once

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace candela::io::test {

/// A strip of triangles with positions, normals and uvs; `speed` 10 packs it in order, less by the edges they share.
inline std::vector<std::byte> draco_strip(int triangles, int speed, bool has_normals) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(triangles);
  const int positions = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uvs = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const int normals = has_normals ? builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32) : -1;
  const auto position = [](int i) {
    const int step = i / 2;
    return std::array<float, 3>{static_cast<float>(step), static_cast<float>(i % 2), static_cast<float>(i % 5) / 8.0f};
  };
  const auto uv = [](int i) { return std::array<float, 2>{static_cast<float>(i) / 16.0f, static_cast<float>(i % 2)}; };
  const std::array<float, 3> up = {0.0f, 0.6f, 0.8f};
  for (int i = 0; i < triangles; ++i) {
    const draco::FaceIndex face(static_cast<std::uint32_t>(i));
    const int b = i + 1 + i % 2, c = i + 2 - i % 2;
    builder.SetAttributeValuesForFace(positions, face, position(i).data(), position(b).data(), position(c).data());
    builder.SetAttributeValuesForFace(uvs, face, uv(i).data(), uv(b).data(), uv(c).data());
    if (has_normals) builder.SetAttributeValuesForFace(normals, face, up.data(), up.data(), up.data());
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 11);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 10);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 8);
  draco::EncoderBuffer buffer;
  if (mesh == nullptr || !encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw std::runtime_error("Draco failed");
  std::vector<std::byte> bytes(buffer.size());
  std::memcpy(bytes.data(), buffer.data(), buffer.size());
  return bytes;
}

}  // namespace candela::io::test
