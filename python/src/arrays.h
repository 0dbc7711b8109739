#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "image/image.h"
#include "math/types.h"

/// Between arrays of Python and plain data. Whatever an array lacks is an Error that begins with the argument's name.
namespace candela::python {

namespace nb = nanobind;

/// str() of it.
std::string text_of(nb::handle object);

/// An array's shape as it must be: -1 = any.
using Shape = std::vector<int>;

struct Floats {
  std::vector<std::size_t> shape;
  std::vector<float> values;  ///< the last axis changing first
};
/// Whatever numpy can make an array of finite numbers of.
Floats read_floats(nb::handle source, const std::string& name, const Shape& shape);

/// An array (h, w) of bool, by rows.
struct Bits {
  ivec2 size{0};  ///< width, height
  std::vector<bool> values;
};
Bits read_bits(nb::handle source, const std::string& name);

/// Triples of indices below `count`.
std::vector<uvec3> read_triangles(nb::handle source, const std::string& name, std::size_t count);

std::vector<vec2> read_vec2s(nb::handle source, const std::string& name, std::size_t count);
std::vector<vec3> read_vec3s(nb::handle source, const std::string& name);
std::vector<vec3> read_vec3s(nb::handle source, const std::string& name, std::size_t count);

vec3 read_vec3(nb::handle source, const std::string& name);
/// A colour: three numbers, one for a grey, or a text as the program takes it ("#d04020", "white").
vec3 read_color(nb::handle source, const std::string& name);
/// 4 by 4 by rows, the last row 0 0 0 1.
glm::dmat4 read_transform(nb::handle source, const std::string& name);
glm::dmat3 read_matrix3(nb::handle source, const std::string& name);

/// 8 or 16 bits, grey, RGB or RGBA; of floats in [0, 1] it has 16.
TextureImage read_texture(nb::handle source, const std::string& name);

using FloatArray = nb::ndarray<nb::numpy, float>;
using DoubleArray = nb::ndarray<nb::numpy, double>;

/// An array on an image's own pixels, which `owner` keeps alive: (h, w), or (h, w, channels).
nb::object array_of(const Image& image, std::shared_ptr<const void> owner);
/// The same of an image of its own.
nb::object array_of(Image&& image);
/// An array that owns its numbers.
nb::object array_of(std::vector<float> values, const std::vector<std::size_t>& shape);
nb::object array_of_bytes(std::vector<std::uint8_t> values, const std::vector<std::size_t>& shape);
nb::object array_of(const std::vector<uvec3>& triangles);
template <class V>
nb::object array_of_vectors(const std::vector<V>& vectors) {
  std::vector<float> values;
  values.reserve(vectors.size() * V::length());
  for (const V& v : vectors) {
    for (int i = 0; i < V::length(); ++i) values.push_back(v[i]);
  }
  return array_of(std::move(values), {vectors.size(), static_cast<std::size_t>(V::length())});
}
/// By rows.
nb::object array_of(const glm::dmat4& matrix);
nb::object array_of(const glm::dmat3& matrix);

}  // namespace candela::python
