#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "content/demo.h"
#include "figures/figure.h"
#include "ibl/cube.h"
#include "ibl/irradiance.h"
#include "ibl/kernel.h"
#include "ibl/prefilter.h"
#include "ibl/source.h"
#include "image/cube_panorama.h"

// An environment and what is made of it, and the parts of a picture that add up.

namespace candela::figures {
namespace {

/// `scale` times an image, as a film.
Film film_of(Image image, float scale = 1.0f) {
  for (float& v : image.pixels) v *= scale;
  Film film;
  film.beauty = Image(image.width, image.height, 4);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      film.beauty.set_rgb(x, y, image.rgb(x, y));
      film.beauty.at(x, y)[3] = 1.0f;
    }
  }
  return film;
}

constexpr std::array<const char*, 2> kEnvironments{"studio", "sky"};

Figure irradiance_pictures(FigureContext& context) {
  Figure figure;
  figure.text = {
      "An environment, unrolled so that up is at the top and the picture’s middle is straight ahead, and beside it "
      "what a "
      "matt white surface would show that looks into each direction: the irradiance over π. A cosine is so wide a lobe "
      "that nothing of a lamp’s shape is left; 32 texels along a face are plenty, and nine numbers nearly so. The sun "
      "of the sky is in neither: it is a lamp, with shadows."};
  figure.formulas = {"E(n) = ∫_Ω L_i(l) (n·l) \\text{ d}l"};
  figure.sources = {"Ramamoorthi & Hanrahan 2001, An Efficient Representation for Irradiance Environment Maps",
                    "de Vries, LearnOpenGL, Diffuse irradiance"};
  figure.functions = {"ibl::irradiance_cube", "equirect_from_cube"};
  figure.commands = {"candela bake studio -o studio"};
  figure.columns = 2;
  const int width = context.pixels(512);
  for (const char* name : kEnvironments) {
    context.check_stop();
    Environment environment = context.environment(name);
    environment.suns.clear();
    const ibl::Source source = ibl::make_source(environment);
    const DevelopSettings shown{.exposure = environment.exposure.value_or(1.0f)};
    const Image map = equirect_from_cube(ibl::cube_from_source(source, 256), width);
    const Image irradiance = equirect_from_cube(ibl::irradiance_cube(source, 32), width);
    figure.panels.push_back({fmt::format("irradiance-pictures-{}.png", name), develop(film_of(map), shown), name});
    figure.panels.push_back({fmt::format("irradiance-pictures-{}-map.png", name),
                             develop(film_of(irradiance, 1.0f / kPi), shown), "its irradiance / π"});
  }
  return figure;
}

Figure prefiltered_chain(FigureContext& context) {
  Figure figure;
  figure.text = {
      "The studio blurred by the lobe of each roughness, as the levels of one cube: a mirror reads the first, and a "
      "rough "
      "metal the last. The wider the lobe, the fewer texels hold all that is left."};
  figure.formulas = {"∫_Ω f L_i (n·l) \\text{ d}l ≈ ( ∫_Ω L_i D (n·l) \\text{ d}l ) ( F_0 A + F_{90} B )"};
  figure.sources = {"Karis 2013, Real Shading in Unreal Engine 4"};
  figure.functions = {"ibl::Prefilter", "equirect_from_cube"};
  figure.commands = {"candela bake studio -o studio"};
  figure.columns = 3;
  Environment environment = context.environment("studio");
  environment.suns.clear();
  const ibl::Source source = ibl::make_source(environment);
  const std::array<float, 5> roughness{0.2f, 0.4f, 0.6f, 0.8f, 1.0f};
  std::vector<ibl::Kernel> kernels;
  for (const float r : roughness) kernels.emplace_back(ibl::Lobe::ggx, r);
  const ibl::Prefilter prefilter(source, kernels, {});
  const int width = context.pixels(400);
  const DevelopSettings shown{.exposure = 1.0f};
  figure.panels.push_back({"prefiltered-chain-0.png",
                           develop(film_of(equirect_from_cube(ibl::cube_from_source(source, 256), width)), shown),
                           "r = 0: the environment itself, 256 texels along a face"});
  int size = 128;
  for (std::size_t i = 0; i < kernels.size(); ++i, size = std::max(size / 2, 32)) {
    context.check_stop();
    figure.panels.push_back({fmt::format("prefiltered-chain-{}.png", i + 1),
                             develop(film_of(equirect_from_cube(prefilter.faces(kernels[i], size), width)), shown),
                             fmt::format("r = {:.1f}, {} texels along a face", roughness[i], size)});
  }
  return figure;
}

