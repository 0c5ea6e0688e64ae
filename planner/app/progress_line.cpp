#include "progress_line.hpp"

#include <iostream>
#include <unistd.h>

namespace frontlux::app {

ProgressLine::ProgressLine() : visible_(::isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  if (visible_) std::cerr << "\r\033[K" << std::flush;
}

void ProgressLine::show(const std::string& text) const {
  if (visible_) std::cerr << '\r' << text << "\033[K" << std::flush;
}

}  // namespace frontlux::app
