#include "figures/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "figures/markup.h"

namespace candela::figures {

Ink categorical_ink(int i) {
  constexpr std::array<Ink, 7> kInks{{{"#0072b2", "#56b4e9"},
                                      {"#d55e00", "#e8853d"},
                                      {"#009e73", "#2cc69a"},
                                      {"#b3578c", "#de9cc4"},
                                      {"#a67700", "#e6b32e"},
                                      {"#2b90c9", "#8fd0f5"},
                                      {"#555555", "#bbbbbb"}}};
  return kInks[static_cast<std::size_t>(i) % kInks.size()];
}

Ink sequential_ink(int i, int count) {
  constexpr std::array<std::string_view, 10> kPlasma{"#0d0887", "#46039f", "#7201a8", "#9c179e", "#bd3786",
                                                     "#d8576b", "#ed7953", "#fb9f3a", "#fdca26", "#f0f921"};
  // The lightest do not show on white, the darkest not on black.
  constexpr int kOnLight = 7, kOnDark = 3;
  const int most = std::max(count - 1, 1);
  const auto light = static_cast<std::size_t>((i * kOnLight + most / 2) / most);
  const auto dark = static_cast<std::size_t>(kOnDark + (i * (9 - kOnDark) + most / 2) / most);
  return {kPlasma[std::min(light, kPlasma.size() - 1)], kPlasma[std::min(dark, kPlasma.size() - 1)]};
}

// ----- ticks

std::vector<double> even_ticks(double low, double high, double step) {
  std::vector<double> ticks;
  const double slack = 1e-9 * (high - low);
  for (double i = std::ceil((low - slack) / step); i * step <= high + slack; i += 1.0) ticks.push_back(i * step);
  return ticks;
}

std::vector<double> round_ticks(double low, double high, int count) {
  const double rough = (high - low) / std::max(count, 1);
  const double magnitude = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * magnitude;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * magnitude >= rough * (1.0 - 1e-9)) step = factor * magnitude;
  }
  return even_ticks(low, high, step);
}

std::vector<double> logarithmic_ticks(double low, double high, int count) {
  constexpr double kSlack = 1e-9;
  const auto first = static_cast<int>(std::ceil(std::log10(low) - kSlack));
  const auto last = static_cast<int>(std::floor(std::log10(high) + kSlack));
  std::vector<double> ticks;
  if (last - first < 1) {
    for (int e = first - 1; e <= last; ++e) {
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double tick = factor * std::pow(10.0, e);
        if (tick >= low * (1.0 - kSlack) && tick <= high * (1.0 + kSlack)) ticks.push_back(tick);
      }
    }
    return ticks;
  }
  const int step = std::max(1, (last - first + count) / std::max(count, 1));
  for (int e = first; e <= last; e += step) ticks.push_back(std::pow(10.0, e));
  return ticks;
}

