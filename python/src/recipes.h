#pragma once

#include <nanobind/nanobind.h>

namespace candela::python {

/// Checks, bakes, the laws of the materials, and how far pictures are from each other.
void bind_recipes(nanobind::module_& module);

}  // namespace candela::python
