#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace candela::cli {

/// Each verb adds its sub-command to `app` and returns what to do when the user names it.
using Verb = std::function<void()>;
Verb add_render(CLI::App& app);
Verb add_info(CLI::App& app);
Verb add_furnace(CLI::App& app);
Verb add_bake(CLI::App& app);
Verb add_check(CLI::App& app);
Verb add_view(CLI::App& app);
Verb add_figures(CLI::App& app);

/// Writes `text` to standard output; throws Error where that fails (a full disk behind a redirection).
void print(const std::string& text);

}  // namespace candela::cli
