#include "figures/figure_book.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/file.h"
#include "figures/figure_page.h"

namespace candela::figures {

namespace {

void write_panel(const std::filesystem::path& folder, const Panel& panel) {
  if (const auto* image = std::get_if<DisplayImage>(&panel.content)) return write_png(folder / panel.file, *image);
  write_file(folder / panel.file, std::get<std::string>(panel.content));
}

/// Pages need the sizes of pictures, not their pixels.
void forget_pixels(Figure& figure) {
  for (Panel& panel : figure.panels) {
    if (auto* image = std::get_if<DisplayImage>(&panel.content)) image->rgba = {};
  }
}

/// Whichever others are made.
int number_in_chapter(const std::vector<FigureInfo>& all, const FigureInfo& figure) {
  int number = 1;
  for (const FigureInfo& info : all) {
    if (info.name == figure.name) break;
    number += info.chapter == figure.chapter ? 1 : 0;
  }
  return number;
}

std::size_t write_parameter_pages(const std::filesystem::path& folder, const std::vector<PageFigure>& made,
                                  const std::string& note) {
  std::vector<const PageFigure*> pages;
  for (const PageFigure& page : made) {
    if (page.info.chapter == Chapter::parameters) pages.push_back(&page);
  }
  for (std::size_t i = 0; i < pages.size(); ++i) {
    write_file(
        folder / parameter_page(pages[i]->info.name),
        parameter_html(*pages[i], i > 0 ? pages[i - 1] : nullptr, i + 1 < pages.size() ? pages[i + 1] : nullptr, note));
  }
  return pages.size();
}

}  // namespace

std::vector<FigureInfo> choose_figures(const std::vector<std::string>& names) {
  std::vector<FigureInfo> all = figures();
  const auto unknown = std::find_if_not(names.begin(), names.end(), [&all](const std::string& name) {
    return std::any_of(all.begin(), all.end(), [&name](const FigureInfo& info) { return info.name == name; });
  });
  if (unknown != names.end()) {
    std::string known;
    for (const FigureInfo& info : all) known.append(known.empty() ? "" : ", ").append(info.name);
    throw Error("no figure \"" + *unknown + "\"; there are " + known);
  }
  if (names.empty()) return all;
  std::vector<FigureInfo> chosen;
  std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
               [&](const FigureInfo& info) { return std::find(names.begin(), names.end(), info.name) != names.end(); });
  return chosen;
}

BookResult write_figures(const std::filesystem::path& folder, const std::vector<FigureInfo>& chosen,
                         const FigureSettings& settings, const std::string& note, const Job& job) {
  BookResult result;
  // Progress is of figures, not of the pictures in them.
  FigureContext context(settings, {.stop = job.stop, .diagnostics = job.diagnostics});
  const Stopwatch watch;
  std::vector<PageFigure> made;
  const std::vector<FigureInfo> all = figures();
  for (std::size_t i = 0; i < chosen.size() && !result.stopped; ++i) {
    job.report({.fraction = static_cast<double>(i) / static_cast<double>(chosen.size()),
                .seconds = watch.seconds(),
                .what = fmt::format("figure {} of {}: {}", i + 1, chosen.size(), chosen[i].name)});
    try {
      context.check_stop();
      PageFigure page{chosen[i], chosen[i].make(context), 1};
      for (const Panel& panel : page.figure.panels) write_panel(folder, panel);
      result.files += page.figure.panels.size();
      forget_pixels(page.figure);
      page.number = number_in_chapter(all, page.info);
      made.push_back(std::move(page));
    } catch (const Interrupted&) {
      result.stopped = true;
    }
  }
  result.figures = made.size();
  result.files += write_parameter_pages(folder, made, note) + 1;
  write_file(folder / "index.html", index_html(made, note));
  return result;
}

}  // namespace candela::figures
