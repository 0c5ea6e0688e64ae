#pragma once

#include <iostream>
#include <string>
#include <unistd.h>

namespace frontlux::app {

/// A line on standard error that replaces itself, if there is a terminal to see it; gone in the end.
class ProgressLine {
 public:
  ProgressLine() = default;
  ~ProgressLine() {
    if (visible_) std::cerr << "\r\033[K" << std::flush;
  }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  [[nodiscard]] bool visible() const { return visible_; }
  void show(const std::string& text) const {
    if (visible_) std::cerr << '\r' << text << "\033[K" << std::flush;
  }

 private:
  bool visible_ = ::isatty(STDERR_FILENO) != 0;
};

}  // namespace frontlux::app
