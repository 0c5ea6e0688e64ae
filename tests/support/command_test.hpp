#pragma once

#include "support/command.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace frontlux::test {

/// Tests of one of the commands of `frontlux`, with a folder of their own that goes with them.
class CommandTest : public testing::Test {
 protected:
  /// @param command  as "map"
  explicit CommandTest(std::string command)
      : command_(std::move(command)),
        folder_(std::filesystem::temp_directory_path() /
                ("frontlux_" + command_ + "_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~CommandTest() override { std::filesystem::remove_all(folder_); }
  CommandTest(const CommandTest&) = delete;
  CommandTest& operator=(const CommandTest&) = delete;

  /// In the folder.
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] Answer run(std::vector<std::string> words) const {
    words.insert(words.begin(), command_);
    return run_frontlux(words, folder_);
  }

  /// Below the folder, with those that `run` writes.
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names = {path("out"), path("err")};
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      names.insert(entry.path().string());
    return names;
  }

  void expect_refused(const std::vector<std::string>& words, const std::string& part) const {
    const auto names = files();
    const Answer answer = run(words);
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_EQ(answer.out, "");
    EXPECT_TRUE(answer.err.starts_with("frontlux: ")) << answer.err;
    EXPECT_NE(answer.err.find(part), std::string::npos) << answer.err << " does not say: " << part;
    EXPECT_EQ(files(), names);  // nothing half-written
  }

 private:
  std::string command_;

 protected:
  std::filesystem::path folder_;
};

}  // namespace frontlux::test
