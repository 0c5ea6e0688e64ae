#include "map_output.hpp"

#include "bad_input.hpp"

#include <string>
#include <system_error>
#include <unistd.h>

namespace frontlux::app {

void check_map_output(const std::filesystem::path& file) {
  if (file.extension() != ".bt" && file.extension() != ".ot")
    throw BadInput("--output: " + file.string() + " is no name for a map; give one that ends in .bt or .ot");
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw BadInput("--output: " + file.string() + " is a folder; name a file in it");
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, error))
    throw BadInput("--output: there is no folder " + folder.string() + "; make it first");
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw BadInput("--output: nothing can be written to the folder " + folder.string() +
                   "; check its permissions");
}

}  // namespace frontlux::app
