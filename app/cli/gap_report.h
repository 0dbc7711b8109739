#pragma once

#include <optional>
#include <string>
#include <vector>

#include "candela/gap.h"

/// What `candela compare` says: to people, to programs, as a page.
namespace candela::cli {

/// What distinguishes a view, or "the view".
std::string title_of(const ViewGap& gap);
std::string gap_text(const ViewGap& gap);
std::string gap_json(const std::string& scene, const GapSettings& settings, const std::vector<ViewGap>& gaps,
                     const std::optional<float>& max_flip);
/// A view's part of the page.
std::string gap_section(const ViewGap& gap, const std::optional<float>& max_flip);
/// All of it in one file. `against`: the picture of another program, or empty.
std::string gap_page(const std::string& scene, const std::string& against, const GapSettings& settings,
                     const std::vector<std::string>& sections);

}  // namespace candela::cli
