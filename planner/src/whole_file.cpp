#include "whole_file.hpp"

#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unistd.h>

namespace frontlux::planner::detail {
namespace {

// Removes the unfinished file on every way out but the good one.
class Part {
 public:
  explicit Part(const std::filesystem::path& file) : path_(file) {
    path_ += ".part" + std::to_string(::getpid());
  }
  ~Part() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

void write_whole_file(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write) {
  const auto fail = [&file](const std::string& what, const std::string& advice) {
    throw std::runtime_error(file.string() + ": cannot be written: " + what + "; " + advice);
  };
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) fail("it is a folder", "name a file in it");
  const Part part(file);
  errno = 0;
  std::ofstream stream(part.path(), std::ios::binary | std::ios::trunc);
  if (!stream)
    fail(std::generic_category().message(errno), "check that its folder exists and may be written to");
  write(stream);
  stream.close();
  if (!stream) fail(std::generic_category().message(errno), "check the space left on the disk");
  std::filesystem::rename(part.path(), file, error);
  if (error) fail(error.message(), "check the permissions of the folder and of the file that is there");
}

}  // namespace frontlux::planner::detail
