#include "arrays.h"

#include <nanobind/stl/string.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/error.h"
#include "cli/values.h"

namespace candela::python {

namespace {

std::string text_of_shape(const Shape& shape) {
  std::string text;
  for (const int extent : shape) text += (text.empty() ? "" : ", ") + (extent < 0 ? "n" : std::to_string(extent));
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

template <class Array>
std::string shape_text(const Array& array) {
  Shape shape;
  for (std::size_t i = 0; i < array.ndim(); ++i) shape.push_back(static_cast<int>(array.shape(i)));
  return text_of_shape(shape);
}

template <class Array>
void require_shape(const Array& array, const std::string& name, const Shape& shape) {
  bool fits = array.ndim() == shape.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i) {
    fits = shape[i] < 0 || array.shape(i) == static_cast<std::size_t>(shape[i]);
  }
  if (!fits) throw Error("has the shape " + shape_text(array) + ", not " + text_of_shape(shape), name);
}

/// numpy's own array of it, of the given kinds of numbers, as `type`.
nb::object numpy_array(nb::handle source, const std::string& name, const char* kinds, const char* type,
                       const char* wanted) {
  const nb::object numpy = nb::module_::import_("numpy");
  nb::object array;
  try {
    array = numpy.attr("asarray")(source);
  } catch (const nb::python_error& error) {
    if (!error.matches(PyExc_Exception)) throw;
    throw Error("is no array: " + text_of(error.value()), name);
  }
  const nb::object type_of_numbers = array.attr("dtype");
  const std::string kind = nb::cast<std::string>(type_of_numbers.attr("kind"));
  if (std::strchr(kinds, kind[0]) == nullptr) {
    throw Error("has the dtype " + text_of(type_of_numbers) + ", not " + wanted, name);
  }
  if (type[0] == 0) return numpy.attr("ascontiguousarray")(array);
  return numpy.attr("ascontiguousarray")(array, type);
}

template <class T>
using Numbers = nb::ndarray<const T, nb::c_contig, nb::device::cpu>;

Numbers<float> floats_of(nb::handle source, const std::string& name) {
  Numbers<float> array;
  if (nb::try_cast(source, array, false)) return array;
  return nb::cast<Numbers<float>>(numpy_array(source, name, "fiu", "float32", "numbers"));
}

/// numpy makes (1,) of a single number.
bool is_number(nb::handle source) { return PyFloat_Check(source.ptr()) || PyLong_Check(source.ptr()); }

template <class V>
std::vector<V> read_vectors(nb::handle source, const std::string& name, int count) {
  const Floats floats = read_floats(source, name, {count, V::length()});
  std::vector<V> vectors(floats.shape[0]);
  if (!vectors.empty())
    std::memcpy(static_cast<void*>(vectors.data()), floats.values.data(), floats.values.size() * sizeof(float));
  return vectors;
}

template <int N>
glm::mat<N, N, double> read_matrix(nb::handle source, const std::string& name) {
  const auto array = nb::cast<Numbers<double>>(numpy_array(source, name, "fiu", "float64", "numbers"));
  require_shape(array, name, {N, N});
  glm::mat<N, N, double> matrix;
  for (int r = 0; r < N; ++r) {
    for (int c = 0; c < N; ++c) {
      matrix[c][r] = array.data()[r * N + c];
      if (!std::isfinite(matrix[c][r])) throw Error("row " + std::to_string(r) + " is not finite", name);
    }
  }
  return matrix;
}

template <class T>
nb::object owned(std::vector<T> values, const std::vector<std::size_t>& shape) {
  auto* kept = new std::vector<T>(std::move(values));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T>(kept->data(), shape.size(), shape.data(), owner));
}

}  // namespace

std::string text_of(nb::handle object) {
  const auto text = nb::steal<nb::object>(PyObject_Str(object.ptr()));
  if (!text.is_valid()) nb::raise_python_error();
  return nb::cast<std::string>(text);
}

