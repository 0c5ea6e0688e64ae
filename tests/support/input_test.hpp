#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <utility>

namespace frontlux::test {

/// Files for one reader, and what it says when it refuses them.
class InputTest : public testing::Test {
 protected:
  explicit InputTest(std::function<void(const std::filesystem::path&)> read)
      : read_(std::move(read)),
        folder_(std::filesystem::temp_directory_path() / ("frontlux_input_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~InputTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path save(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  // What it says after the file's name when it refuses a file; empty if it does not.
  [[nodiscard]] std::string complaint(const std::filesystem::path& file) const {
    try {
      read_(file);
    } catch (const std::runtime_error& error) {
      const std::string what = error.what(), begin = file.string() + ": ";
      EXPECT_TRUE(what.starts_with(begin)) << what;
      EXPECT_NE(what.find("; "), std::string::npos) << what << " gives no advice";
      return what.substr(begin.size());
    }
    return "";
  }
  [[nodiscard]] std::string complaint(const std::string& name, const std::string& bytes) const {
    return complaint(save(name, bytes));
  }

  void expect_refused(const std::filesystem::path& file, const std::string& part = "") const {
    const std::string said = complaint(file);
    EXPECT_NE(said, "") << file << " was read, but not: " << part;
    EXPECT_NE(said.find(part), std::string::npos) << said << "\ndoes not say: " << part;
  }
  void expect_refused(const std::string& name, const std::string& bytes, const std::string& part) const {
    expect_refused(save(name, bytes), part);
  }

  std::function<void(const std::filesystem::path&)> read_;
  std::filesystem::path folder_;
};

template <class Number>
std::string bytes_of(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

}  // namespace frontlux::test
