#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace frontlux::test {

/// How a run of the command `frontlux` ended and what it printed.
struct Answer {
  int code = -1;  ///< exit code; -1 if a signal ended it
  std::string out, err;
};

/// Empty if there is no such file.
inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A word as a POSIX shell takes it, whatever it holds.
inline std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out += "'";
}

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
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(out), content_of(err)};
}

}  // namespace frontlux::test
