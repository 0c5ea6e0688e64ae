#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

namespace frontlux::app {

/// What the user gave cannot be worked with: the message says what it is and what to give instead.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Does work that fails only because of its input or the disk: every failure becomes a BadInput.
/// @param input   a file or world, named in front of messages that do not name it
/// @param memory  what to do if there is too little memory
void work_on(const std::string& input, const char* memory, const std::function<void()>& work);

/// Checks the name of a file to be written, so that what would fail in the end fails before the work.
/// @param endings  of which the name has to have one: ".bt"
/// @throws BadInput, also if the file's folder is not there or may not be written to
void check_output(const std::filesystem::path& file, std::initializer_list<std::string_view> endings);

}  // namespace frontlux::app
