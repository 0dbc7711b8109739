#include "candela/preview_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>

#include "base/text.h"
#include "image/lettering.h"

namespace candela {

namespace {

constexpr int kMargin = 16;
constexpr int kMostLines = 18;  // below the views
constexpr std::uint8_t kPaper = 250;
constexpr Ink kBlack{34, 34, 34}, kGrey{110, 110, 110}, kRed{176, 0, 32}, kOrange{166, 90, 0};

/// 12345 as "12 345".
std::string grouped(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ' ');
  return text;
}

std::string megabytes(std::uint64_t bytes) { return fmt::format("{:.3g} MB", static_cast<double>(bytes) * 1e-6); }

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + (name.empty() ? "unnamed" : name);
  return text;
}

/// A line of a column: a grey word, and what it is about.
struct Line {
  std::string word, text;
  Ink ink = kBlack;
};

std::vector<Line> facts(const Preview& p) {
  std::vector<Line> lines;
  const vec3 size = p.bounds.empty() ? vec3(0.0f) : p.bounds.size();
  lines.push_back({"size", fmt::format("{:#.3g} × {:#.3g} × {:#.3g} m", size.x, size.y, size.z)});
  lines.push_back({"triangles", grouped(p.verdict.triangle_count)});
  lines.push_back({"vertices", grouped(p.vertices)});
  lines.push_back({"meshes", fmt::format("{} in {}", p.meshes, counted(p.nodes, "node"))});
  lines.push_back(
      {"images", p.images == 0 ? "none" : fmt::format("{}, {} decoded", p.images, megabytes(p.image_bytes))});
  if (p.cameras > 0) lines.push_back({"cameras", grouped(p.cameras)});
  if (p.lights > 0) lines.push_back({"lights", grouped(p.lights)});
  if (!p.variants.empty()) lines.push_back({"variants", joined(p.variants)});
  std::vector<std::string> moves;
  for (const io::AnimationInfo& a : p.animations) moves.push_back(a.name);
  if (!moves.empty()) lines.push_back({"animations", fmt::format("{}: {}", moves.size(), joined(moves))});
  return lines;
}

std::vector<Line> materials(const Preview& p) {
  std::vector<Line> lines{{counted(p.materials.size(), "material"), ""}};
  for (std::size_t i = 0; i < p.materials.size(); ++i) {
    const std::size_t left = p.materials.size() - i;
    if (lines.size() + 1 == kMostLines && left > 1) {
      lines.push_back({"", fmt::format("and {} more", left), kGrey});
      break;
    }
    lines.push_back({"", p.materials[i].empty() ? fmt::format("material {}", i) : p.materials[i]});
  }
  return lines;
}

std::string counts(const Verdict& v) {
  using check::Severity;
  return counted(v.count(Severity::error), "error") + ", " + counted(v.count(Severity::warning), "warning") + ", " +
         counted(v.count(Severity::note), "note");
}

std::string about(const NamedFinding& f) {
  std::string text;
  for (const std::string& part : {f.material, f.texture, f.finding.subject}) {
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  }
  return text.empty() ? text : text + ": ";
}

Ink ink_of(check::Severity severity) {
  return severity == check::Severity::error ? kRed : severity == check::Severity::warning ? kOrange : kBlack;
}

