#include "base/parts.h"
#include "cli/viewer.h"
#include "raster/render.h"

namespace candela::cli {

void show(const ViewOptions&) {
  raster::check_built();
  throw absent_part("windows", "CANDELA_WITH_WINDOW");
}

}  // namespace candela::cli
