#pragma once

#include <nanobind/nanobind.h>

namespace candela::python {

void bind_render(nanobind::module_& module);

}  // namespace candela::python
