#pragma once

#include <stdexcept>

namespace frontlux::app {

/// What the user gave cannot be worked with: the message says what it is and what to give instead.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace frontlux::app
