// The library in one page: load a scene, render it, write a picture.
//
//     render_gltf [SCENE [PICTURE]]      SCENE is a .glb, a .gltf or a built-in demo:NAME

#include <iostream>

#include "candela/candela.h"

int main(int argc, char** argv) {
  const char* source = argc > 1 ? argv[1] : "demo:spheres";
  const char* picture = argc > 2 ? argv[2] : "picture.png";
  try {
    const candela::Scene scene = candela::load(source);
    const candela::Film film = candela::render(scene, {.width = 320, .height = 180, .samples = 16});
    candela::write_film(picture, film, candela::default_develop(scene));
    std::cout << picture << ": " << film.width() << "x" << film.height() << '\n';
  } catch (const candela::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