std::string tick_text(double value) {
  constexpr std::array<std::string_view, 10> kSuperscripts{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  const double size = std::abs(value);
  if (size == 0.0 || (size >= 9.99e-4 && size < 1e5)) {
    std::string text = fmt::format("{:.6g}", size == 0.0 ? 0.0 : value);
    if (text[0] == '-') text.replace(0, 1, "−");
    return text;
  }
  int exponent = static_cast<int>(std::floor(std::log10(size) + 1e-9));
  const double mantissa = value / std::pow(10.0, exponent);
  std::string text = std::abs(mantissa - 1.0) < 1e-9 ? "10" : fmt::format("{:.3g}·10", mantissa);
  if (exponent < 0) text += "⁻";
  for (const char digit : std::to_string(std::abs(exponent))) {
    text += kSuperscripts[static_cast<std::size_t>(digit - '0')];
  }
  return text;
}

namespace {

constexpr double kWidth = 640.0;
constexpr double kTextHeight = 15.0;

/// About what a text takes in a sans-serif of 15 px.
double text_width(std::string_view text) {
  const auto is_first = [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; };
  return 7.9 * static_cast<double>(std::count_if(text.begin(), text.end(), is_first));
}

/// A picture that grows element by element.
class Svg {
 public:
  Svg(const std::string& title, double height) : title_(title), height_(height) {}

  /// The name of the class that has an ink as its colour.
  std::string ink_class(Ink ink) {
    const auto found =
        std::find_if(inks_.begin(), inks_.end(), [&](Ink i) { return i.light == ink.light && i.dark == ink.dark; });
    if (found == inks_.end()) {
      inks_.push_back(ink);
      return fmt::format("k{}", inks_.size() - 1);
    }
    return fmt::format("k{}", found - inks_.begin());
  }

  void line(const char* kind, dvec2 a, dvec2 b) {
    body_ += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind, a.x,
                         a.y, b.x, b.y);
  }
  void text(const std::string& kind, dvec2 at, const char* anchor, std::string_view what) {
    body_ += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", kind, at.x,
                         at.y, anchor, escaped(what));
  }
  void circle(const std::string& kind, dvec2 at, double radius) {
    body_ += fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n", kind, at.x, at.y, radius);
  }
  /// `data` is of SVG's path syntax.
  void path(const std::string& kind, const std::string& data, const std::string& attributes = {}) {
    if (!data.empty()) body_ += fmt::format("<path class=\"{}\" d=\"{}\"{}/>\n", kind, data, attributes);
  }
  void raw(const std::string& element) { body_ += element; }

  std::string whole() const {
    std::string style =
        "text{font:15px system-ui,-apple-system,'Segoe UI','DejaVu Sans',sans-serif;fill:#222}"
        ".tick{fill:#555;font-size:14px}"
        ".grid{stroke:#e3e3e3;stroke-width:1}.minor{stroke:#f2f2f2;stroke-width:1}"
        ".axis{stroke:#555;stroke-width:1.2;fill:none}"
        ".curve{fill:none;stroke:currentColor;stroke-width:2.2;stroke-linejoin:round}"
        ".mark{fill:currentColor}.lead{fill:none;stroke:currentColor;stroke-width:1;opacity:.55}"
        ".lobe{stroke:currentColor;stroke-width:2;fill:currentColor;fill-opacity:.06;stroke-linejoin:round}"
        "text.name{fill:currentColor;paint-order:stroke;stroke:#fff;stroke-width:4;stroke-linejoin:round}";
    std::string dark =
        "text{fill:#ddd}.tick{fill:#aaa}.grid{stroke:#3a3a3d}.minor{stroke:#2a2a2d}.axis{stroke:#aaa}text.name{stroke:#"
        "161618}";
    for (std::size_t i = 0; i < inks_.size(); ++i) {
      style += fmt::format(".k{}{{color:{}}}", i, inks_[i].light);
      dark += fmt::format(".k{}{{color:{}}}", i, inks_[i].dark);
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
        "height=\"{1:.0f}\" role=\"img\">\n<title>{2}</title>\n<style>{3}@media(prefers-color-scheme:dark)"
        "{{{4}}}</style>\n{5}</svg>\n",
        kWidth, height_, escaped(title_), style, dark, body_);
  }

 private:
  std::string title_;
  double height_;
  std::vector<Ink> inks_;
  std::string body_;
};

std::string dashes(Stroke stroke) {
  if (stroke == Stroke::dashed) return " stroke-dasharray=\"8 5\"";
  if (stroke == Stroke::dotted) return " stroke-dasharray=\"2 4\"";
  return {};
}

/// From an axis' values to pixels.
class Mapping {
 public:
  Mapping(const Axis& axis, double from, double to) : axis_(axis), from_(from), to_(to) {
    if (!(axis.low < axis.high)) throw Error("an axis without extent", axis.label);
    if (is_logarithmic() && !(axis.low > 0.0)) throw Error("a logarithmic axis that reaches 0", axis.label);
  }

