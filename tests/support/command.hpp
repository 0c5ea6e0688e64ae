#pragma once

#include "support/folder_test.hpp"

#include <sys/wait.h>

#include <csignal>
#include <cstdio>
#include <unistd.h>

namespace frontlux::test {

/// How a run of the command `frontlux` ended and what it printed.
struct Answer {
  int code = -1;  ///< exit code; -1 if a signal ended it
  std::string out, err;
};

/// A word as a POSIX shell takes it, whatever it holds.
inline std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out += "'";
}

inline int exit_code(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : -1; }

/// Runs `frontlux` with these words.
/// @param folder  for two files, `out` and `err`, with what it prints
/// @param before  shell commands that come first, as "ulimit -f 8;"
inline Answer run_frontlux(const std::vector<std::string>& words, const std::filesystem::path& folder,
                           const std::string& before = "") {
  std::string command = before + " " + quoted(FRONTLUX_COMMAND);
  for (const std::string& word : words) command.append(" ").append(quoted(word));
  const std::filesystem::path out = folder / "out", err = folder / "err";
  const int status =
      std::system((command + " >" + quoted(out.string()) + " 2>" + quoted(err.string())).c_str());
  return {exit_code(status), content_of(out), content_of(err)};
}

enum User : bool { kSelf, kNobody };  ///< who runs a program: root runs it as nobody
inline constexpr int kCannotBe = 77;  ///< its exit code if that is not possible

/// Starts a program, whose name is the first word, and does not wait for it. It prints into the same files.
inline pid_t start(std::vector<std::string> words, const std::filesystem::path& folder, User user = kSelf) {
  const pid_t child = fork();
  if (child != 0) return child;
  std::signal(SIGINT, SIG_DFL);
  static_cast<void>(std::freopen((folder / "out").c_str(), "w", stdout));
  static_cast<void>(std::freopen((folder / "err").c_str(), "w", stderr));
  if (user == kNobody && geteuid() == 0 && setuid(65534) != 0) _exit(kCannotBe);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

/// Waits until it has ended. @return its status
inline int status_of(pid_t child) {
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return status;
}

}  // namespace frontlux::test
