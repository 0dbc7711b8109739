#pragma once

#include <string>
#include <vector>

#include "image/image.h"
#include "image/job.h"
#include "laws/laws.h"
#include "laws/surfaces.h"

namespace candela::laws {

/// The worst of every law over the roughnesses of one group of the table.
struct MatrixRow {
  std::string group;
  int surfaces = 0;
  Measurement worst;
  Promise promise;
  bool holds = true;  ///< within what is promised
};

/// Measures lobes alone and typical surfaces, or with `all` every row of the table, on all threads, from which
/// it reports. After a stop it ends with the groups of which every surface is measured.
std::vector<MatrixRow> law_matrix(bool all, const Job& job = {});

/// Whether a measurement keeps a promise. What single precision and quadrature cannot tell is forgiven.
bool keeps(const Measurement& measurement, const Promise& promise, bool is_bent);

/// White spheres in a white furnace, one row per material and roughness 0 to 1 from left to right. What returns all
/// light cannot be told from the background. Tenfold amplified, light that is lost is blue and light that is made red;
/// the strip below runs from 10 % lost to 10 % gained. Encoded sRGB values in [0, 1]. Spheres that are not drawn after
/// a stop are black.
Image furnace_sheet(const Job& job = {});
/// The materials of its rows, from the top.
std::vector<std::string> furnace_sheet_rows();

}  // namespace candela::laws