  bool is_logarithmic() const { return axis_.scale == Scale::logarithmic; }
  double operator()(double value) const {
    const double t = is_logarithmic() ? std::log(value / axis_.low) / std::log(axis_.high / axis_.low)
                                      : (value - axis_.low) / (axis_.high - axis_.low);
    return from_ + t * (to_ - from_);
  }
  bool is_drawable(double value) const { return std::isfinite(value) && (!is_logarithmic() || value > 0.0); }

  std::vector<double> ticks() const {
    const int count = static_cast<int>(std::abs(to_ - from_) / 60.0);
    if (is_logarithmic()) return logarithmic_ticks(axis_.low, axis_.high, count);
    return axis_.step > 0.0 ? even_ticks(axis_.low, axis_.high, axis_.step) : round_ticks(axis_.low, axis_.high, count);
  }
  /// Between the powers of ten, while there are few of them.
  std::vector<double> minor_ticks() const {
    std::vector<double> ticks;
    if (!is_logarithmic() || axis_.high / axis_.low > 1e6) return ticks;
    for (int e = static_cast<int>(std::floor(std::log10(axis_.low))); std::pow(10.0, e) < axis_.high; ++e) {
      for (int digit = 2; digit < 10; ++digit) {
        const double tick = digit * std::pow(10.0, e);
        if (tick > axis_.low && tick < axis_.high) ticks.push_back(tick);
      }
    }
    return ticks;
  }

 private:
  const Axis& axis_;
  double from_, to_;
};

/// Where the labels of curves stand beside the diagram.
struct EndLabel {
  const Curve* curve = nullptr;
  dvec2 end{0.0};   ///< of the curve, pixels
  double at = 0.0;  ///< the label's middle
};

/// Moves labels apart until none overlaps another, and none leaves [low, high] while there is room.
void spread(std::vector<EndLabel>& labels, double low, double high) {
  constexpr double kGap = kTextHeight + 4.0;
  std::stable_sort(labels.begin(), labels.end(),
                   [](const EndLabel& a, const EndLabel& b) { return a.end.y < b.end.y; });
  double top = low;
  for (EndLabel& label : labels) {
    label.at = std::max(label.end.y, top);
    top = label.at + kGap;
  }
  double bottom = high;
  std::for_each(labels.rbegin(), labels.rend(), [&bottom](EndLabel& label) {
    label.at = std::min(label.at, bottom);
    bottom = label.at - kGap;
  });
}

struct Frame {
  double left, right, top, bottom;
};

void draw_axes(Svg& svg, const Plot& plot, const Mapping& x, const Mapping& y, const Frame& f) {
  for (const double tick : x.minor_ticks()) svg.line("minor", {x(tick), f.top}, {x(tick), f.bottom});
  for (const double tick : y.minor_ticks()) svg.line("minor", {f.left, y(tick)}, {f.right, y(tick)});
  for (const double tick : x.ticks()) {
    svg.line("grid", {x(tick), f.top}, {x(tick), f.bottom});
    svg.line("axis", {x(tick), f.bottom}, {x(tick), f.bottom + 5});
    svg.text("tick", {x(tick), f.bottom + 21}, "middle", tick_text(tick));
  }
  for (const double tick : y.ticks()) {
    svg.line("grid", {f.left, y(tick)}, {f.right, y(tick)});
    svg.line("axis", {f.left - 5, y(tick)}, {f.left, y(tick)});
    svg.text("tick", {f.left - 9, y(tick) + 5}, "end", tick_text(tick));
  }
  svg.path("axis", fmt::format("M{:.1f} {:.1f}V{:.1f}H{:.1f}", f.left, f.top, f.bottom, f.right));
  svg.text("label", {0.5 * (f.left + f.right), f.bottom + 44}, "middle", plot.x.label);
  svg.text("label", {4.0, f.top - 14}, "start", plot.y.label);
}

