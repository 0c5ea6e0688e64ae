#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <unistd.h>

namespace frontlux::app {

/// A text with `?` in the place of bytes that terminals take for commands, for names from files that nobody
/// has looked at. Lines stay.
[[nodiscard]] std::string without_controls(std::string text);
/// The same, with `?` in the place of new lines, too: a name may hold one.
[[nodiscard]] std::string on_one_line(std::string text);

/// A text that a terminal shows in red; as it is if the stream is no terminal, or the environment has
/// NO_COLOR.
/// @param stream  STDOUT_FILENO or STDERR_FILENO
[[nodiscard]] std::string in_red(const std::string& text, int stream);

/// Writes a warning on standard error.
void warn(const std::string& text);

/// Whether a stream was not closed when the program began.
/// @param stream  STDOUT_FILENO or STDERR_FILENO
[[nodiscard]] bool is_open_to_write(int stream);

/// What is printed from now on goes nowhere, if standard output cannot be written to any more.
void give_up_broken_output();

/// A line on standard error that replaces itself, if there is a terminal to see it; gone in the end.
class ProgressLine {
 public:
  ProgressLine() = default;
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  [[nodiscard]] bool visible() const { return visible_; }
  /// What does not fit into the terminal's line is left out.
  void show(std::string_view text) const;
  void clear() const;

 private:
  bool visible_ = ::isatty(STDERR_FILENO) != 0;
};

/// Says what is being worked on, and for how long already, from its third second on: of work that cannot tell
/// how far it is. In a progress line; as long as it lives, nothing else is to be printed.
class WorkingLine {
 public:
  /// @param what  as "looking for what can be observed"
  explicit WorkingLine(std::string what);
  ~WorkingLine();
  WorkingLine(const WorkingLine&) = delete;
  WorkingLine& operator=(const WorkingLine&) = delete;

 private:
  void tell();

  std::string what_;
  ProgressLine line_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace frontlux::app
