#include "terminal.hpp"

#include <sys/ioctl.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <fcntl.h>
#include <iostream>
#include <system_error>
#include <utility>

namespace frontlux::app {
namespace {

std::size_t columns() {
  constexpr std::size_t kUnknown = 80;
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUnknown;
}

}  // namespace

std::string without_controls(std::string text) {
  const auto commands = [](char c) { return (c >= 0 && c < ' ' && c != '\n') || c == 0x7F; };
  std::ranges::replace_if(text, commands, '?');
  return text;
}

std::string on_one_line(std::string text) {
  std::ranges::replace(text, '\n', '?');
  return without_controls(std::move(text));
}

std::string in_red(const std::string& text, int stream) {
  const char* const no_color = std::getenv("NO_COLOR");
  if (::isatty(stream) == 0 || (no_color != nullptr && *no_color != '\0')) return text;
  return "\033[31m" + text + "\033[0m";
}

void warn(const std::string& text) {
  std::cerr << in_red("frontlux: warning: " + on_one_line(text), STDERR_FILENO) << '\n';
}

bool is_open_to_write(int stream) {
  const int flags = ::fcntl(stream, F_GETFL);
  return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
}

void give_up_broken_output() {
  if (std::cout.flush()) return;
  const int nowhere = ::open("/dev/null", O_WRONLY);
  if (nowhere < 0) return;
  ::dup2(nowhere, STDOUT_FILENO);
  ::close(nowhere);
  std::cout.clear();
}

void ProgressLine::show(std::string_view text) const {
  if (visible_) std::cerr << '\r' << text.substr(0, columns() - 1) << "\033[K" << std::flush;
}

void ProgressLine::clear() const {
  if (visible_) std::cerr << "\r\033[K" << std::flush;
}

WorkingLine::WorkingLine(std::string what) : what_(without_controls(std::move(what))) {
  std::ranges::replace(what_, '\n', '?');
  if (!line_.visible()) return;
  try {
    thread_ = std::thread([this] { tell(); });
  } catch (const std::system_error&) {
    // Without a thread the work goes on, and nothing is told of it.
  }
}

WorkingLine::~WorkingLine() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void WorkingLine::tell() {
  constexpr int kFirst = 3;  // [s]
  std::unique_lock lock(mutex_);
  for (int seconds = 1; !changed_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; });
       ++seconds)
    if (seconds >= kFirst) line_.show(what_ + ", for " + std::to_string(seconds) + " s");
}

}  // namespace frontlux::app