Floats read_floats(nb::handle source, const std::string& name, const Shape& shape) {
  const Numbers<float> array = floats_of(source, name);
  require_shape(array, name, shape);
  Floats result;
  std::size_t row = 1;
  for (std::size_t i = 0; i < array.ndim(); ++i) {
    result.shape.push_back(array.shape(i));
    if (i > 0) row *= array.shape(i);
  }
  result.values.assign(array.data(), array.data() + array.size());
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    if (!std::isfinite(result.values[i])) throw Error("row " + std::to_string(i / row) + " is not finite", name);
  }
  return result;
}

Bits read_bits(nb::handle source, const std::string& name) {
  const auto array = nb::cast<Numbers<bool>>(numpy_array(source, name, "b", "bool", "bool"));
  require_shape(array, name, {-1, -1});
  return {ivec2(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0))),
          std::vector<bool>(array.data(), array.data() + array.size())};
}

std::vector<uvec3> read_triangles(nb::handle source, const std::string& name, std::size_t count) {
  const nb::object given = numpy_array(source, name, "iu", "", "whole numbers");
  const auto array = nb::cast<Numbers<std::int64_t>>(given.attr("astype")("int64"));
  require_shape(array, name, {-1, 3});
  // Of numbers without a sign those above the largest one with a sign come out negative.
  const nb::object type_of_numbers = given.attr("dtype");
  const bool is_unsigned = nb::cast<std::string>(type_of_numbers.attr("kind")) == "u";
  std::vector<uvec3> triangles(array.shape(0));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::int64_t index = array.data()[3 * i + static_cast<std::size_t>(k)];
      if (index < 0 || static_cast<std::size_t>(index) >= count) {
        const std::string number =
            is_unsigned ? std::to_string(static_cast<std::uint64_t>(index)) : std::to_string(index);
        throw Error("row " + std::to_string(i) + " names the vertex " + number + " of " + std::to_string(count), name);
      }
      triangles[i][k] = static_cast<std::uint32_t>(index);
    }
  }
  return triangles;
}

std::vector<vec2> read_vec2s(nb::handle source, const std::string& name, std::size_t count) {
  return read_vectors<vec2>(source, name, static_cast<int>(count));
}
std::vector<vec3> read_vec3s(nb::handle source, const std::string& name) {
  return read_vectors<vec3>(source, name, -1);
}
std::vector<vec3> read_vec3s(nb::handle source, const std::string& name, std::size_t count) {
  return read_vectors<vec3>(source, name, static_cast<int>(count));
}

vec3 read_vec3(nb::handle source, const std::string& name) {
  const Floats floats = read_floats(source, name, {3});
  return {floats.values[0], floats.values[1], floats.values[2]};
}

vec3 read_color(nb::handle source, const std::string& name) {
  if (nb::isinstance<nb::str>(source)) {
    try {
      return cli::parse_color(nb::cast<std::string>(source));
    } catch (const cli::UsageError& error) {
      throw Error(error.what(), name);
    }
  }
  if (!is_number(source)) return read_vec3(source, name);
  const auto grey = static_cast<float>(PyFloat_AsDouble(source.ptr()));
  if (!std::isfinite(grey)) throw Error("is not finite", name);
  return vec3(grey);
}

glm::dmat4 read_transform(nb::handle source, const std::string& name) {
  const glm::dmat4 matrix = read_matrix<4>(source, name);
  if (matrix[0][3] != 0.0 || matrix[1][3] != 0.0 || matrix[2][3] != 0.0 || matrix[3][3] != 1.0) {
    throw Error("the last row is not 0 0 0 1", name);
  }
  return matrix;
}

glm::dmat3 read_matrix3(nb::handle source, const std::string& name) { return read_matrix<3>(source, name); }

