#pragma once

#include <string>
#include <vector>

namespace frontlux::fuzz {

/// A format of files that others write, and that we read.
struct Format {
  const char* name;  ///< "pcd"
  /// Reads these bytes as a file. What is wrong with them may only be told by a std::runtime_error, which
  /// this catches.
  /// @return whether they are such a file
  bool (*read)(const std::string& bytes);
  std::vector<std::string> (*seeds)();  ///< small files of this format that can be read
  bool in_process = true;               ///< else a library reads it, in a child process
};

[[nodiscard]] const std::vector<Format>& formats();

}  // namespace frontlux::fuzz
