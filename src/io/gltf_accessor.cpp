#include "io/gltf_accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <string_view>

namespace candela::io {

namespace {

// Decoding expands: one byte of a quantised uv becomes four, flat shading splits vertices, and several primitives
// share data. 64 covers these; the constant lets a small file instance a mesh under many materials.
constexpr std::uint64_t kBudgetPerByte = 64;
constexpr std::uint64_t kBudgetBase = std::uint64_t{256} << 20;
// Beyond this an index no longer fits in the 32 bits that the scene stores.
constexpr std::uint64_t kMaxElements = 0xFFFFFFFF;

std::size_t component_size(int type, const JsonView& json) {
  switch (type) {
    case kI8:
    case kU8:
      return 1;
    case kI16:
    case kU16:
    case kF16:
      return 2;
    case kU32:
    case kF32:
      return 4;
    case kF64:
      return 8;
    default:
      throw json.error(fmt::format("{} is not a component type", type));
  }
}

std::size_t component_count(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  return type == "MAT4" ? 16 : 0;
}

/// The bits of a real number of 16.
struct Half {
  std::uint16_t bits;
};

template <class T>
float to_float(T value, float divisor) {
  if constexpr (std::is_same_v<T, Half>) {
    return glm::unpackHalf1x16(value.bits);
  } else if constexpr (std::is_floating_point_v<T>) {
    return static_cast<float>(value);
  } else {
    const float quotient = static_cast<float>(value) / divisor;
    // glTF 2.0 §3.6.2.2: -128 and -127 both mean -1.
    return std::is_signed_v<T> && divisor != 1.0f ? std::max(quotient, -1.0f) : quotient;
  }
}

template <class T>
void decode_element(const std::byte* source, std::size_t components, float divisor, float* out) {
  for (std::size_t c = 0; c < components; ++c) {
    T value;
    std::memcpy(&value, source + c * sizeof(T), sizeof(T));
    out[c] = to_float(value, divisor);
  }
}

template <class T>
void decode(const Accessor& accessor, const Selection& selection, std::size_t count, float* out) {
  const std::size_t components = accessor.components;
  float divisor = 1.0f;
  if constexpr (std::is_integral_v<T>) {
    if (accessor.normalized) divisor = static_cast<float>(std::numeric_limits<T>::max());
  }
  if (!accessor.bytes.empty()) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t element = selection ? (*selection)[i] : i;
      decode_element<T>(accessor.bytes.data() + element * accessor.stride, components, divisor, out + i * components);
    }
  }
  for (std::size_t k = 0; k < accessor.sparse_elements.size(); ++k) {
    const std::uint32_t element = accessor.sparse_elements[k];
    std::size_t slot = element;
    if (selection) {
      const auto found = std::lower_bound(selection->begin(), selection->end(), element);
      if (found == selection->end() || *found != element) continue;
      slot = static_cast<std::size_t>(found - selection->begin());
    }
    decode_element<T>(accessor.sparse_values.data() + k * components * sizeof(T), components, divisor,
                      out + slot * components);
  }
}

/// Last byte that `count` elements reach, in 64 bits: count < 2^32, stride and size are at most 252 and 64.
std::uint64_t extent(std::uint64_t offset, std::uint64_t count, std::uint64_t stride, std::uint64_t size) {
  return offset + (count - 1) * stride + size;
}

std::vector<std::uint32_t> decode_whole(std::span<const std::byte> bytes, std::size_t stride, std::size_t count,
                                        int type) {
  std::vector<std::uint32_t> result(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* source = bytes.data() + i * stride;
    if (type == kU8) {
      result[i] = static_cast<std::uint32_t>(*source);
    } else if (type == kU16) {
      std::uint16_t value;
      std::memcpy(&value, source, sizeof value);
      result[i] = value;
    } else {
      std::memcpy(&result[i], source, sizeof result[i]);
    }
  }
  return result;
}

}  // namespace

