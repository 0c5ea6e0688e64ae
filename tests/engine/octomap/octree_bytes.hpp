#pragma once

#include "octomap/octree_file.hpp"
#include "support/complaint.hpp"
#include "support/folder_test.hpp"
#include "support/tree_state.hpp"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <initializer_list>
#include <random>

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
  std::vector<Saved> all = {{"OcTree .ot", saved_full(tree), tree.size()},
                            {"ColorOcTree .ot", saved_full(color), color.size()}};
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

class OctreeFileTest : public FolderTest {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "map.ot"; }

  /// The tree, or nothing and why in `complaint_`.
  std::optional<OctreeFile> check(const std::string& content) {
    return caught([&] { return check_octree_bytes(path(), content); });
  }

  /// Expects a tree, which OctoMap then can use.
  OctreeFile accepted(const std::string& content) {
    const auto file = check(content);
    EXPECT_TRUE(file) << complaint_;
    if (!file) return {};
    give_to_octomap(*file);
    return *file;
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
    expect_parts(complaint_, parts);
    complaint_.clear();
  }

 private:
  template <class Read>
  std::optional<OctreeFile> caught(const Read& read_tree) {
    std::optional<OctreeFile> file;
    complaint_ = complaint_of<std::runtime_error>([&] { file = read_tree(); });
    EXPECT_TRUE(file || complaint_.starts_with(path().string() + ": ")) << complaint_;
    return file;
  }

 protected:
  std::string complaint_;
};

}  // namespace frontlux::test
