#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "figures/figure.h"
#include "figures/markup.h"

// Drawings of what the words mean: facets, solid angle, radiance, the reflectance equation.

namespace candela::figures {
namespace {

/// A drawing of lines, arrows and letters in units of pixels.
class Sketch {
 public:
  Sketch(std::string title, int width, int height) : title_(std::move(title)), width_(width), height_(height) {}

  void path(const std::string& data, const char* kind = "line") {
    body_ += fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind, data);
  }
  void line(dvec2 a, dvec2 b, const char* kind = "line") {
    path(fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", a.x, a.y, b.x, b.y), kind);
  }
  void arrow(dvec2 a, dvec2 b, const char* kind = "line") {
    const dvec2 way = glm::normalize(b - a), aside(-way.y, way.x);
    line(a, b - 6.0 * way, kind);
    const dvec2 p = b - 11.0 * way + 4.5 * aside, q = b - 11.0 * way - 4.5 * aside;
    body_ += fmt::format("<path class=\"head {}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\"/>\n", kind, b.x,
                         b.y, p.x, p.y, q.x, q.y);
  }
  void letter(dvec2 at, const std::string& what, const char* kind = "letter") {
    body_ += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", kind, at.x, at.y, escaped(what));
  }
  std::string svg() const {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\">\n"
        "<title>{2}</title>\n<style>"
        "text{{font:17px system-ui,-apple-system,'Segoe UI','DejaVu Sans',sans-serif;text-anchor:middle;fill:#222}}"
        ".letter{{font-style:italic;font-weight:600}}.words{{font-size:14px;fill:#555}}"
        ".line{{stroke:#222;stroke-width:1.8;fill:none;stroke-linejoin:round}}.head{{stroke:none;fill:#222}}"
        ".light{{stroke:#d55e00;stroke-width:2.2;fill:none}}.head.light{{fill:#d55e00;stroke:none}}"
        ".eye{{stroke:#0072b2;stroke-width:2.2;fill:none}}.head.eye{{fill:#0072b2;stroke:none}}"
        ".soft{{stroke:#888;stroke-width:1.2;fill:none;stroke-dasharray:5 4}}.head.soft{{fill:#888;stroke:none}}"
        ".area{{fill:#0072b2;fill-opacity:.14;stroke:#0072b2;stroke-width:1.2}}"
        "@media(prefers-color-scheme:dark){{text{{fill:#ddd}}.words{{fill:#aaa}}.line{{stroke:#ddd}}.head{{fill:#ddd}}"
        ".light{{stroke:#e8853d}}.head.light{{fill:#e8853d}}.eye{{stroke:#56b4e9}}.head.eye{{fill:#56b4e9}}"
        ".area{{fill:#56b4e9;stroke:#56b4e9}}}}</style>\n{3}</svg>\n",
        width_, height_, escaped(title_), body_);
  }

