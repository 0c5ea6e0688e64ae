#pragma once

#include <string>

namespace frontlux::app {

/// A line on standard error that replaces itself, if there is a terminal to see it; gone in the end.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  [[nodiscard]] bool visible() const { return visible_; }
  void show(const std::string& text) const;

 private:
  bool visible_;
};

}  // namespace frontlux::app