AccessorReader::AccessorReader(const JsonView& root, GltfBuffers& buffers, std::uint64_t file_bytes, Warnings& warnings)
    : root_(root),
      buffers_(buffers),
      file_bytes_(file_bytes),
      warnings_(warnings),
      charged_(std::make_shared<std::atomic<std::uint64_t>>(0)) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    const auto names = root_.find(list);
    for (std::size_t i = 0; names && i < names->size(); ++i) {
      const std::string name = (*names)[i].string();
      has_restarts_ |= name == "EXT_mesh_primitive_restart" || name == "KHR_mesh_primitive_restart";
    }
  }
}

AccessorReader::AccessorReader(const AccessorReader& other, Warnings& warnings)
    : root_(other.root_),
      buffers_(other.buffers_),
      file_bytes_(other.file_bytes_),
      warnings_(warnings),
      charged_(other.charged_),
      has_restarts_(other.has_restarts_) {}

void AccessorReader::prepare_accessor(const JsonView& reference) {
  const JsonView json = root_.at("accessors")[reference.index(count_of(root_, "accessors"), "accessor")];
  if (const auto view = json.find("bufferView"); view && !buffers_.find_undefined(*view)) buffers_.view(*view);
  if (const auto sparse = json.find("sparse")) {
    for (const char* part : {"indices", "values"}) buffers_.view(sparse->at(part).at("bufferView"));
  }
}

void AccessorReader::prepare(const JsonView& primitive) {
  const auto draco = primitive.extension("KHR_draco_mesh_compression");
  // Beside Draco data there may be a fallback, which nobody needs.
  if (const auto indices = primitive.find("indices"); indices && !draco) prepare_accessor(*indices);
  const JsonView attributes = primitive.at("attributes");
  for (const std::string& name : attributes.keys()) {
    if (!draco || !draco->at("attributes").find(name.c_str())) prepare_accessor(attributes.at(name.c_str()));
  }
  const auto targets = primitive.find("targets");
  for (std::size_t i = 0; targets && i < targets->size(); ++i) {
    for (const std::string& name : (*targets)[i].keys()) prepare_accessor((*targets)[i].at(name.c_str()));
  }
}

void AccessorReader::begin_primitive(const JsonView& primitive) {
  draco_.clear();
  const auto draco = primitive.extension("KHR_draco_mesh_compression");
  if (!draco) return;
  const std::size_t accessors = count_of(root_, "accessors");
  const JsonView view = draco->at("bufferView");
  if (const auto indices = primitive.index_of("indices", accessors, "accessor")) {
    draco_.try_emplace(*indices, DracoSource{view, std::nullopt});
  }
  const JsonView ids = draco->at("attributes");
  for (const std::string& name : ids.keys()) {
    const auto accessor = primitive.at("attributes").index_of(name.c_str(), accessors, "accessor");
    const std::uint64_t id = ids.at(name.c_str()).whole();
    if (id > 0xFFFFFFFF) throw ids.at(name.c_str()).error("is no attribute of Draco");
    if (accessor) draco_.try_emplace(*accessor, DracoSource{view, static_cast<std::uint32_t>(id)});
  }
}

/// What Draco data says of an accessor takes the place of what the accessor says; false where there is none.
bool AccessorReader::open_draco(std::size_t index, Accessor& accessor) {
  const auto found = draco_.find(index);
  if (found == draco_.end()) return false;
  DracoSource& source = found->second;
  const DracoMesh& mesh = buffers_.draco(source.view);
  if (!source.attribute) accessor.component_type = kU32;
  accessor.count = source.attribute ? mesh.vertex_count() : mesh.face_count() * 3;
  if (accessor.count == 0) throw source.view.error("the Draco data has no triangles");
  accessor.stride = accessor.components * component_size(accessor.component_type, accessor.json);
  if (source.values.empty()) {
    charge(std::uint64_t{accessor.count} * accessor.stride, accessor.json);
    try {
      source.values = source.attribute ? mesh.attribute(*source.attribute, accessor.component_type, accessor.components)
                                       : mesh.indices();
    } catch (const Error& cause) {
      throw source.view.error(cause.message());
    }
  }
  accessor.bytes = source.values;
  return true;
}

