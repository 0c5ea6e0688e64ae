#pragma once

#include "support/test.hpp"

#include <cstdlib>

namespace frontlux::test {

/// Empty if there is no such file.
inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A new, empty folder.
inline std::filesystem::path new_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "frontlux_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
  return name;
}

/// Tests with a folder of their own, which is deleted with them.
class FolderTest : public testing::Test {
 protected:
  FolderTest() = default;
  ~FolderTest() override { std::filesystem::remove_all(folder_); }
  FolderTest(const FolderTest&) = delete;
  FolderTest& operator=(const FolderTest&) = delete;

  /// In the folder.
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Writes a file into the folder. @return its path
  std::string write(const std::string& name, const std::string& bytes) const {
    std::filesystem::remove(path(name));  // some file systems wait for the disk when a file is overwritten
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  std::filesystem::path folder_ = new_folder();
};

}  // namespace frontlux::test
