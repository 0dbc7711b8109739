#include "io/draco_mesh.h"

#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/geometry_metadata.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include <cstring>
#include <ctime>
#include <string>

#include "base/error.h"
#include "io/gltf_accessor.h"

namespace candela::io {

struct DracoMesh::Mesh {
  std::unique_ptr<draco::Mesh> mesh;
};

namespace {

[[noreturn]] void damaged(const std::string& why) { throw Error("damaged Draco data: " + why); }

/// A count as streams of this version write it.
std::uint64_t read_count(draco::DecoderBuffer& in, bool is_fixed) {
  std::uint32_t count = 0;
  if (!(is_fixed ? in.Decode(&count) : draco::DecodeVarint(&count, &in))) damaged("it ends too early");
  return count;
}

template <class T>
std::vector<std::byte> values_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                                 std::size_t components) {
  std::vector<std::byte> result(mesh.num_points() * components * sizeof(T));
  std::byte* out = result.data();
  std::vector<T> value(components);
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    if (!attribute.ConvertValue<T>(attribute.mapped_index(point), static_cast<std::int8_t>(components), value.data())) {
      damaged("an attribute cannot be read as the type of its accessor");
    }
    std::memcpy(out, value.data(), components * sizeof(T));
    out += components * sizeof(T);
  }
  return result;
}

}  // namespace

// The layout is that of the Draco bitstream specification 2.2 ("Decoding Header", "Edgebreaker" and "Sequential
// connectivity"), and of its predecessors.
DracoMesh::Claim DracoMesh::claim(std::span<const std::byte> packed) {
  draco::DecoderBuffer in;
  in.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  char magic[5];
  std::uint8_t major = 0, minor = 0, type = 0, method = 0;
  std::uint16_t flags = 0;
  if (!in.Decode(magic, sizeof magic) || std::memcmp(magic, "DRACO", sizeof magic) != 0) damaged("it has no header");
  if (!in.Decode(&major) || !in.Decode(&minor) || !in.Decode(&type) || !in.Decode(&method) || !in.Decode(&flags)) {
    damaged("it ends too early");
  }
  if (type != draco::TRIANGULAR_MESH) damaged("it is a cloud of points, not a mesh");
  const int version = major << 8 | minor;
  in.set_bitstream_version(static_cast<std::uint16_t>(version));
  if (version >= 0x103 && (flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata ignored;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&in, &ignored)) damaged("its metadata cannot be read");
  }
  Claim claim;
  if (method == draco::MESH_SEQUENTIAL_ENCODING) {
    claim.faces = read_count(in, version < 0x202);
    claim.vertices = read_count(in, version < 0x202);
    return claim;
  }
  std::uint8_t traversal = 0;
  if (!in.Decode(&traversal)) damaged("it ends too early");
  if (version < 0x202) read_count(in, version < 0x200);
  read_count(in, version < 0x200);
  claim.faces = read_count(in, version < 0x200);
  claim.vertices = 3 * claim.faces;
  return claim;
}

DracoMesh::DracoMesh(std::span<const std::byte> packed) : mesh_(std::make_unique<Mesh>()) {
  draco::DecoderBuffer in;
  in.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&in);
  if (!decoded.ok()) damaged(decoded.status().error_msg_string());
  mesh_->mesh = std::move(decoded).value();
}

DracoMesh::~DracoMesh() = default;
DracoMesh::DracoMesh(DracoMesh&&) noexcept = default;
DracoMesh& DracoMesh::operator=(DracoMesh&&) noexcept = default;

std::size_t DracoMesh::face_count() const { return mesh_->mesh->num_faces(); }

std::size_t DracoMesh::vertex_count() const { return mesh_->mesh->num_points(); }

std::vector<std::byte> DracoMesh::indices() const {
  std::vector<std::byte> result(face_count() * 3 * sizeof(std::uint32_t));
  std::byte* out = result.data();
  for (draco::FaceIndex i(0); i < mesh_->mesh->num_faces(); ++i) {
    for (const draco::PointIndex& corner : mesh_->mesh->face(i)) {
      const std::uint32_t index = corner.value();
      std::memcpy(out, &index, sizeof index);
      out += sizeof index;
    }
  }
  return result;
}

std::vector<std::byte> DracoMesh::attribute(std::uint32_t id, int component_type, std::size_t components) const {
  const draco::PointAttribute* found = mesh_->mesh->GetAttributeByUniqueId(id);
  if (found == nullptr) throw Error(fmt::format("the Draco data has no attribute {}", id));
  if (static_cast<std::size_t>(found->num_components()) != components) {
    throw Error(fmt::format("attribute {} of the Draco data has {} components, its accessor {}", id,
                            found->num_components(), components));
  }
  // libdraco reads a byte of the stream as bool without asking whether it is one.
  if (found->data_type() == draco::DT_BOOL)
    throw Error(fmt::format("attribute {} of the Draco data is of truth values", id));
  switch (component_type) {
    case kI8:
      return values_of<std::int8_t>(*mesh_->mesh, *found, components);
    case kU8:
      return values_of<std::uint8_t>(*mesh_->mesh, *found, components);
    case kI16:
      return values_of<std::int16_t>(*mesh_->mesh, *found, components);
    case kU16:
      return values_of<std::uint16_t>(*mesh_->mesh, *found, components);
    case kU32:
      return values_of<std::uint32_t>(*mesh_->mesh, *found, components);
    default:
      return values_of<float>(*mesh_->mesh, *found, components);
  }
}

void DracoBudget::charge(std::size_t bytes, double seconds) {
  constexpr double kBytesPerSecond = 1e5;
  const std::lock_guard lock(mutex_);
  allowed_s_ += static_cast<double>(bytes) / kBytesPerSecond - seconds;
}

void DracoBudget::require() const {
  const std::lock_guard lock(mutex_);
  if (allowed_s_ < 0.0) throw Error("the file's Draco data takes too long to decode");
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace candela::io
