#pragma once

#include "support/command.hpp"

#include <gtest/gtest.h>

#include <concepts>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace frontlux::test {

/// Every part has to be in the text.
inline void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in\n" << text;
}

/// Tests of one of the commands of `frontlux`, with a folder of their own that is deleted with them.
class CommandTest : public testing::Test {
 protected:
  /// @param command  as "map"; empty: the words that are run begin with it
  explicit CommandTest(std::string command)
      : command_(std::move(command)),
        folder_(std::filesystem::temp_directory_path() /
                ("frontlux_" + command_ + "_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~CommandTest() override { std::filesystem::remove_all(folder_); }
  CommandTest(const CommandTest&) = delete;
  CommandTest& operator=(const CommandTest&) = delete;

  /// In the folder.
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Writes a file into the folder. @return its path
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  /// @param before  shell commands that come first, as "ulimit -f 8;"
  [[nodiscard]] Answer run(std::vector<std::string> words, const std::string& before = "") const {
    if (!command_.empty()) words.insert(words.begin(), command_);
    return run_frontlux(words, folder_, before);
  }

  /// The command does what it should without a complaint, and prints these parts.
  void expect_answer(const std::vector<std::string>& words, const std::vector<std::string>& parts) const {
    const Answer answer = run(words);
    EXPECT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.err, "");
    expect_parts(answer.out, parts);
  }

  /// The command complains in one line with these parts, exits with 2, and changes no file.
  void expect_refused(const std::vector<std::string>& words, const std::vector<std::string>& parts,
                      const std::string& before = "") const {
    const auto files_before = files();
    const Answer answer = run(words, before);
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_EQ(answer.out, "");
    EXPECT_TRUE(answer.err.starts_with("frontlux: ")) << answer.err;
    EXPECT_EQ(answer.err.find('\n'), answer.err.size() - 1) << answer.err;
    expect_parts(answer.err, parts);
    EXPECT_TRUE(files() == files_before) << "something was written: " << answer.err;
  }
  template <std::convertible_to<std::string> Text>
  void expect_refused(const std::vector<std::string>& words, const Text& part) const {
    expect_refused(words, std::vector<std::string>{part});
  }

 private:
  // Every file below the folder with its bytes, except what the command prints.
  [[nodiscard]] std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      all[entry.path().string()] = entry.is_regular_file() ? content_of(entry.path()) : "";
    all.erase(path("out"));
    all.erase(path("err"));
    return all;
  }

  std::string command_;

 protected:
  std::filesystem::path folder_;
};

}  // namespace frontlux::test
