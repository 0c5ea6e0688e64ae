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

// Only calls that a handler may make.
extern "C" void end_at_once(int) {
  remove_own_unfinished();
  constexpr std::string_view kMessage = "frontlux: stopped\n";
  static_cast<void>(!::write(STDERR_FILENO, kMessage.data(), kMessage.size()));
  ::_exit(kInterruptedCode);
}

// The second time nobody wants to wait any more.
extern "C" void take_note(int signal) {
  if (note != 0) end_at_once(signal);
  note = 1;
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

void Patience::check() {
  constexpr double kLongest = 2.0;  // [s]
  if (!InterruptNote::taken()) return;
  if (!since_) since_.emplace();
  if (since_->seconds() > kLongest) throw Interrupted();
}

}  // namespace frontlux::app
