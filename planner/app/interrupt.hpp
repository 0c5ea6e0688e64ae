#pragma once

#include <array>
#include <exception>
#include <string>
#include <utility>

namespace frontlux::app {

/// The user stopped the work.
class Interrupted : public std::exception {
 public:
  explicit Interrupted(std::string what = "stopped; nothing was written") : what_(std::move(what)) {}
  [[nodiscard]] const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

inline constexpr int kInterruptedCode = 128 + 2;  ///< how the program exits when it is stopped

/// From now on Ctrl-C and SIGTERM end the program at once, with this code and a message, and without files
/// that are not whole.
void end_at_interrupts();

/// While it lives, Ctrl-C and SIGTERM are noted instead of ending the program; a second one, half a
/// second later or more, ends it at once. One at a time.
class InterruptNote {
 public:
  InterruptNote();
  ~InterruptNote();
  InterruptNote(const InterruptNote&) = delete;
  InterruptNote& operator=(const InterruptNote&) = delete;

  /// What a second one says from now on, as how to go on. Once at most.
  void advise(std::string advice);

  [[nodiscard]] static bool taken();

 private:
  using Action = void (*)(int);
  std::string advice_;
  std::array<Action, 2> before_;  // by `kSignals`
};

}  // namespace frontlux::app
