#pragma once

#include <stdexcept>
#include <string>

namespace frontlux::app {

/// The user stopped the work.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(const std::string& what = "stopped; nothing is written") : std::runtime_error(what) {}
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