/// Returns where the curve was last seen within the frame.
std::optional<dvec2> draw_curve(Svg& svg, const Curve& curve, const Mapping& x, const Mapping& y, const Frame& f) {
  const std::string ink = svg.ink_class(curve.ink);
  // Far outside the frame nothing is drawn, and renderers lose their digits.
  const double far = f.bottom - f.top;
  std::string data;
  std::optional<dvec2> end;
  bool is_pen_down = false;
  for (const dvec2 point : curve.points) {
    if (!x.is_drawable(point.x) || !y.is_drawable(point.y)) {
      is_pen_down = false;
      continue;
    }
    const dvec2 p(x(point.x), std::clamp(y(point.y), f.top - far, f.bottom + far));
    data += fmt::format("{}{:.1f} {:.2f}", is_pen_down ? 'L' : 'M', p.x, p.y);
    is_pen_down = true;
    if (p.x >= f.left - 0.5 && p.x <= f.right + 0.5 && p.y >= f.top - 0.5 && p.y <= f.bottom + 0.5) end = p;
    if (curve.has_markers && end == p) svg.circle("mark " + ink, p, 3.4);
  }
  svg.path("curve " + ink, data, dashes(curve.stroke) + " clip-path=\"url(#f)\"");
  return end;
}

/// Beside where a curve leaves the frame at the top or at the bottom, one above the other where they are near.
void draw_inner_labels(Svg& svg, const std::vector<EndLabel>& labels, const Frame& f) {
  constexpr double kAside = 7.0;
  struct Span {
    double from, to, y;
  };
  std::vector<Span> taken;
  for (const EndLabel& label : labels) {
    const bool is_top = label.end.y < 0.5 * (f.top + f.bottom);
    const double width = text_width(label.curve->label);
    const bool is_right = label.end.x + kAside + width < f.right;
    const double x = label.end.x + (is_right ? kAside : -kAside);
    Span span{is_right ? x : x - width, is_right ? x + width : x, is_top ? f.top + kTextHeight : f.bottom - 8};
    const auto overlaps = [&span](const Span& other) {
      return std::abs(other.y - span.y) < kTextHeight && other.from < span.to && span.from < other.to;
    };
    while (std::any_of(taken.begin(), taken.end(), overlaps)) span.y += is_top ? kTextHeight + 3 : -kTextHeight - 3;
    taken.push_back(span);
    svg.text("name " + svg.ink_class(label.curve->ink), {x, span.y}, is_right ? "start" : "end", label.curve->label);
  }
}

}  // namespace

std::string plot_svg(const Plot& plot) {
  double widest = 0.0;
  for (const Curve& curve : plot.curves) widest = std::max(widest, text_width(curve.label));
  const Frame f{66.0, kWidth - 14.0 - (widest > 0.0 ? widest + 22.0 : 0.0), 36.0, plot.height - 56.0};
  const Mapping x(plot.x, f.left, f.right), y(plot.y, f.bottom, f.top);

  Svg svg(plot.title, plot.height);
  svg.raw(
      fmt::format("<clipPath id=\"f\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>"
                  "</clipPath>\n",
                  f.left, f.top - 1.5, f.right - f.left, f.bottom - f.top + 3));
  draw_axes(svg, plot, x, y, f);
  std::vector<EndLabel> labels, inner;
  for (const Curve& curve : plot.curves) {
    const std::optional<dvec2> end = draw_curve(svg, curve, x, y, f);
    if (!end || curve.label.empty()) continue;
    (end->x > f.right - 8 ? labels : inner).push_back({&curve, *end, 0.0});
  }
  draw_inner_labels(svg, inner, f);
  spread(labels, f.top + 4, f.bottom - 4);
  for (const EndLabel& label : labels) {
    const std::string ink = svg.ink_class(label.curve->ink);
    svg.path("lead " + ink, fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}", label.end.x, label.end.y,
                                        f.right + 3, label.end.y, f.right + 16, label.at));
    svg.text("name " + ink, {f.right + 19, label.at + 5}, "start", label.curve->label);
  }
  return svg.whole();
}

