#include "base/parts.h"
#include "raster/render.h"
#include "viewer/viewer.h"

namespace candela::viewer {

void show(const ViewOptions&) {
  raster::check_built();
  throw absent_part("windows", "CANDELA_WITH_WINDOW");
}

}  // namespace candela::viewer
