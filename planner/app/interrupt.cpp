#include "interrupt.hpp"

#include <csignal>

namespace frontlux::app {
namespace {

volatile std::sig_atomic_t note = 0;

extern "C" void take_note(int) { note = 1; }

}  // namespace

InterruptNote::InterruptNote() {
  note = 0;
  before_ = std::signal(SIGINT, &take_note);
  // A program started in the background ignores SIGINT, and continues to.
  if (before_ == SIG_IGN) std::signal(SIGINT, SIG_IGN);
}

InterruptNote::~InterruptNote() {
  if (before_ != SIG_ERR) std::signal(SIGINT, before_);
}

bool InterruptNote::taken() { return note != 0; }

}  // namespace frontlux::app
