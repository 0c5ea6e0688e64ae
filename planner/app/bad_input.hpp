#pragma once

#include <functional>
#include <stdexcept>
#include <string>

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

}  // namespace frontlux::app
