#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <string_view>

namespace candela::python {

/// What is called otherwise than on the command line.
struct Spelling {
  std::string_view keyword;
  std::string_view option;  ///< without dashes in front
};
inline constexpr auto kSpellings = std::to_array<Spelling>({{"layers", "aov"},
                                                            {"seconds", "time"},
                                                            {"environment", "env"},
                                                            {"environment_rotation_deg", "env-rotation"},
                                                            {"environment_intensity", "env-intensity"},
                                                            {"tone_curve", "tonemap"}});

void bind_render(nanobind::module_& module);

}  // namespace candela::python
