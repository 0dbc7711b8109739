#pragma once

#include <nlohmann/json.hpp>

#include "candela/verdict.h"

namespace candela::cli {

/// A verdict with all its findings and the numbers that were measured, as docs/check.md has it.
nlohmann::ordered_json verdict_json(const Verdict& verdict);

}  // namespace candela::cli
