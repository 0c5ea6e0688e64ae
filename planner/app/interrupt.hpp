#pragma once

#include <exception>

namespace frontlux::app {

/// The user stopped the work.
class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "stopped; nothing is written"; }
};

/// While it lives, Ctrl-C is noted instead of ending the program. One at a time.
class InterruptNote {
 public:
  InterruptNote();
  ~InterruptNote();
  InterruptNote(const InterruptNote&) = delete;
  InterruptNote& operator=(const InterruptNote&) = delete;

  [[nodiscard]] static bool taken();

 private:
  void (*before_)(int);
};

}  // namespace frontlux::app
