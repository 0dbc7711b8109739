// A product shot by either engine: a lens, a background, three pictures all around the subject.
//
//     product_shot [SCENE [path|raster]]      writes product-0.png to product-2.png

#include <iostream>

#include "candela/shot.h"

int main(int argc, char** argv) {
  candela::Shot shot{.scene = argc > 1 ? argv[1] : "demo:spheres"};
  shot.engine = argc > 2 && argv[2][0] == 'r' ? candela::Engine::raster : candela::Engine::path;
  shot.size = {320, 180};
  shot.traced.samples = shot.drawn.frames = 16;
  shot.orbit = candela::Orbit{.azimuth = 0.5f, .elevation = 0.3f};
  shot.turntable = 3;
  shot.f_number = 4.0f;
  shot.background = candela::Background::transparent;
  shot.background_color = candela::vec3(0.8f);
  try {
    candela::Take(shot).render([](const candela::TakenPicture& picture) {
      const std::string file = "product-" + std::to_string(picture.index) + ".png";
      candela::write_film(file, picture.film, picture.develop);
      std::cout << file << ": " << picture.film.metadata.at("integrator") << '\n';
    });
  } catch (const candela::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
