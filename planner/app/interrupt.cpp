#include "interrupt.hpp"

#include <frontlux/file.hpp>

#include <csignal>
#include <cstddef>
#include <string_view>
#include <unistd.h>

namespace frontlux::app {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM};

volatile std::sig_atomic_t note = 0;

extern "C" void take_note(int) { note = 1; }

// Only calls that a handler may make.
extern "C" void end_at_once(int) {
  remove_own_unfinished();
  constexpr std::string_view kMessage = "frontlux: stopped\n";
  static_cast<void>(!::write(STDERR_FILENO, kMessage.data(), kMessage.size()));
  ::_exit(kInterruptedCode);
}

// A program started in the background ignores SIGINT, and continues to.
// @return what was done before
auto handle(int signal, void (*action)(int)) {
  const auto before = std::signal(signal, action);
  if (before == SIG_IGN) std::signal(signal, SIG_IGN);
  return before;
}

}  // namespace

void end_at_interrupts() {
  for (const int signal : kSignals) handle(signal, &end_at_once);
}

InterruptNote::InterruptNote() {
  note = 0;
  for (std::size_t i = 0; i < kSignals.size(); ++i) before_[i] = handle(kSignals[i], &take_note);
}

InterruptNote::~InterruptNote() {
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    if (before_[i] != SIG_ERR) std::signal(kSignals[i], before_[i]);
}

bool InterruptNote::taken() { return note != 0; }

}  // namespace frontlux::app
