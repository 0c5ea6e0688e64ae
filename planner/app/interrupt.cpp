#include "interrupt.hpp"

#include <frontlux/file.hpp>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <string_view>
#include <unistd.h>
#include <utility>

namespace frontlux::app {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM};

constexpr std::int64_t kNone = -1;
std::atomic<std::int64_t> noted_at = kNone;  // [ns]
std::atomic<const char*> noted_advice = "";
std::atomic<const char*> line_clearing = "";  // of a terminal, for a line of progress
static_assert(std::atomic<std::int64_t>::is_always_lock_free &&
              std::atomic<const char*>::is_always_lock_free);

// Only calls that a handler may make.
extern "C" void end_at_once(int) {
  remove_own_unfinished();
  for (const std::string_view part : {line_clearing.load(), "frontlux: stopped", noted_advice.load(), "\n"})
    static_cast<void>(!::write(STDERR_FILENO, part.data(), part.size()));
  ::_exit(kInterruptedCode);
}

// Who asks again wants to wait no more. What comes with the first one is that one: `timeout` sends its signal
// to the program and to its group.
extern "C" void take_note(int signal) {
  constexpr std::int64_t kSecond = 1'000'000'000, kAgain = kSecond / 2;
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  const std::int64_t now = kSecond * time.tv_sec + time.tv_nsec;
  std::int64_t before = kNone;
  if (!noted_at.compare_exchange_strong(before, now) && now - before > kAgain) end_at_once(signal);
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
  if (::isatty(STDERR_FILENO) != 0) line_clearing = "\r\033[K";
  for (const int signal : kSignals) handle(signal, &end_at_once);
}

InterruptNote::InterruptNote() {
  noted_at = kNone;
  for (std::size_t i = 0; i < kSignals.size(); ++i) before_[i] = handle(kSignals[i], &take_note);
}

InterruptNote::~InterruptNote() {
  noted_advice = "";
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    if (before_[i] != SIG_ERR) std::signal(kSignals[i], before_[i]);
}

void InterruptNote::advise(std::string advice) {
  advice_ = std::move(advice);
  noted_advice = advice_.c_str();
}

bool InterruptNote::taken() { return noted_at != kNone; }

}  // namespace frontlux::app
