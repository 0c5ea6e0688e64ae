#pragma once

#include "support/complaint.hpp"
#include "support/folder_test.hpp"

namespace frontlux::test {

/// Files for one reader, and what it says when it refuses them.
class InputTest : public FolderTest {
 protected:
  explicit InputTest(std::function<void(const std::filesystem::path&)> read) : read_(std::move(read)) {}

  [[nodiscard]] std::filesystem::path save(const std::string& name, const std::string& bytes) const {
    return write(name, bytes);
  }

  // What it says after the file's name when it refuses a file; empty if it does not.
  [[nodiscard]] std::string complaint(const std::filesystem::path& file) const {
    const std::string what = complaint_of<std::runtime_error>([&] { read_(file); });
    if (what.empty()) return what;
    const std::string begin = file.string() + ": ";
    EXPECT_TRUE(what.starts_with(begin)) << what;
    EXPECT_NE(what.find("; "), std::string::npos) << what << " gives no advice";
    return what.substr(begin.size());
  }
  [[nodiscard]] std::string complaint(const std::string& name, const std::string& bytes) const {
    return complaint(save(name, bytes));
  }

  void expect_refused(const std::filesystem::path& file, const std::string& part = "") const {
    const std::string said = complaint(file);
    EXPECT_NE(said, "") << file << " was read, but not: " << part;
    expect_parts(said, {part});
  }
  void expect_refused(const std::string& name, const std::string& bytes, const std::string& part) const {
    expect_refused(save(name, bytes), part);
  }

  std::function<void(const std::filesystem::path&)> read_;
};

/// A text in which one part, which it has to hold, is another.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

template <class Number>
std::string bytes_of(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

}  // namespace frontlux::test
