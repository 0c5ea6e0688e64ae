#pragma once

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
