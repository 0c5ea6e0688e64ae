#include "commands/output_file.hpp"

#include "bad_input.hpp"

#include <algorithm>
#include <climits>
#include <cstddef>
#include <system_error>
#include <unistd.h>

namespace frontlux::app {
namespace {

namespace fs = std::filesystem;

// Until a file is whole: .part-frontlux-, the number of the process and that of the file.
constexpr std::size_t kUnfinishedEnding = 32;

}  // namespace

void check_writable(const std::string& option, const fs::path& file) {
  const auto refuse = [&](const std::string& why) {
    throw BadInput(option + ": " + file.string() + " " + why);
  };
  std::error_code error;
  const auto there = fs::status(file, error);
  if (fs::is_directory(there)) refuse("is a folder; name a file in it, or move it away");
  if (fs::exists(there) && !fs::is_regular_file(there)) refuse("is not a regular file; name a file");
  const auto folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
    refuse("cannot be written: there is no folder " + folder.string() + "; create it first");
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse("cannot be written: the folder " + folder.string() + " is read-only; check its permissions");
  if (fs::exists(there) && ::access(file.c_str(), W_OK) != 0)
    refuse("is read-only; make it writable, or name another file");
  if (file.filename().native().size() > NAME_MAX - kUnfinishedEnding)
    refuse("cannot be written: its name is too long; give one of at most " +
           std::to_string(NAME_MAX - kUnfinishedEnding) + " bytes");
}

void check_output(const fs::path& file, std::initializer_list<std::string_view> endings,
                  std::span<const std::string> inputs) {
  if (std::find(endings.begin(), endings.end(), file.extension().string()) == endings.end()) {
    std::string list;
    for (const std::string_view ending : endings) list.append(list.empty() ? "" : " or ").append(ending);
    throw BadInput(
        "--output: " + file.string() +
        (file.extension().empty() && std::ranges::find(endings, file.filename().string()) != endings.end()
             ? " has no name before its ending"
             : " does not end in " + list));
  }
  check_writable("--output", file);
  for (const std::string& input : inputs) {
    std::error_code error;
    if (fs::equivalent(file, input, error))
      throw BadInput("--output: " + file.string() + " is what is read: " + input + "; name another file");
  }
}

}  // namespace frontlux::app