namespace {

/// Polar to pixels: 0° is up, positive to the right.
dvec2 polar(dvec2 center, double degrees, double radius) {
  const double angle = degrees * 3.14159265358979 / 180.0;
  return center + radius * dvec2(std::sin(angle), -std::cos(angle));
}

void draw_rings(Svg& svg, const PolarPlot& plot, dvec2 center, double radius) {
  for (const double ring : round_ticks(0.0, plot.radius, 4)) {
    if (ring <= 0.0) continue;
    const double r = radius * ring / plot.radius;
    svg.path("grid",
             fmt::format("M{:.1f} {:.1f}A{:.1f} {:.1f} 0 0 1 {:.1f} {:.1f}", center.x - r, center.y, r, r, center.x + r,
                         center.y),
             " fill=\"none\"");
    svg.text("tick", {center.x + r, center.y + 19}, "middle", tick_text(ring));
  }
  for (int degrees = -90; degrees <= 90; degrees += 30) {
    svg.line("grid", center, polar(center, degrees, radius));
    const dvec2 at = polar(center, degrees, radius + 16);
    const char* anchor = degrees == 0 ? "middle" : degrees < 0 ? "end" : "start";
    if (std::abs(degrees) < 90) svg.text("tick", at + dvec2(0, 5), anchor, fmt::format("{}°", std::abs(degrees)));
  }
  svg.line("axis", {center.x - radius - 8, center.y}, {center.x + radius + 8, center.y});
  svg.text("label", {center.x, center.y + 40}, "middle", plot.label);
}

void draw_arrow(Svg& svg, const PolarPlot& plot, dvec2 center, double radius) {
  const double degrees = *plot.incoming;
  const dvec2 from = polar(center, degrees, radius);
  const dvec2 along = glm::normalize(center - from), across(-along.y, along.x);
  const dvec2 tip = center - 3.0 * along, back = tip - 11.0 * along;
  svg.line("axis", from, tip);
  svg.path("axis", fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}", back.x + 4 * across.x,
                               back.y + 4 * across.y, tip.x, tip.y, back.x - 4 * across.x, back.y - 4 * across.y));
  const dvec2 at = polar(center, degrees, radius + 34);
  svg.text("label", at + dvec2(0, 5), degrees < 0 ? "end" : "start", plot.incoming_label);
}

}  // namespace

std::string polar_plot_svg(const PolarPlot& plot) {
  if (!(plot.radius > 0.0)) throw Error("a polar diagram without extent", plot.title);
  double widest = 0.0;
  for (const Lobe& lobe : plot.lobes) widest = std::max(widest, text_width(lobe.label));
  const double legend = widest > 0.0 ? widest + 40.0 : 0.0;
  const double radius = 0.5 * (kWidth - legend) - 52.0;
  const dvec2 center(52.0 + radius, radius + 34.0);
  Svg svg(plot.title, center.y + 52.0);
  draw_rings(svg, plot, center, radius);
  double row = 30.0;
  for (const Lobe& lobe : plot.lobes) {
    const std::string ink = svg.ink_class(lobe.ink);
    std::string data;
    for (const dvec2 point : lobe.points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
      const dvec2 p = polar(center, point.x, radius * std::min(point.y / plot.radius, 1.05));
      data += fmt::format("{}{:.1f} {:.1f}", data.empty() ? 'M' : 'L', p.x, p.y);
    }
    svg.path("lobe " + ink, data, dashes(lobe.stroke));
    if (lobe.label.empty()) continue;
    svg.path("curve " + ink, fmt::format("M{:.1f} {:.1f}h22", kWidth - legend, row - 5), dashes(lobe.stroke));
    svg.text("name " + ink, {kWidth - legend + 29, row}, "start", lobe.label);
    row += kTextHeight + 7.0;
  }
  if (plot.incoming) draw_arrow(svg, plot, center, radius);
  return svg.whole();
}

}  // namespace candela::figures
