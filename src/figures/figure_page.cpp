#include "figures/figure_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "figures/markup.h"
#include "figures/symbols.h"

namespace candela::figures {

namespace {

constexpr std::string_view kStyle = R"css(
:root { --ink: #1d1d1f; --soft: #5f6368; --paper: #fff; --card: #f6f6f4; --rule: #deded9; --link: #005a9c; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e4e2; --soft: #a3a3a0; --paper: #161618; --card: #1f1f22; --rule: #38383c; --link: #7db9ec; }
}
* { box-sizing: border-box; }
html { color-scheme: light dark; scroll-padding-top: 1rem; }
body { margin: 0 auto; padding: 2rem 1.2rem 5rem; max-width: 74rem; color: var(--ink); background: var(--paper);
  font: 1.05rem/1.6 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; overflow-wrap: break-word; }
a { color: var(--link); text-decoration-thickness: 1px; text-underline-offset: .15em; }
h1 { font-size: clamp(1.7rem, 5vw, 2.6rem); line-height: 1.15; margin: 0 0 .6rem; letter-spacing: -.01em; }
h2 { font-size: 1.55rem; margin: 4.5rem 0 0; padding-top: .8rem; border-top: 3px solid var(--ink); }
h2 .up { font-size: .9rem; font-weight: 400; float: right; margin-top: .5em; }
h3 { font-size: 1.2rem; margin: 0 0 .4rem; }
h3 a { color: inherit; text-decoration: none; }
h3 span { color: var(--soft); font-weight: 400; margin-right: .5em; }
p { margin: 0 0 .8rem; max-width: 46rem; }
.soft { color: var(--soft); font-size: .92rem; }
nav ol { list-style: none; padding: 0; margin: 1.6rem 0 0; display: grid; gap: 1.1rem 2rem;
  grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); }
nav ol ul { list-style: none; margin: .2rem 0 0; padding: 0; font-size: .94rem; line-height: 1.5; }
nav b a { color: inherit; }
figure.entry { margin: 2.6rem 0 0; }
.formulas { background: var(--card); border-radius: 6px; padding: .55rem 1rem; margin: .2rem 0 1rem; overflow-x: auto; }
.formulas div { display: flex; flex-wrap: wrap; gap: 0 2.4rem; }
.formulas math { width: auto; font-family: "Latin Modern Math", "STIX Two Math", "Cambria Math", math, serif; font-size: 1.15rem; margin: .5rem auto; }
.symbols { margin: -.6rem 0 1rem; max-width: none; }
.symbols math { display: inline math; }
.panels { display: grid; gap: 1.2rem 1.6rem; grid-template-columns: 1fr; margin: .6rem 0 .8rem; align-items: start; }
@media (min-width: 46rem) { .two, .three { grid-template-columns: 1fr 1fr; } }
@media (min-width: 66rem) { .three { grid-template-columns: 1fr 1fr 1fr; } }
.panel { min-width: 0; }
.panel.wide { grid-column: 1 / -1; }
.panel img { display: block; width: 100%; height: auto; }
.panel img.plot { max-width: 42rem; }
.panel img.photo { border-radius: 3px; }
.panel p { margin: .35rem 0 0; font-size: .92rem; line-height: 1.4; color: var(--soft); }
.panel p b { color: var(--ink); font-variant-numeric: tabular-nums; }
.row { display: grid; grid-template-columns: repeat(auto-fit, minmax(max(5.2rem, 100% / (var(--n) + .5)), 1fr)); gap: 0 0; }
.row div { min-width: 0; max-width: 12rem; text-align: center; font-size: .88rem; color: var(--soft); font-variant-numeric: tabular-nums; }
.row img { width: 100%; aspect-ratio: 1; object-fit: cover; }
.scale { display: flex; font-size: clamp(.5rem, 1.55vw, .88rem); color: var(--soft); font-variant-numeric: tabular-nums;
  padding-top: .2rem; }
.scale span { flex: 1 1 0; text-align: center; min-width: 0; white-space: nowrap; }
.table { overflow-x: auto; margin: .4rem 0 1rem; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem 1.1rem .25rem 0; text-align: right; border-bottom: 1px solid var(--rule); }
th { font-weight: 600; color: var(--soft); vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; }
table.words th, table.words td { text-align: left; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .25rem 1.1rem; margin: 0; font-size: .9rem; color: var(--soft); }
dt { font-weight: 600; } dd { margin: 0; min-width: 0; }
@media (max-width: 34rem) { dl { grid-template-columns: 1fr; gap: 0; } dd { margin-bottom: .5rem; } }
code { font: .88em/1.5 ui-monospace, "SF Mono", Menlo, "DejaVu Sans Mono", monospace; background: var(--card);
  border-radius: 4px; padding: .1em .35em; overflow-wrap: anywhere; }
.warning { border-left: 3px solid #d55e00; padding-left: .7rem; }
.gallery { display: grid; gap: 1.2rem 1.6rem; grid-template-columns: repeat(auto-fill, minmax(min(22rem, 100%), 1fr)); margin-top: 1.4rem; }
.gallery a { color: inherit; text-decoration: none; display: block; }
.gallery img { display: block; width: 100%; height: auto; border-radius: 3px; }
.gallery a:hover span { text-decoration: underline; }
.note { margin-top: 2.5rem; }
.turn { display: flex; justify-content: space-between; gap: 1rem; margin: 0 0 2rem; font-size: .95rem; }
)css";

std::string head(const std::string& title) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n",
      escaped(title), kStyle);
}

