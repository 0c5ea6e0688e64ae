#include "bad_input.hpp"

#include <algorithm>
#include <new>
#include <system_error>
#include <unistd.h>

namespace frontlux::app {

void work_on(const std::string& input, const char* memory, const std::function<void()>& work) {
  try {
    work();
  } catch (const BadInput&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw BadInput(input + ": there is not enough memory; " + memory);
  } catch (const std::invalid_argument& error) {
    throw BadInput(input + ": " + error.what());
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  }
}

void check_output(const std::filesystem::path& file, std::initializer_list<std::string_view> endings) {
  const auto refuse = [&](const std::string& why) {
    throw BadInput("--output: " + file.string() + " " + why);
  };
  if (std::find(endings.begin(), endings.end(), file.extension().string()) == endings.end()) {
    std::string list;
    for (const std::string_view ending : endings) list.append(list.empty() ? "" : " or ").append(ending);
    refuse("does not end in " + list);
  }
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) refuse("is a folder; name a file in it");
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    refuse("is not a regular file; name a file");
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, error))
    refuse("cannot be written: there is no folder " + folder.string() + "; create it first");
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse("cannot be written: the folder " + folder.string() + " is read-only; check its permissions");
}

}  // namespace frontlux::app
