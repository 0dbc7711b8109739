#pragma once

#include <chrono>
#include <string>

#include "base/diagnostics.h"
#include "image/job.h"

namespace candela::cli {

/// What the user sees on standard error while work goes on: a live bar on a terminal, else a plain line every ten
/// seconds. Never fails: a standard error that cannot be written is no reason to lose a picture.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void phase(const std::string& text);  ///< replaced by whatever comes next
  void update(const Progress& progress);
  /// Shows how far a work is, which Ctrl-C stops while an Interrupt lives.
  Job job();
  void clear();                        ///< before something else is printed on the terminal
  void line(const std::string& text);  ///< stays on the screen
  void warn(const Diagnostic& warning);
  void failed(const Diagnostic& error);  ///< one of several works, told to the quiet, too

 private:
  void show(const std::string& text);
  bool is_time_for_a_line();

  bool quiet_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_line_ = std::chrono::steady_clock::now();
};

/// "850 ms", "2.3 s", "42 s", "4 min 05 s", "2 h 03 min".
std::string duration_text(double seconds);

}  // namespace candela::cli