const char* const kFoot = "</body>\n</html>\n";

/// Width and height, so that the page does not jump while it loads.
std::string image_element(const Panel& panel) {
  std::string size = " class=\"plot\"";
  if (const auto* image = std::get_if<DisplayImage>(&panel.content)) {
    size = fmt::format(" class=\"photo\" width=\"{}\" height=\"{}\"", image->width, image->height);
  }
  return fmt::format("<img src=\"{}\" alt=\"{}\"{} loading=\"lazy\">", escaped(panel.file), escaped(panel.caption),
                     size);
}

/// Whether a picture is squares beside each other, each with a text of its own.
bool is_row(const Panel& panel) {
  const auto* image = std::get_if<DisplayImage>(&panel.content);
  return image != nullptr && panel.scale.size() > 1 &&
         image->width == image->height * static_cast<int>(panel.scale.size());
}

/// A row whose squares stand below each other where there is no room: each is the picture with the others cut off.
std::string row_html(const Panel& panel) {
  const std::size_t count = panel.scale.size();
  std::string html = fmt::format("<div class=\"row\" style=\"--n: {}\">", count);
  for (std::size_t i = 0; i < count; ++i) {
    html +=
        fmt::format("<div><img src=\"{}\" alt=\"{}\" style=\"object-position: {:.5g}% 0\" loading=\"lazy\">{}</div>",
                    escaped(panel.file), i == 0 ? escaped(panel.caption) : "",
                    100.0 * static_cast<double>(i) / static_cast<double>(count - 1), escaped(panel.scale[i]));
  }
  return html + "</div>\n";
}

std::string panel_html(const Panel& panel) {
  std::string html = fmt::format("<div class=\"panel{}\">\n", panel.is_wide ? " wide" : "");
  html += is_row(panel) ? row_html(panel) : image_element(panel) + "\n";
  if (!panel.scale.empty() && !is_row(panel)) {
    html += "<div class=\"scale\">";
    for (const std::string& label : panel.scale) html += "<span>" + escaped(label) + "</span>";
    html += "</div>\n";
  }
  html += "<p>" + escaped(panel.caption);
  if (!panel.error.empty()) html += fmt::format("{}<b>{}</b>", panel.caption.empty() ? "" : ": ", escaped(panel.error));
  return html + "</p>\n</div>\n";
}

std::string table_html(const Table& table) {
  if (table.head.empty()) return {};
  // Words stand to the left, numbers to the right.
  const bool is_words = table.head.size() == 2;
  std::string html = fmt::format("<div class=\"table\"><table{}>\n<tr>", is_words ? " class=\"words\"" : "");
  for (const std::string& cell : table.head) html += "<th>" + escaped(cell) + "</th>";
  html += "</tr>\n";
  for (const std::vector<std::string>& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row) html += "<td>" + escaped(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string list_html(const char* what, const std::vector<std::string>& items, bool is_code,
                      const char* separator = "<br>\n") {
  if (items.empty()) return {};
  std::string html = fmt::format("<dt>{}</dt><dd>", what);
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) html += separator;
    html += is_code ? "<code>" + escaped(items[i]) + "</code>" : escaped(items[i]);
  }
  return html + "</dd>\n";
}

/// Formulas between semicolons, beside each other where there is room.
std::string formula_line(const std::string& formulas) {
  std::string html = "<div>\n";
  for (std::size_t begin = 0; begin <= formulas.size();) {
    const std::size_t end = std::min(formulas.find(';', begin), formulas.size());
    html += mathml(std::string_view(formulas).substr(begin, end - begin)) + "\n";
    begin = end + 1;
  }
  return html + "</div>\n";
}

/// What the letters of these formulas stand for.
std::string symbols_html(const std::vector<std::string>& formulas) {
  std::string html;
  for (const Symbol& symbol : symbols_in(formulas)) {
    html += (html.empty() ? "" : " · ") + mathml(symbol.formula) + " " + escaped(symbol.words);
  }
  return html.empty() ? "" : "<p class=\"soft symbols\">" + html + "</p>\n";
}

