#include "io/gltf_outline.h"

#include <algorithm>
#include <array>

#include "io/gltf_accessor.h"
#include "io/gltf_mesh.h"
#include "math/box.h"

namespace candela::io {

namespace {

constexpr std::size_t kCorners = 8;
constexpr std::array<uvec3, 12> kSides{{{0, 1, 3},
                                        {0, 3, 2},
                                        {4, 5, 7},
                                        {4, 7, 6},
                                        {0, 1, 5},
                                        {0, 5, 4},
                                        {2, 3, 7},
                                        {2, 7, 6},
                                        {0, 2, 6},
                                        {0, 6, 4},
                                        {1, 3, 7},
                                        {1, 7, 5}}};

/// What an integer is divided by; nothing for types that are not normalised.
std::optional<float> divisor_of(const JsonView& accessor) {
  if (!accessor.boolean_or("normalized", false)) return 1.0f;
  switch (accessor.at("componentType").whole()) {
    case kI8:
      return 127.0f;
    case kU8:
      return 255.0f;
    case kI16:
      return 32767.0f;
    case kU16:
      return 65535.0f;
    default:
      return std::nullopt;
  }
}

/// Loading needs no bounds, so that what is wrong with them is no error.
std::optional<vec3> bound_of(const JsonView& accessor, const char* key) {
  try {
    const std::vector<float> numbers = accessor.at(key).reals(3);
    return vec3(numbers[0], numbers[1], numbers[2]);
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<Box3> box_of(const JsonView& accessor) {
  const auto lower = bound_of(accessor, "min"), upper = bound_of(accessor, "max");
  const auto divisor = divisor_of(accessor);
  if (!lower || !upper || !divisor || glm::any(glm::greaterThan(*lower, *upper))) return std::nullopt;
  const float least = *divisor == 1.0f ? -kInfinity : -1.0f;  // -128 and -127 both mean -1
  return Box3{glm::max(*lower / *divisor, vec3(least)), *upper / *divisor};
}

}  // namespace

bool is_along_axes(const mat4& m) {
  constexpr float kRounding = 1e-6f;
  for (int i = 0; i < 3; ++i) {
    const vec3 size = glm::abs(vec3(m[i]));
    const float most = max_component(size);
    if (size.x + size.y + size.z > (1.0f + kRounding) * most) return false;
  }
  return true;
}

std::optional<Outline> outline_of(const JsonView& root, const JsonView& primitive, GltfBuffers& buffers) {
  if (mode_of_primitive(primitive) != 4) return std::nullopt;
  const auto draco = primitive.extension("KHR_draco_mesh_compression");
  const auto accessor_of = [&](const JsonView& reference) {
    return root.at("accessors")[reference.index(count_of(root, "accessors"), "accessor")];
  };
  const auto is_packed = [&](const JsonView& accessor, const char* name) {
    if (accessor.find("sparse")) return false;
    if (draco && (name == nullptr || draco->at("attributes").find(name))) return true;
    const auto view = accessor.find("bufferView");
    return view && buffers.is_packed(*view);
  };

  const JsonView attributes = primitive.at("attributes");
  const auto reference = attributes.find("POSITION");
  if (!reference) return std::nullopt;
  const JsonView positions = accessor_of(*reference);
  const std::uint64_t vertices = positions.at("count").whole();
  const auto box = box_of(positions);
  if (!box) return std::nullopt;
  for (const std::string& name : attributes.keys()) {
    const JsonView accessor = accessor_of(attributes.at(name.c_str()));
    if (accessor.at("count").whole() != vertices || !is_packed(accessor, name.c_str())) return std::nullopt;
  }
  std::uint64_t corners = vertices;
  if (const auto indices = primitive.find("indices")) {
    const JsonView accessor = accessor_of(*indices);
    corners = accessor.at("count").whole();
    if (!is_packed(accessor, nullptr)) return std::nullopt;
  }
  if (corners % 3 != 0 || (draco && buffers.claim_draco(draco->at("bufferView")).faces != corners / 3)) {
    return std::nullopt;
  }
  // Without normals each triangle gets vertices of its own.
  Outline outline{static_cast<std::size_t>(attributes.find("NORMAL") ? vertices : corners),
                  static_cast<std::size_t>(corners / 3), *box};
  if (outline.vertices < kCorners || outline.triangles < kSides.size()) return std::nullopt;
  return outline;
}

Primitive make_stand_in(const Outline& outline) {
  Primitive primitive;
  primitive.positions.resize(outline.vertices);
  primitive.triangles.resize(outline.triangles);
  for (std::size_t i = 0; i < outline.vertices; ++i) primitive.positions[i] = corner(outline.box, i % kCorners);
  for (std::size_t i = 0; i < outline.triangles; ++i) primitive.triangles[i] = kSides[i % kSides.size()];
  return primitive;
}

}  // namespace candela::io
