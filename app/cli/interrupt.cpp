#include "cli/interrupt.h"

#include <array>
#include <csignal>

namespace candela::cli {

namespace {

constexpr std::array kSignals{SIGINT, SIGTERM};

// A signal handler can reach nothing but a global.
std::atomic<bool> g_requested{false};
int g_alive = 0;  // of the main thread alone
static_assert(std::atomic<bool>::is_always_lock_free);

void on_signal(int signal) {
  if (g_requested.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

Interrupt::Interrupt() {
  if (g_alive++ > 0) return;
  for (const int signal : kSignals) {
    // A parent that ignores the signal (nohup, a background job) keeps its wish.
    if (std::signal(signal, on_signal) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

Interrupt::~Interrupt() {
  if (--g_alive > 0) return;
  for (const int signal : kSignals) {
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

const std::atomic<bool>& Interrupt::requested() { return g_requested; }

}  // namespace candela::cli
