#pragma once

#include "support/command.hpp"
#include "support/complaint.hpp"

#include <concepts>

namespace frontlux::test {

/// The words, and more behind them.
inline std::vector<std::string> joined(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Tests of one of the commands of `frontlux`.
class CommandTest : public FolderTest {
 protected:
  /// @param command  as "map"; empty: the words that are run begin with it
  explicit CommandTest(std::string command) : command_(std::move(command)) {}

  /// @param before  shell commands that come first, as "ulimit -f 8;"
  [[nodiscard]] Answer run(std::vector<std::string> words, const std::string& before = "") const {
    if (!command_.empty()) words.insert(words.begin(), command_);
    return run_frontlux(words, folder_, before);
  }

  /// The command does what it should without a complaint, and prints these parts.
  /// @return all that it prints
  std::string expect_answer(const std::vector<std::string>& words, const std::vector<std::string>& parts = {},
                            const std::string& before = "") const {
    const Answer answer = run(words, before);
    EXPECT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.err, "");
    expect_parts(answer.out, parts);
    return answer.out;
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
};

/// Whether these are the bytes of a whole picture, as wide and high as this [pixels] or more.
inline void expect_png(const std::string& bytes, std::uint32_t width, std::uint32_t height) {
  const auto number = [&](std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i) word = word << 8U | static_cast<unsigned char>(bytes.at(at + i));
    return word;
  };
  ASSERT_GT(bytes.size(), 100U);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(12, 4), "IHDR");
  EXPECT_GE(number(16), width);
  EXPECT_GE(number(20), height);
  EXPECT_EQ(bytes.substr(bytes.size() - 8, 4), "IEND");
}

}  // namespace frontlux::test
