#pragma once

#include <optional>
#include <string>
#include <vector>

#include "candela/difference.h"

/// What `candela diff` says of what it has compared: to people, to programs, as a page.
namespace candela::cli {

/// Two pictures and what came of them.
struct Compared {
  std::string name;    ///< of the file
  PictureLabel label;  ///< of two scenes: which picture of them
  bool has_first = true, has_second = true;
  std::string fault;  ///< why they could not be compared
  std::optional<PictureDifference> difference;

  /// The file, and the picture of it.
  std::string title() const;
  bool is_beyond(const std::optional<float>& max_flip) const {
    return max_flip && (!difference || difference->flip > static_cast<double>(*max_flip));
  }
  /// For an order by how bad they are: what is missing is worse than any difference.
  double badness() const { return difference ? difference->flip : 2.0; }
};

/// Why there is no difference.
std::string absence_text(const Compared& compared);
std::string difference_text(const Compared& compared);
/// The same without its title.
std::string finding_text(const Compared& compared);
std::string report_json(const std::vector<Compared>& all, const std::optional<float>& max_flip);

/// All of it in one file, the worst pair at the top; first and second beside each other, one over the other with a
/// slider, or in turn.
std::string report_html(const std::string& first, const std::string& second, std::vector<Compared> all,
                        const std::optional<float>& max_flip);

}  // namespace candela::cli