/// Findings, each code once in at most two lines: what repeats for many materials would hide the rest.
std::vector<Line> findings(const Verdict& v, int width) {
  constexpr std::size_t kLinesEach = 2;
  std::vector<Line> lines{{"check", v.findings.empty() ? "clean" : counts(v)}};
  std::map<std::string, std::size_t> alike;
  for (const NamedFinding& f : v.findings) ++alike[f.finding.code];
  std::set<std::string> told;
  for (const NamedFinding& f : v.findings) {
    const check::Finding& finding = f.finding;
    if (!told.insert(finding.code).second) continue;
    const std::size_t count = alike[finding.code];
    const std::string code = finding.code + (count > 1 ? fmt::format(" ({})", count) : "");
    std::vector<std::string> rows =
        wrapped(fmt::format("{} {}: {}{}", check::severity_name(finding.severity), code, about(f), finding.message),
                width, LetterSize::text);
    if (rows.size() > kLinesEach) {
      rows.resize(kLinesEach);
      rows.back() = fitted(rows.back() + " …", width, LetterSize::text);
    }
    const bool is_last = told.size() == alike.size();
    if (lines.size() + rows.size() + (is_last ? 0 : 1) > kMostLines) {
      lines.push_back({"", fmt::format("and {} more kinds: candela check", alike.size() - told.size() + 1), kGrey});
      break;
    }
    for (std::string& row : rows) lines.push_back({"", std::move(row), ink_of(finding.severity)});
  }
  return lines;
}

class Sheet {
 public:
  Sheet(int width, int height) {
    image.width = width;
    image.height = height;
    image.rgba.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4, kPaper);
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  }

  void paste(const DisplayImage& picture, ivec2 corner) {
    const auto row = static_cast<std::size_t>(picture.width) * 4;
    for (int y = 0; y < picture.height; ++y) {
      const auto at = static_cast<std::size_t>(corner.y + y) * static_cast<std::size_t>(image.width) +
                      static_cast<std::size_t>(corner.x);
      std::copy_n(picture.rgba.data() + static_cast<std::size_t>(y) * row, row, image.rgba.data() + at * 4);
    }
  }

  void column(const std::vector<Line>& lines, int x, int y, int width) {
    constexpr int kWord = 84;
    for (const Line& line : lines) {
      const int indent = line.word.empty() || line.text.empty() ? 0 : kWord;
      draw_text(image, x, y, fitted(line.word, width, LetterSize::text), kGrey);
      draw_text(image, x + indent, y, fitted(line.text, width - indent, LetterSize::text), line.ink);
      y += line_height(LetterSize::text);
    }
  }

  DisplayImage image;
};

}  // namespace

void lay_out_sheet(const std::vector<DisplayImage>& pictures, Preview& preview) {
  const int size = preview.view_size, count = static_cast<int>(pictures.size());
  const int width = std::max(kMargin + count * (size + kMargin), 960);
  const int views_at = kMargin + line_height(LetterSize::title) + kMargin / 2;
  const int text_at = views_at + size + line_height(LetterSize::text) + kMargin;
  // Three tenths for facts, two for materials, half for findings.
  const int tenth = (width - kMargin) / 10;
  const std::array<int, 3> widths{3 * tenth - kMargin, 2 * tenth - kMargin, 5 * tenth - kMargin};
  const std::array<std::vector<Line>, 3> columns{facts(preview), materials(preview),
                                                 findings(preview.verdict, widths[2])};
  std::size_t most = 0;
  for (const auto& lines : columns) most = std::max(most, lines.size());
  Sheet sheet(width, text_at + static_cast<int>(most) * line_height(LetterSize::text) + kMargin);
  const std::string name = std::filesystem::path(preview.verdict.file).filename().string();
  draw_text(sheet.image, kMargin, kMargin / 2, fitted(name, width - 2 * kMargin, LetterSize::title), kBlack,
            LetterSize::title);
  for (int i = 0; i < count; ++i) {
    PreviewView& view = preview.views[static_cast<std::size_t>(i)];
    view.corner = {kMargin + i * (size + kMargin), views_at};
    sheet.paste(pictures[static_cast<std::size_t>(i)], view.corner);
    draw_text(sheet.image, view.corner.x, views_at + size + 2, view.name, kGrey);
  }
  int x = kMargin;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    sheet.column(columns[i], x, text_at, widths[i]);
    x += widths[i] + kMargin;
  }
  preview.sheet = std::move(sheet.image);
}

}  // namespace candela
