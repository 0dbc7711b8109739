#pragma once

#include <string_view>

#include "ibl/profile.h"

namespace candela::ibl {

/// The lines with which a program of the engine loads what write_for() writes for it.
std::string_view loading_code(const Profile& profile);

/// How the engine takes a panorama itself, where it does, so that a bake gives it little; else empty.
std::string_view panorama_code(const Profile& profile);

}  // namespace candela::ibl
