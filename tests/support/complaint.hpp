#pragma once

#include "support/test.hpp"

/// A wrong call.
#define EXPECT_REFUSED(...) EXPECT_THROW(static_cast<void>(__VA_ARGS__), std::invalid_argument)

namespace frontlux::test {

/// Every part has to be in the text.
inline void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in\n" << text;
}

/// What a call says when it throws such an error; empty if it does not throw.
template <class Error = std::invalid_argument, class Call>
std::string complaint_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// The call throws such an error, and says each of the parts.
template <class Error = std::invalid_argument, class Call>
void expect_complaint(const Call& call, const std::vector<std::string>& parts) {
  const std::string said = complaint_of<Error>(call);
  EXPECT_NE(said, "") << "no complaint of " << testing::PrintToString(parts);
  expect_parts(said, parts);
}

}  // namespace frontlux::test
