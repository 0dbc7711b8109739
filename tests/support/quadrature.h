#pragma once

#include "laws/quadrature.h"

namespace candela::test {

using laws::DirectionFunction;
using laws::HemisphereQuadrature;
using laws::integrate;
using laws::QuadratureOptions;

}  // namespace candela::test
