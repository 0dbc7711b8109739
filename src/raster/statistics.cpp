#include "raster/render.h"

namespace candela::raster {

void add_work(const Statistics& picture, Statistics& all) {
  all.driver = picture.driver;
  all.interrupted |= picture.interrupted;
  all.is_light_cached = picture.is_light_cached;
  all.open_s += picture.open_s;
  all.light_s += picture.light_s;
  all.upload_s += picture.upload_s;
  all.shadow_s += picture.shadow_s;
  all.compile_s += picture.compile_s;
  all.frame_s += picture.frame_s;
  all.draw_s += picture.draw_s;
  all.frames += picture.frames;
  all.programs = picture.programs;
  all.triangles = picture.triangles;
  all.draws = picture.draws;
  all.non_finite_pixels += picture.non_finite_pixels;
}

}  // namespace candela::raster
