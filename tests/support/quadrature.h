#pragma once

#include "study/quadrature.h"

namespace candela::test {

using study::DirectionFunction;
using study::HemisphereQuadrature;
using study::integrate;
using study::QuadratureOptions;

}  // namespace candela::test
