#pragma once

#include "octomap/octree_file.hpp"

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

namespace frontlux::test {

using detail::check_octree_bytes;
using detail::OctreeFile;
using detail::OctreeFormat;
using detail::read_checked_octree_file;

inline constexpr const char* kBinary = "# Octomap OcTree binary file\n";
inline constexpr const char* kFull = "# Octomap OcTree file\n";

inline std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

inline std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

inline std::string header(const std::string& first_line, std::uint64_t size, const std::string& id = "OcTree",
                          const std::string& res = "0.1") {
  return first_line + "#\nid " + id + "\nsize " + std::to_string(size) + "\nres " + res + "\ndata\n";
}

inline std::string full_record(float log_odds, int child_mask) {
  std::string record(4, '\0');
  std::memcpy(record.data(), &log_odds, 4);
  return record + static_cast<char>(child_mask);
}

template <class Tree>
void grow(Tree& tree) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-2.F, 2.F);
  for (int i = 0; i < 12; ++i) {
    const octomap::point3d point(place(random), place(random), place(random));
    tree.updateNode(point, i % 3 == 0);
  }
  for (float x = 0.05F; x < 0.8F; x += 0.1F)
    for (float y = 0.05F; y < 0.8F; y += 0.1F)
      for (float z = 0.05F; z < 0.8F; z += 0.1F) tree.updateNode(octomap::point3d(x, y, z), false);
  tree.prune();
}

template <class Tree>
std::string saved_binary(Tree& tree) {
  std::ostringstream stream;
  tree.writeBinary(stream);
  return stream.str();
}

template <class Tree>
std::string saved_full(const Tree& tree) {
  std::ostringstream stream;
  tree.write(stream);
  return stream.str();
}

struct Saved {
  std::string name;
  std::string content;
  std::size_t nodes = 0;
};

inline std::vector<Saved> saved_trees() {
  octomap::OcTree tree(0.1);
  grow(tree);
  octomap::ColorOcTree color(0.1);
  grow(color);
  color.setNodeColor(0.05F, 0.05F, 0.05F, 10, 20, 30);
  std::vector<Saved> all;
  all.push_back({"OcTree .ot", saved_full(tree), tree.size()});
  all.push_back({"ColorOcTree .ot", saved_full(color), color.size()});
  const std::string binary = saved_binary(tree), color_binary = saved_binary(color);  // both prune their tree
  all.push_back({"OcTree .bt", binary, tree.size()});
  all.push_back({"ColorOcTree .bt", color_binary, color.size()});
  return all;
}

/// Everything that a map is used for, which a tree that was read badly might not survive.
template <class Tree>
void use(Tree& tree, const OctreeFile& file) {
  if (file.node_count != 0) {
    std::istringstream nodes(file.bytes.substr(file.data_offset));
    if (file.format == OctreeFormat::kBinary)
      tree.readBinaryData(nodes);
    else
      tree.readData(nodes);
    EXPECT_TRUE(nodes.good());
  }
  ASSERT_EQ(tree.size(), file.node_count);
  std::size_t leaves = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    EXPECT_LE(leaf.getDepth(), 16U);
    ++leaves;
  }
  EXPECT_EQ(leaves, tree.getNumLeafNodes());
  const auto r = static_cast<float>(tree.getResolution());
  octomap::point3d end;
  for (const float x : {-1.F, 0.3F, 2.F})
    tree.castRay(octomap::point3d(x, 0.F, 0.F), octomap::point3d(1.F, x, 0.2F), end, true, 20. * r);
  tree.updateNode(octomap::OcTreeKey(32770, 32769, 32768), true);
  tree.updateInnerOccupancy();
  tree.prune();
}

inline void give_to_octomap(const OctreeFile& file) {
  if (file.tree_type == "ColorOcTree") {
    octomap::ColorOcTree tree(file.resolution);
    use(tree, file);
  } else {
    octomap::OcTree tree(file.resolution);
    use(tree, file);
  }
}

class OctreeFileTest : public testing::Test {
 protected:
  OctreeFileTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("frontlux_octree_file_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~OctreeFileTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path path() const { return folder_ / "map.ot"; }

  /// The tree, or nothing and why in `complaint_`.
  std::optional<OctreeFile> check(const std::string& content) {
    return caught([&] { return check_octree_bytes(path(), content); });
  }

  std::optional<OctreeFile> read() {
    return caught([&] { return read_checked_octree_file(path()); });
  }

  /// Expects a refusal that says each of `parts`.
  void refuses(const std::string& content, const std::vector<std::string>& parts) {
    EXPECT_FALSE(check(content));
    says(parts);
  }

  void says(const std::vector<std::string>& parts) {
    for (const auto& part : parts) EXPECT_NE(complaint_.find(part), std::string::npos) << complaint_;
    complaint_.clear();
  }

 private:
  template <class Read>
  std::optional<OctreeFile> caught(const Read& read_tree) {
    try {
      return read_tree();
    } catch (const std::runtime_error& error) {
      complaint_ = error.what();
      EXPECT_TRUE(complaint_.starts_with(path().string() + ": ")) << complaint_;
      return std::nullopt;
    }
  }

 protected:
  std::filesystem::path folder_;
  std::string complaint_;
};

}  // namespace frontlux::test