TextureImage read_texture(nb::handle source, const std::string& name) {
  const nb::object numpy = nb::module_::import_("numpy");
  nb::object given = numpy_array(source, name, "fu", "", "uint8, uint16 or floats from 0 to 1");
  TextureImage image;
  const nb::object type_of_numbers = given.attr("dtype");
  const std::string type = text_of(type_of_numbers);
  std::vector<std::uint16_t> wide;
  std::vector<std::uint8_t> narrow;
  std::vector<std::size_t> shape;
  const auto read = [&](const auto& array, auto& values) {
    for (std::size_t i = 0; i < array.ndim(); ++i) shape.push_back(array.shape(i));
    values.assign(array.data(), array.data() + array.size());
  };
  if (type == "uint8") {
    read(nb::cast<Numbers<std::uint8_t>>(given), narrow);
  } else if (type == "uint16") {
    read(nb::cast<Numbers<std::uint16_t>>(given), wide);
    image.bits = 16;
  } else if (type.starts_with("float")) {
    const auto array = nb::cast<Numbers<float>>(numpy.attr("ascontiguousarray")(given, "float32"));
    std::vector<float> floats;
    read(array, floats);
    wide.reserve(floats.size());
    for (const float value : floats) {
      if (!(value >= 0.0f && value <= 1.0f)) throw Error("has a value that is not within 0 to 1", name);
      wide.push_back(static_cast<std::uint16_t>(std::lround(value * 65535.0f)));
    }
    image.bits = 16;
  } else {
    throw Error("has the dtype " + type + ", not uint8, uint16 or floats from 0 to 1", name);
  }
  const std::size_t channels = shape.size() == 2 ? 1 : shape.size() == 3 ? shape[2] : 0;
  if ((channels != 1 && channels != 3 && channels != 4) || shape[0] == 0 || shape[1] == 0) {
    Shape given_shape(shape.begin(), shape.end());
    throw Error("has the shape " + text_of_shape(given_shape) + ", not (height, width), (…, 3) or (…, 4)", name);
  }
  constexpr std::size_t kMostTexels = 16384;
  if (shape[0] > kMostTexels || shape[1] > kMostTexels) throw Error("has a side of more than 16384 texels", name);
  image.height = static_cast<int>(shape[0]);
  image.width = static_cast<int>(shape[1]);
  image.has_alpha = channels == 4;
  const auto fill = [&](const auto& values, auto opaque) {
    using T = decltype(opaque);
    const std::size_t count = shape[0] * shape[1];
    std::vector<T> rgba(count * 4);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 4; ++c) {
        rgba[4 * i + c] = c == 3 && channels != 4 ? opaque : values[i * channels + (channels == 1 ? 0 : c)];
      }
    }
    image.pixels.resize(rgba.size() * sizeof(T));
    std::memcpy(image.pixels.data(), rgba.data(), image.pixels.size());
  };
  if (image.bits == 8) {
    fill(narrow, std::numeric_limits<std::uint8_t>::max());
  } else {
    fill(wide, std::numeric_limits<std::uint16_t>::max());
  }
  return image;
}

nb::object array_of(const Image& image, std::shared_ptr<const void> owner) {
  auto* kept = new std::shared_ptr<const void>(std::move(owner));
  const nb::capsule capsule(kept, [](void* p) noexcept { delete static_cast<std::shared_ptr<const void>*>(p); });
  const std::array<std::size_t, 3> shape{static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width),
                                         static_cast<std::size_t>(image.channels)};
  // The picture is its caller's own: it may be changed.
  auto* pixels = const_cast<float*>(image.pixels.data());
  return nb::cast(FloatArray(pixels, image.channels == 1 ? 2 : 3, shape.data(), capsule));
}

nb::object array_of(Image&& image) {
  const auto kept = std::make_shared<const Image>(std::move(image));
  return array_of(*kept, kept);
}

nb::object array_of(std::vector<float> values, const std::vector<std::size_t>& shape) {
  return owned(std::move(values), shape);
}
nb::object array_of_bytes(std::vector<std::uint8_t> values, const std::vector<std::size_t>& shape) {
  return owned(std::move(values), shape);
}

nb::object array_of(const std::vector<uvec3>& triangles) {
  std::vector<std::uint32_t> values;
  values.reserve(triangles.size() * 3);
  for (const uvec3& t : triangles) values.insert(values.end(), {t.x, t.y, t.z});
  return owned(std::move(values), {triangles.size(), 3});
}

nb::object array_of(const glm::dmat4& matrix) {
  std::vector<double> values;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) values.push_back(matrix[c][r]);
  }
  return owned(std::move(values), {4, 4});
}
nb::object array_of(const glm::dmat3& matrix) {
  std::vector<double> values;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) values.push_back(matrix[c][r]);
  }
  return owned(std::move(values), {3, 3});
}

}  // namespace candela::python
