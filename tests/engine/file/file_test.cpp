#include "support/folder_test.hpp"

#include <frontlux/file.hpp>

#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <atomic>
#include <csignal>
#include <fcntl.h>
#include <ranges>
#include <thread>
#include <unistd.h>

namespace frontlux {
namespace {

using FileTest = test::FolderTest;

// As a robot's driver does with what another program reads.
TEST_F(FileTest, ReadsAFileWholeWhileItIsReplaced) {
  const std::string file = path("table.csv");
  const auto bytes_of = [](std::size_t size) {
    return std::string(size, static_cast<char>('a' + static_cast<int>(size % 26)));
  };
  write_file(file, bytes_of(1));
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (std::size_t size = 1; !done; size = size % 900 + 1) write_file(file, bytes_of(size));
  });
  std::set<std::size_t> sizes;
  std::size_t wrong = 0;
  std::string said;
  for (int i = 0; i < 100'000 && (i < 4000 || sizes.size() < 20); ++i) {
    try {
      const std::string bytes = read_file(file);
      if (bytes != bytes_of(bytes.size())) ++wrong;
      sizes.insert(bytes.size());
    } catch (const std::runtime_error& error) {
      said = error.what();
    }
  }
  done = true;
  writer.join();
  EXPECT_EQ(said, "");
  EXPECT_EQ(wrong, 0U);
  EXPECT_GE(sizes.size(), 20U);
}

TEST_F(FileTest, RefusesWhatIsTooLargeOrNoFile) {
  const std::string file = write("bytes", "0123456789");
  EXPECT_EQ(read_file(file, 10), "0123456789");
  const auto said = [](const auto& call) {
    try {
      call();
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(said([&] { static_cast<void>(read_file(file, 9)); }).find("has 10 bytes, more than the 9"),
            std::string::npos);
  EXPECT_NE(said([&] { static_cast<void>(read_file(path("none"))); }).find("no such file"),
            std::string::npos);
  EXPECT_NE(said([&] { static_cast<void>(read_file(folder_)); }).find("is a directory"), std::string::npos);
}

// A process that a signal ends in the middle of a file.
TEST_F(FileTest, RemovesWhatAHandlerFindsUnfinished) {
  write("table.csv", "old");
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGTERM, [](int) {
      remove_own_unfinished();
      _exit(3);
    });
    write_file(path("other.csv"), "whole");
    write_file(path("table.csv"), [&](std::ostream& stream) {
      stream << "half" << std::flush;
      if (std::ranges::distance(std::filesystem::directory_iterator(folder_)) != 3) _exit(1);
      std::raise(SIGTERM);
    });
    _exit(2);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 3);
  EXPECT_EQ(test::content_of(path("table.csv")), "old");
  EXPECT_EQ(test::content_of(path("other.csv")), "whole");
  EXPECT_EQ(std::ranges::distance(std::filesystem::directory_iterator(folder_)), 2);
}

// Of threads that write the same file the last one wins, but each writes one of its own until it is whole.
TEST_F(FileTest, IsWholeWhoeverWritesItAtOnce) {
  const std::string file = path("shared.csv");
  std::vector<std::thread> threads;
  for (const char letter : {'a', 'b', 'c', 'd'})
    threads.emplace_back([&, letter] {
      for (int i = 0; i < 50; ++i) {
        write_file(file, std::string(200'000, letter));
        const std::string there = test::content_of(file);
        EXPECT_EQ(there.size(), 200'000U);
        EXPECT_EQ(there.find_first_not_of(there.front()), std::string::npos);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(std::ranges::distance(std::filesystem::directory_iterator(folder_)), 1);
}

// Processes of two containers may have the same number: the lock says who writes, not the number.
TEST_F(FileTest, RemovesOnlyWhatNobodyWrites) {
  const std::string file = path("map.ot"), left = ".part-frontlux-" + std::to_string(getpid()) + "-";
  write("map.ot" + left + "0", "of one that had this number and was killed");
  write("map.ot" + left + "1", "of one that has this number and writes");
  write("map.ot.part-frontlux-notes", "somebody's own");
  const int locked = open((file + left + "1").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(locked, LOCK_EX | LOCK_NB), 0);
  write_file(file, [&](std::ostream& stream) {
    stream << "whole";
    EXPECT_FALSE(std::filesystem::exists(file + left + "2"));  // 0 is free again
    remove_unfinished(file);
    EXPECT_TRUE(std::filesystem::exists(file + left + "0"));  // this one, which is being written
  });
  EXPECT_EQ(test::content_of(file), "whole");
  EXPECT_FALSE(std::filesystem::exists(file + left + "0"));
  EXPECT_EQ(test::content_of(file + left + "1"), "of one that has this number and writes");
  EXPECT_TRUE(std::filesystem::exists(path("map.ot.part-frontlux-notes")));
  close(locked);
  remove_unfinished(file);
  EXPECT_FALSE(std::filesystem::exists(file + left + "1"));
}

// A pipe or a device does not become a file by being named as one.
TEST_F(FileTest, LeavesWhatIsNoFileAsItIs) {
  const std::string pipe = path("pipe"), link = path("link");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink(pipe, link);
  for (const std::string& file : {pipe, link}) {
    EXPECT_THROW(write_file(file, "bytes"), std::runtime_error);
    EXPECT_TRUE(std::filesystem::is_fifo(file)) << file;
  }
}

}  // namespace
}  // namespace frontlux