void AccessorReader::charge(std::uint64_t bytes, const JsonView& cause) {
  if (charged_->fetch_add(bytes) + bytes > kBudgetBase + kBudgetPerByte * (file_bytes_ + buffers_.loaded_bytes())) {
    throw cause.error("the geometry would become far larger than the file; refusing to load it");
  }
}

Accessor AccessorReader::open(const JsonView& reference, std::initializer_list<const char*> types) {
  const std::size_t index = reference.index(count_of(root_, "accessors"), "accessor");
  const JsonView json = root_.at("accessors")[index];
  Accessor result{json};
  const std::string type = json.at("type").string();
  if (std::none_of(types.begin(), types.end(), [&](const char* t) { return type == t; })) {
    throw reference.error(fmt::format("the accessor must be {}, not {}", fmt::join(types, " or "), type));
  }
  result.components = component_count(type);
  const std::uint64_t count = json.at("count").whole();
  if (count == 0 || count > kMaxElements)
    throw json.at("count").error(fmt::format("a count of {} is not allowed", count));
  result.count = static_cast<std::size_t>(count);
  const JsonView component_type = json.at("componentType");
  result.component_type = static_cast<int>(std::min<std::uint64_t>(component_type.whole(), 0xFFFF));
  const std::size_t size = component_size(result.component_type, component_type) * result.components;
  result.normalized = json.boolean_or("normalized", false);
  if (result.normalized && result.component_type == kU32) throw json.error("32-bit integers cannot be normalized");

  const auto view_index = json.find("bufferView");
  const bool is_draco = open_draco(index, result);  // beside it there may be a fallback
  const auto undefined = view_index && !is_draco ? buffers_.find_undefined(*view_index) : std::nullopt;
  if (undefined) {
    warnings_.warn("the buffer has neither a uri nor data in the file; what needs it is read as zeros", *undefined);
  } else if (view_index && !is_draco) {
    const BufferView view = buffers_.view(*view_index);
    const std::uint64_t offset = json.whole_or("byteOffset", 0);
    result.stride = view.stride == 0 ? size : view.stride;
    if (result.stride < size) {
      throw json.error(fmt::format("elements of {} bytes do not fit a stride of {}", size, result.stride));
    }
    const std::uint64_t end = extent(offset, count, result.stride, size);
    if (end > view.bytes.size()) {
      throw json.error(fmt::format("needs {} bytes of a buffer view that has {}", end, view.bytes.size()));
    }
    result.bytes = view.bytes.subspan(static_cast<std::size_t>(offset));
  }
  if (const auto sparse = json.find("sparse")) open_sparse(result, *sparse);
  return result;
}

