#pragma once

#include <string>

#include "base/diagnostics.h"
#include "path/render.h"

namespace candela::cli {

/// What the user sees on standard error while work goes on: a live bar on a terminal, else a plain line every ten
/// seconds. Never fails: a standard error that cannot be written is no reason to lose a picture.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void phase(const std::string& text);  ///< terminal only: replaced by whatever comes next
  void update(const path::Progress& progress);
  void line(const std::string& text);  ///< stays on the screen
  void warn(const Diagnostic& warning);
  bool is_live() const { return terminal_; }  ///< phase() is seen

 private:
  void show(const std::string& text);
  void clear();

  bool quiet_;
  bool terminal_;
  bool shown_ = false;
  double next_line_s_ = 0.0;
};

/// "850 ms", "2.3 s", "42 s", "4 min 05 s", "2 h 03 min".
std::string duration_text(double seconds);

}  // namespace candela::cli