 private:
  std::string title_;
  int width_, height_;
  std::string body_;
};

constexpr double kDegree = std::numbers::pi / 180.0;

/// A point at a distance from another, by its angle to the upward normal, to the right.
dvec2 at_angle(dvec2 from, double degrees, double distance) {
  return from + distance * dvec2(std::sin(degrees * kDegree), -std::cos(degrees * kDegree));
}

/// Part of a circle between two such angles.
std::string arc(dvec2 center, double radius, double begin, double end) {
  const dvec2 a = at_angle(center, begin, radius), b = at_angle(center, end, radius);
  return fmt::format("M{:.1f} {:.1f}A{:.1f} {:.1f} 0 0 1 {:.1f} {:.1f}", a.x, a.y, radius, radius, b.x, b.y);
}

// ----- facets

std::string half_vector_sketch() {
  Sketch s("Directions at a surface: n, l, v and h between them", 420, 260);
  const dvec2 p(210, 215);
  s.line({40, 215}, {380, 215});
  s.arrow(p, at_angle(p, 0, 165));
  s.letter(at_angle(p, 0, 182), "n");
  s.arrow(p, at_angle(p, -58, 165), "light");
  s.letter(at_angle(p, -58, 183), "l");
  s.arrow(p, at_angle(p, 30, 165), "eye");
  s.letter(at_angle(p, 30, 183), "v");
  s.arrow(p, at_angle(p, -14, 130), "soft");
  s.letter(at_angle(p, -17, 148), "h");
  s.path(arc(p, 60, -58, -14), "soft");
  s.path(arc(p, 68, -14, 30), "soft");
  s.letter(at_angle(p, 15, 114), "θ");
  s.path(arc(p, 100, 0, 30), "soft");
  return s.svg();
}

std::string facets_sketch() {
  Sketch s("Facets: some mirror the light to the eye, others are in shadow or masked", 420, 260);
  const std::array<dvec2, 12> profile{{{20, 190},
                                       {60, 168},
                                       {92, 196},
                                       {128, 160},
                                       {166, 192},
                                       {206, 172},
                                       {238, 176},
                                       {268, 140},
                                       {304, 196},
                                       {338, 164},
                                       {372, 190},
                                       {400, 178}}};
  std::string data;
  for (const dvec2 p : profile) data += fmt::format("{}{:.0f} {:.0f}", data.empty() ? 'M' : 'L', p.x, p.y);
  s.path(data + "L400 220L20 220Z", "area");
  s.path(data);
  const dvec2 hit(222, 174), shadow(290, 172), masked(176, 187);
  s.arrow(at_angle(hit, -48, 150), hit, "light");
  s.arrow(hit, at_angle(hit, 46, 128), "eye");
  s.arrow(hit, at_angle(hit, -1, 92), "soft");
  s.letter(at_angle(hit, -2, 106), "h");
  s.arrow(at_angle(dvec2(259, 148), -48, 112), {259, 148}, "light");
  s.path(fmt::format("M259 148L{:.0f} {:.0f}", shadow.x, shadow.y), "soft");
  s.letter({308, 232}, "in shadow", "words");
  s.arrow(at_angle(masked, -48, 162), masked, "light");
  s.path(fmt::format("M{:.0f} {:.0f}L262 146", masked.x, masked.y), "soft");
  s.letter({160, 232}, "masked", "words");
  return s.svg();
}

// ----- radiance

std::string solid_angle_sketch() {
  Sketch s("Solid angle: the area that a cone cuts out of the unit sphere", 420, 260);
  const dvec2 c(150, 200);
  s.path(arc(c, 130, -90, 90), "soft");
  s.line({10, 200}, {290, 200}, "soft");
  const dvec2 a = at_angle(c, 25, 130), b = at_angle(c, 52, 130);
  s.path(
      fmt::format("M{0:.1f} {1:.1f}A130 130 0 0 1 {2:.1f} {3:.1f}A22 34 38 0 1 {0:.1f} {1:.1f}Z", a.x, a.y, b.x, b.y),
      "area");
  s.line(c, at_angle(c, 25, 240), "light");
  s.line(c, at_angle(c, 52, 240), "light");
  s.letter(at_angle(c, 38.5, 176), "dω");
  s.letter({c.x, 222}, "p");
  s.letter({66, 120}, "r = 1");
  s.letter({330, 160}, "dω = sin θ dθ dφ", "words");
  s.letter({330, 184}, "all directions: 4π", "words");
  s.letter({330, 208}, "the hemisphere Ω: 2π", "words");
  return s.svg();
}

std::string radiance_sketch() {
  Sketch s("Radiance: power by area across the beam and by solid angle", 420, 260);
  const dvec2 p(170, 205);
  s.line({30, 205}, {310, 205});
  s.path("M140 205L200 205L200 211L140 211Z", "area");
  s.letter({170, 232}, "dA");
  const dvec2 top = at_angle(p, 42, 190);
  s.path(fmt::format("M140 205L{:.0f} {:.0f}M200 205L{:.0f} {:.0f}", top.x - 26, top.y - 16, top.x + 22, top.y + 26),
         "light");
  s.arrow(p, at_angle(p, 0, 130));
  s.letter(at_angle(p, 0, 146), "n");
  s.arrow(top, p + 0.12 * (top - p), "light");
  s.path(arc(p, 80, 0, 42), "soft");
  s.letter(at_angle(p, 21, 98), "θ");
  s.letter(at_angle(p, 46, 212), "dω");
  s.letter({100, 24}, "L = d²Φ / (dω dA cos θ)", "words");
  s.letter({100, 46}, "W / (m² sr), or cd/m²", "words");
  return s.svg();
}

std::string reflectance_sketch() {
  Sketch s("The reflectance equation: all that arrives, by what the surface sends of it to the eye", 420, 260);
  const dvec2 p(210, 205);
  s.line({30, 205}, {390, 205});
  s.path(arc(p, 165, -90, 90), "soft");
  for (const double angle : {-75.0, -52.0, -30.0, -8.0, 14.0, 62.0, 80.0}) {
    s.arrow(at_angle(p, angle, 165), at_angle(p, angle, 62), "light");
  }
  s.letter(at_angle(p, -41, 150), "L_i");
  s.path("M210 205C192 170 168 116 190 104C212 96 262 108 268 134C272 156 232 190 210 205Z", "area");
  s.letter({226, 150}, "f");
  s.arrow(p, at_angle(p, 40, 195), "eye");
  s.letter(at_angle(p, 40, 212), "L_o");
  s.letter({210, 236}, "for each direction of Ω: radiance × cos θ × dω × f, all added up", "words");
  return s.svg();
}

Figure facets_figure(FigureContext&) {
  Figure figure;
  figure.text = {
      "The directions that all formulas are made of, and the picture behind them: a surface is small mirrors, too "
      "small to "
      "see, that look about its normal. Only those that look half way between lamp and eye show the one to the other; "
      "of "
      "these, some do not see the lamp (shadow), and some the eye does not see (masking)."};
  figure.formulas = {"h = \\frac{l + v}{|l + v|}", "f(l, v) = \\frac{D(h) F(v·h) G(l, v)}{4 (n·l) (n·v)}"};
  figure.sources = {"Torrance & Sparrow 1967, Theory for Off-Specular Reflection from Roughened Surfaces",
                    "Walter, Marschner, Li & Torrance 2007, Microfacet Models for Refraction through Rough Surfaces"};
  figure.columns = 2;
  figure.panels = {{"sketch-facets-directions.svg", half_vector_sketch(),
                    "h is half way between l and v; θ is an angle to the normal"},
                   {"sketch-facets-profile.svg", facets_sketch(),
                    "facets, cut: D is how many look along h, G how many of these both see, F what each reflects"}};
  return figure;
}

Figure radiance_figure(FigureContext&) {
  Figure figure;
  figure.text = {
      "What is measured of light. Solid angle is to directions what area is to places. Radiance is power by area and "
      "solid "
      "angle: what an eye or a camera sees of a place, and what does not thin with distance. Irradiance is all that "
      "falls "
      "on a surface, each part by its cosine. The reflectance equation adds up, over all directions that light comes "
      "from, "
      "what the surface sends of it to the eye."};
  figure.formulas = {"E(n) = ∫_Ω L_i(l) (n·l) \\text{ d}l", "L_o(v) = ∫_Ω f(l, v) L_i(l) (n·l) \\text{ d}l"};
  figure.sources = {"Nicodemus et al. 1977, Geometrical Considerations and Nomenclature for Reflectance",
                    "de Vries, LearnOpenGL, PBR theory", "Kajiya 1986, The Rendering Equation"};
  figure.columns = 3;
  figure.panels = {{"sketch-radiance-solid-angle.svg", solid_angle_sketch(), "solid angle"},
                   {"sketch-radiance-beam.svg", radiance_sketch(),
                    "radiance: a beam keeps it on its way; a tilted surface gets less of it by cos θ"},
                   {"sketch-radiance-reflectance.svg", reflectance_sketch(), "the reflectance equation"}};
  return figure;
}

}  // namespace

void add_sketch_figures(std::vector<FigureInfo>& list) {
  list.push_back({"sketch-facets", "Facets, and the directions at them", Chapter::facets, facets_figure});
  list.push_back({"sketch-radiance", "Solid angle, radiance, reflectance", Chapter::integrals, radiance_figure});
}

}  // namespace candela::figures