void AccessorReader::open_sparse(Accessor& accessor, const JsonView& sparse) {
  const std::uint64_t count = sparse.at("count").whole();
  if (count == 0 || count > accessor.count) {
    throw sparse.at("count").error(fmt::format("{} of {} elements cannot be replaced", count, accessor.count));
  }
  // Where: strictly ascending element numbers.
  const JsonView indices = sparse.at("indices");
  const JsonView type_view = indices.at("componentType");
  const std::uint64_t type = type_view.whole();
  if (type != kU8 && type != kU16 && type != kU32) throw type_view.error(fmt::format("{} is not an index type", type));
  const std::size_t index_size = component_size(static_cast<int>(type), type_view);
  const BufferView index_view = buffers_.view(indices.at("bufferView"));
  const std::uint64_t index_offset = indices.whole_or("byteOffset", 0);
  if (extent(index_offset, count, index_size, index_size) > index_view.bytes.size()) {
    throw indices.error("the sparse indices lie outside their buffer view");
  }
  charge(count * sizeof(std::uint32_t), sparse);
  accessor.sparse_elements = decode_whole(index_view.bytes.subspan(static_cast<std::size_t>(index_offset)), index_size,
                                          static_cast<std::size_t>(count), static_cast<int>(type));
  for (std::size_t i = 0; i < accessor.sparse_elements.size(); ++i) {
    const std::uint32_t element = accessor.sparse_elements[i];
    if (element >= accessor.count)
      throw indices.error(fmt::format("element {} of {} does not exist", element, accessor.count));
    if (i > 0 && element <= accessor.sparse_elements[i - 1]) throw indices.error("the sparse indices must ascend");
  }
  // What: as many values.
  const JsonView values = sparse.at("values");
  const BufferView value_view = buffers_.view(values.at("bufferView"));
  const std::uint64_t value_offset = values.whole_or("byteOffset", 0);
  const std::size_t size = component_size(accessor.component_type, accessor.json) * accessor.components;
  if (extent(value_offset, count, size, size) > value_view.bytes.size()) {
    throw values.error("the sparse values lie outside their buffer view");
  }
  accessor.sparse_values = value_view.bytes.subspan(static_cast<std::size_t>(value_offset));
}

void AccessorReader::read(const Accessor& accessor, const Selection& selection, float* out) const {
  const std::size_t count = selection ? selection->size() : accessor.count;
  switch (accessor.component_type) {
    case kI8:
      decode<std::int8_t>(accessor, selection, count, out);
      break;
    case kU8:
      decode<std::uint8_t>(accessor, selection, count, out);
      break;
    case kI16:
      decode<std::int16_t>(accessor, selection, count, out);
      break;
    case kU16:
      decode<std::uint16_t>(accessor, selection, count, out);
      break;
    case kU32:
      decode<std::uint32_t>(accessor, selection, count, out);
      break;
    case kF16:
      decode<Half>(accessor, selection, count, out);
      break;
    case kF64:
      decode<double>(accessor, selection, count, out);
      break;
    default:
      decode<float>(accessor, selection, count, out);
  }
  const float* end = out + count * accessor.components;
  const float* bad = std::find_if_not(static_cast<const float*>(out), end, [](float x) { return std::isfinite(x); });
  if (bad != end) {
    const std::size_t slot = static_cast<std::size_t>(bad - out) / accessor.components;
    throw accessor.json.error(fmt::format("element {} is not finite", selection ? (*selection)[slot] : slot));
  }
}

std::vector<std::uint32_t> AccessorReader::read_indices(const Accessor& accessor, std::size_t vertex_count) {
  const int type = accessor.component_type;
  if (type != kU8 && type != kU16 && type != kU32) throw accessor.json.error("indices must be unsigned integers");
  charge(std::uint64_t{accessor.count} * sizeof(std::uint32_t), accessor.json);
  std::vector<std::uint32_t> result(accessor.count);
  if (!accessor.bytes.empty()) result = decode_whole(accessor.bytes, accessor.stride, accessor.count, type);
  const std::vector<std::uint32_t> replaced =
      decode_whole(accessor.sparse_values, component_size(type, accessor.json), accessor.sparse_elements.size(), type);
  for (std::size_t k = 0; k < replaced.size(); ++k) result[accessor.sparse_elements[k]] = replaced[k];

  const std::uint32_t restart = type == kU8 ? 0xFFu : type == kU16 ? 0xFFFFu : 0xFFFFFFFFu;
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (result[i] == restart) {
      if (!has_restarts_) {
        throw accessor.json.error(fmt::format("index {} is the primitive restart value {}", i, restart));
      }
      result[i] = kPrimitiveRestart;
      continue;
    }
    if (result[i] >= vertex_count) {
      throw accessor.json.error(fmt::format("index {} is {}, but there are {} vertices", i, result[i], vertex_count));
    }
  }
  return result;
}

}  // namespace candela::io
