#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "cli/interrupt.h"
#include "cli/values.h"

namespace candela::cli {

namespace {

constexpr double kLineSeconds = 10.0;

bool stderr_is_terminal() {
  const char* term = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && term != nullptr && std::string_view(term) != "dumb";
}

int terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

void put(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

std::string progress_text(const Progress& p) {
  std::string text = fmt::format("{:3.0f} %  {}", 100.0 * std::clamp(p.fraction, 0.0, 1.0), p.what);
  if (p.remaining_s) text += "  " + duration_text(*p.remaining_s) + " left";
  return text;
}

}  // namespace

ProgressLine::ProgressLine(bool quiet) : quiet_(quiet), terminal_(stderr_is_terminal()) {}

ProgressLine::~ProgressLine() { clear(); }

bool ProgressLine::is_time_for_a_line() {
  const auto now = std::chrono::steady_clock::now();
  if (std::chrono::duration<double>(now - last_line_).count() < kLineSeconds) return false;
  last_line_ = now;
  return true;
}

void ProgressLine::phase(const std::string& text) {
  if (quiet_) return;
  if (terminal_) return show(text);
  if (is_time_for_a_line()) put(one_line(text) + "\n");
}

Job ProgressLine::job() {
  return {.progress = [this](const Progress& p) { update(p); }, .stop = &Interrupt::requested()};
}

void ProgressLine::update(const Progress& progress) {
  const std::string text = progress_text(progress);
  if (quiet_) return;
  if (!terminal_) return phase(text);
  constexpr int kWidest = 40;
  const int width = std::min(kWidest, terminal_columns() - static_cast<int>(text.size()) - 4);
  if (width < 4) return show(text);
  const auto full = static_cast<std::size_t>(std::lround(std::clamp(progress.fraction, 0.0, 1.0) * width));
  show(fmt::format("[{:#<{}}{:.<{}}] {}", "", full, "", static_cast<std::size_t>(width) - full, text));
}

void ProgressLine::line(const std::string& text) {
  if (quiet_) return;
  clear();
  put(one_line(text) + "\n");
}

void ProgressLine::warn(const Diagnostic& warning) { line("warning: " + warning.text()); }

void ProgressLine::failed(const Diagnostic& error) {
  clear();
  put("failed: " + one_line(error.text()) + "\n");
}

void ProgressLine::show(const std::string& text) {
  const auto columns = static_cast<std::size_t>(std::max(1, terminal_columns() - 1));
  put("\r" + one_line(text).substr(0, columns) + "\x1b[K");
  shown_ = true;
}

void ProgressLine::clear() {
  if (shown_) put("\r\x1b[K");
  shown_ = false;
}

std::string duration_text(double seconds) {
  if (seconds < 0.9995) return fmt::format("{:.0f} ms", seconds * 1e3);
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  if (seconds < 99.5) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<long long>(std::llround(std::min(seconds, 1e9)));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace candela::cli