Figure parts_of_a_picture(FigureContext& context) {
  Figure figure;
  figure.text = {
      "A frame in real time, and its parts by kind of light and lobe. The first two add up to the third, which with "
      "the "
      "lamps and what glows is the whole; linear light adds, what a display shows does not. The number below a sum is "
      "how far it is from the picture beside it."};
  figure.formulas = {"L_o = L_{\\op{diffuse}} + L_{\\op{specular}} + L_{\\op{lamps}} + L_e"};
  figure.sources = {"Karis 2013, Real Shading in Unreal Engine 4"};
  figure.functions = {"raster::Drawer::render with raster::Quantity"};
  figure.columns = 3;
  if (!context.has_opengl()) {
    figure.left_out.emplace_back("all of it, which needs OpenGL");
    return figure;
  }
  const Scene scene = content::make_demo("relief");
  raster::Settings settings;
  settings.width = context.pixels(400);
  settings.height = context.pixels(225);
  settings.frames = 2;
  const View view = scene_camera(scene, "0", 16.0f / 9.0f);
  const Environment& sky = context.environment(scene.preferred_environment.value_or("sky"));
  const DevelopSettings shown{.exposure = scene.preferred_exposure.value_or(sky.exposure.value_or(1.0f))};
  const auto draw = [&](raster::Quantity quantity) {
    raster::Settings of = settings;
    of.quantity = quantity;
    return *context.draw(scene, sky, view, of);
  };
  const auto sum_of = [](const Film& a, const Film& b) {
    Image sum = a.beauty;
    for (std::size_t i = 0; i < sum.pixels.size(); ++i) sum.pixels[i] += b.beauty.pixels[i];
    return sum;
  };
  using raster::Quantity;
  const Film diffuse = draw(Quantity::diffuse), specular = draw(Quantity::specular), ambient = draw(Quantity::ambient);
  const Film lamps = draw(Quantity::direct), all = draw(Quantity::light);
  const std::string first = percent_text(relative_error(sum_of(diffuse, specular), ambient.beauty));
  const auto add = [&](const char* view_name, const char* caption, const Film& film, const std::string& error = {}) {
    figure.panels.push_back(
        {fmt::format("parts-of-a-picture-{}.png", view_name), develop(film, shown), caption, error});
    figure.commands.push_back(
        fmt::format("candela render demo:relief --engine raster --view {} -o {}.png", view_name, view_name));
  };
  add("diffuse", "diffuse, from far away", diffuse);
  add("specular", "specular, from far away", specular);
  add("ambient", "all from far away", ambient, first + " from the sum of the two");
  add("direct", "the sun", lamps);
  const Film sum = film_of(sum_of(ambient, lamps));
  figure.panels.push_back({"parts-of-a-picture-sum.png", develop(sum, shown), "the last two added up"});
  figure.panels.push_back({"parts-of-a-picture-light.png", develop(all, shown), "the frame, its background included"});
  return figure;
}

}  // namespace

void add_surroundings_figures(std::vector<FigureInfo>& list) {
  const Chapter c = Chapter::image_light;
  list.push_back({"irradiance-pictures", "An environment beside its irradiance map", c, irradiance_pictures});
  list.push_back({"prefiltered-chain", "The prefiltered levels", c, prefiltered_chain});
  list.push_back({"parts-of-a-picture", "Parts that add up", c, parts_of_a_picture});
}

}  // namespace candela::figures
