#pragma once

#include <nanobind/nanobind.h>

namespace candela::python {

/// Files that many pictures are written to: films, data sets, lists of cameras; and what data sets say of a picture.
void bind_files(nanobind::module_& module);

}  // namespace candela::python