/// Text, formulas, panels, table, and where they come from.
std::string content_html(const PageFigure& page) {
  const Figure& figure = page.figure;
  std::string html;
  for (const std::string& paragraph : figure.text) html += "<p>" + escaped(paragraph) + "</p>\n";
  if (!figure.formulas.empty()) {
    html += "<div class=\"formulas\">\n";
    for (const std::string& formula : figure.formulas) html += formula_line(formula);
    html += "</div>\n" + symbols_html(figure.formulas);
  }
  const char* const columns = figure.columns == 3 ? " three" : figure.columns == 2 ? " two" : "";
  html += fmt::format("<div class=\"panels{}\">\n", columns);
  for (const Panel& panel : figure.panels) html += panel_html(panel);
  html += "</div>\n" + table_html(figure.table);
  for (const std::string& what : figure.left_out) {
    html += fmt::format("<p class=\"soft warning\">Left out: {}.</p>\n", escaped(what));
  }
  std::vector<std::string> commands = figure.commands;
  commands.push_back(fmt::format("candela figures -o DIR --only {}", page.info.name));
  return html + "<dl>\n" + list_html("After", figure.sources, false) + list_html("Code", figure.functions, true, " ") +
         list_html("Command", commands, true) + "</dl>\n";
}

std::string chapter_id(Chapter chapter) { return fmt::format("chapter-{}", static_cast<int>(chapter) + 1); }

std::string contents_html(const std::vector<PageFigure>& figures) {
  std::string html = "<nav id=\"contents\" aria-label=\"Contents\">\n<ol>\n";
  const PageFigure* last = nullptr;
  for (const PageFigure& page : figures) {
    const Chapter chapter = page.info.chapter;
    const bool is_new = last == nullptr || last->info.chapter != chapter;
    if (is_new) {
      if (last != nullptr) html += "</ul></li>\n";
      html += fmt::format("<li><b><a href=\"#{}\">{}</a></b><ul>\n", chapter_id(chapter), chapter_title(chapter));
      if (chapter == Chapter::parameters) html += "<li class=\"soft\">one page for each, with a row of balls</li>\n";
    }
    if (chapter != Chapter::parameters) {
      html += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", page.info.name, escaped(page.info.title));
    }
    last = &page;
  }
  return html + (last != nullptr ? "</ul></li>\n" : "") + "</ol>\n</nav>\n";
}

}  // namespace

std::string parameter_page(const std::string& figure_name) { return "parameter-" + figure_name + ".html"; }

std::string index_html(const std::vector<PageFigure>& figures, const std::string& note) {
  std::string html = head("Figures of physically based shading");
  html += fmt::format(
      "<header>\n<h1>Figures of physically based shading</h1>\n<p>Each curve and picture here was computed by running "
      "code: the curves by the functions that also shade the pictures, the pictures by Candela’s path tracer and its "
      "OpenGL renderer. Under each stands where it comes from and the command that makes it again.</p>\n"
      "<p class=\"soft\">{}</p>\n</header>\n",
      escaped(note));
  html += contents_html(figures);
  const PageFigure* last = nullptr;
  for (const PageFigure& page : figures) {
    const Chapter chapter = page.info.chapter;
    if (last == nullptr || last->info.chapter != chapter) {
      if (last != nullptr) html += "</section>\n";
      html += fmt::format("<section>\n<h2 id=\"{}\">{}. {} <a class=\"up\" href=\"#contents\">↑ contents</a></h2>\n",
                          chapter_id(chapter), static_cast<int>(chapter) + 1, chapter_title(chapter));
      if (chapter == Chapter::parameters) html += "<div class=\"gallery\">\n";
    }
    if (chapter == Chapter::parameters) {
      html += fmt::format("<a id=\"{}\" href=\"{}\">{}<span>{}</span></a>\n", page.info.name,
                          parameter_page(page.info.name), image_element(page.figure.panels.front()),
                          escaped(page.info.title));
    } else {
      html += fmt::format(
          "<figure class=\"entry\" id=\"{0}\">\n<h3><a href=\"#{0}\"><span>{1}.{2}</span>{3}</a></h3>\n{4}</figure>\n",
          page.info.name, static_cast<int>(chapter) + 1, page.number, escaped(page.info.title), content_html(page));
    }
    last = &page;
  }
  if (last != nullptr) html += last->info.chapter == Chapter::parameters ? "</div>\n</section>\n" : "</section>\n";
  return html + kFoot;
}

std::string parameter_html(const PageFigure& figure, const PageFigure* before, const PageFigure* after,
                           const std::string& note) {
  const auto link = [](const PageFigure* page, const char* pattern) {
    if (page == nullptr) return std::string("<span></span>");
    return fmt::format("<a href=\"{}\">{}</a>", parameter_page(page->info.name),
                       fmt::format(fmt::runtime(pattern), escaped(page->info.title)));
  };
  return head(figure.info.title + " – parameters") + "<nav class=\"turn\">" + link(before, "← {}") +
         "<a href=\"index.html\">All figures</a>" + link(after, "{} →") + "</nav>\n<main>\n<h1>" +
         escaped(figure.info.title) + "</h1>\n" + content_html(figure) + "</main>\n<p class=\"soft note\">" +
         escaped(note) + "</p>\n" + kFoot;
}

}  // namespace candela::figures
