#include "interrupt.hpp"

#include <csignal>
#include <cstddef>

namespace frontlux::app {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM};

volatile std::sig_atomic_t note = 0;

extern "C" void take_note(int) { note = 1; }

}  // namespace

InterruptNote::InterruptNote() {
  note = 0;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    before_[i] = std::signal(kSignals[i], &take_note);
    // A program started in the background ignores SIGINT, and continues to.
    if (before_[i] == SIG_IGN) std::signal(kSignals[i], SIG_IGN);
  }
}

InterruptNote::~InterruptNote() {
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    if (before_[i] != SIG_ERR) std::signal(kSignals[i], before_[i]);
}

bool InterruptNote::taken() { return note != 0; }

}  // namespace frontlux::app
