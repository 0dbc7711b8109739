#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "cli/diff_report.h"
#include "cli/pair_page.h"
#include "figures/markup.h"

namespace candela::cli {

namespace {

using figures::escaped;

std::string pair_html(const Compared& c, const std::optional<float>& max_flip) {
  std::string html =
      fmt::format("<section{}><h2>{}</h2>\n<pre>{}</pre>\n", c.is_beyond(max_flip) ? " class=\"beyond\"" : "",
                  escaped(c.title()), escaped(finding_text(c)));
  if (c.difference) html += pair_pictures(*c.difference, "first", "second");
  return html + "</section>\n";
}

std::string summary_text(const std::vector<Compared>& all, const std::optional<float>& max_flip) {
  const auto beyond = std::count_if(all.begin(), all.end(), [&](const Compared& c) { return c.is_beyond(max_flip); });
  const std::string count = counted(all.size(), "pair");
  return max_flip ? fmt::format("{} of {} beyond a FLIP of {}", beyond, count, *max_flip) : count;
}

}  // namespace

std::string report_html(const std::string& first, const std::string& second, std::vector<Compared> all,
                        const std::optional<float>& max_flip) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Compared& a, const Compared& b) { return a.badness() > b.badness(); });
  std::string body = fmt::format("<p>{}</p>\n", summary_text(all, max_flip));
  for (const Compared& c : all) body += pair_html(c, max_flip);
  return pair_page("Difference", first + " and " + second, body);
}

}  // namespace candela::cli
