#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "math/types.h"

/// Diagrams as SVG 1.1 texts that stand alone: no script, no font, no other file. Colours follow the reader's light or
/// dark mode (prefers-color-scheme).
namespace candela::figures {

/// The same line on white and on black paper, "#rrggbb".
struct Ink {
  std::string_view light;
  std::string_view dark;
};
/// Kinds of things, told apart by people with any colour vision: Okabe & Ito 2008, "Color Universal Design". Repeats
/// after 7.
Ink categorical_ink(int i);
/// One of `count` steps of a quantity, from little (blue) to much (yellow), even in lightness: samples of Plasma
/// (Smith & van der Walt 2015). `count` from 1 on.
Ink sequential_ink(int i, int count);

enum class Scale { linear, logarithmic };

struct Axis {
  std::string label;  ///< with the unit
  double low = 0.0;
  double high = 1.0;
  Scale scale = Scale::linear;
  double step = 0.0;  ///< between labelled ticks of a linear axis; 0 = a round one
};

enum class Stroke { solid, dashed, dotted };

struct Curve {
  std::string label;          ///< stands at its right end; empty = none
  std::vector<dvec2> points;  ///< a gap where a coordinate is not finite or has no logarithm
  Ink ink = categorical_ink(0);
  Stroke stroke = Stroke::solid;
  bool has_markers = false;
};

struct Plot {
  std::string title;  ///< for those who cannot see it
  Axis x;
  Axis y;
  std::vector<Curve> curves = {};
  int height = 400;  ///< of a picture 640 wide
};
/// Throws Error where an axis has no extent, or a logarithmic one reaches 0.
std::string plot_svg(const Plot& plot);

/// A lobe above a surface, cut in the plane of incidence.
struct Lobe {
  std::string label;
  std::vector<dvec2> points;  ///< angle to the normal in degrees, -90 to 90, to the right; and radius
  Ink ink = categorical_ink(0);
  Stroke stroke = Stroke::solid;
};

struct PolarPlot {
  std::string title;
  double radius = 1.0;                  ///< of the outermost ring
  std::string label;                    ///< of the radius
  std::optional<double> incoming = {};  ///< an arrow from this angle to the surface, degrees
  std::string incoming_label = {};
  std::vector<Lobe> lobes = {};
};
std::string polar_plot_svg(const PolarPlot& plot);

/// Round values within [low, high] (1, 2 or 5 times a power of ten apart), about `count` of them.
std::vector<double> round_ticks(double low, double high, int count);
/// The same `step` apart.
std::vector<double> even_ticks(double low, double high, double step);
/// Powers of ten within [low, high], at most `count`; where there are fewer than two, 1, 2 and 5 times them.
std::vector<double> logarithmic_ticks(double low, double high, int count);
/// "0.25", "1000", "10⁻⁵".
std::string tick_text(double value);

}  // namespace candela::figures
