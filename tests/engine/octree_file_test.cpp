#include "octree_file.hpp"

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <sys/stat.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

namespace frontlux::detail {
namespace {

constexpr const char* kBinary = "# Octomap OcTree binary file\n";
constexpr const char* kFull = "# Octomap OcTree file\n";

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

std::string header(const std::string& first_line, std::uint64_t size, const std::string& id = "OcTree",
                   const std::string& res = "0.1") {
  return first_line + "#\nid " + id + "\nsize " + std::to_string(size) + "\nres " + res + "\ndata\n";
}

std::string full_record(float log_odds, int child_mask) {
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

std::vector<Saved> saved_trees() {
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

// Everything that a map is used for, which a tree that was read badly might not survive.
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

void give_to_octomap(const OctreeFile& file) {
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

  // The tree, or nothing and why in `complaint_`.
  std::optional<OctreeFile> check(const std::string& content) {
    return caught([&] { return check_octree_bytes(path(), content); });
  }

  std::optional<OctreeFile> read() {
    return caught([&] { return read_checked_octree_file(path()); });
  }

  // Expects a refusal that says each of `parts`.
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

TEST_F(OctreeFileTest, ReadsWhatOctoMapWrites) {
  for (const auto& [name, content, nodes] : saved_trees()) {
    SCOPED_TRACE(name);
    std::ofstream(path(), std::ios::binary) << content;
    const auto file = read();
    ASSERT_TRUE(file) << complaint_;
    EXPECT_EQ(file->format, name.ends_with(".bt") ? OctreeFormat::kBinary : OctreeFormat::kFull);
    EXPECT_EQ(file->tree_type, name.substr(0, name.find(' ')));
    EXPECT_EQ(file->resolution, 0.1);
    EXPECT_EQ(file->node_count, nodes);
    EXPECT_EQ(file->data_offset, content.find("data\n") + 5);
    EXPECT_EQ(file->bytes, content);
    give_to_octomap(*file);
  }
}

TEST_F(OctreeFileTest, AgreesWithOctoMapsOwnReaders) {
  for (const auto& [name, content, nodes] : saved_trees()) {
    SCOPED_TRACE(name);
    const auto file = check(content + "bytes behind the tree");
    ASSERT_TRUE(file) << complaint_;
    std::istringstream stream(file->bytes);
    if (file->format == OctreeFormat::kFull) {
      const std::unique_ptr<octomap::AbstractOcTree> tree(octomap::AbstractOcTree::read(stream));
      ASSERT_TRUE(tree);
      EXPECT_EQ(tree->getTreeType(), file->tree_type);
      EXPECT_EQ(tree->size(), file->node_count);
    } else {
      octomap::OcTree tree(1.);
      EXPECT_TRUE(tree.readBinary(stream));
      EXPECT_EQ(tree.size(), file->node_count);
      EXPECT_EQ(tree.getResolution(), file->resolution);
    }
  }
}

TEST_F(OctreeFileTest, ReadsEmptyTrees) {
  octomap::OcTree tree(0.25);
  for (const std::string& content : {saved_binary(tree), saved_full(tree)}) {
    const auto file = check(content);
    ASSERT_TRUE(file) << complaint_;
    EXPECT_EQ(file->node_count, 0U);
    EXPECT_EQ(file->resolution, 0.25);
    give_to_octomap(*file);
    refuses(content + "x", {"declares no nodes, but 1 bytes"});
  }
}

TEST_F(OctreeFileTest, RefusesEveryTruncation) {
  for (const auto& [name, content, nodes] : saved_trees()) {
    SCOPED_TRACE(name);
    for (std::size_t length = 0; length < content.size(); ++length)
      ASSERT_FALSE(check(content.substr(0, length))) << "cut to " << length;
  }
  const std::string content = saved_trees()[0].content;
  refuses(content.substr(0, content.size() - 1),
          {"ends inside the tree", std::to_string(content.size() - content.find("data\n") - 6) + " bytes",
           std::to_string(saved_trees()[0].nodes) + " nodes are declared", "another copy"});
}

TEST_F(OctreeFileTest, SurvivesEveryFlippedBit) {
  for (const auto& [name, content, nodes] : saved_trees()) {
    SCOPED_TRACE(name);
    std::size_t accepted = 0;
    for (std::size_t bit = 0; bit < 8 * content.size(); ++bit) {
      std::string mutant = content;
      mutant[bit / 8] = static_cast<char>(mutant[bit / 8] ^ (1 << (bit % 8)));
      const auto file = check(mutant);
      if (!file) continue;
      ++accepted;
      ASSERT_NO_FATAL_FAILURE(give_to_octomap(*file)) << "bit " << bit;
    }
    EXPECT_GT(accepted, 0U);
    EXPECT_LT(accepted, 8 * content.size());
  }
}

TEST_F(OctreeFileTest, SurvivesRandomDamage) {
  std::mt19937 random(20);
  const auto trees = saved_trees();
  const int rounds = std::getenv("FRONTLUX_LONG") != nullptr ? 200000 : 4000;
  for (int round = 0; round < rounds; ++round) {
    std::string mutant = trees[random() % trees.size()].content;
    const std::size_t data = mutant.find("data\n") + 5;
    const std::size_t first = random() % 4 == 0 ? 0 : data;  // most of the damage behind the header
    for (auto changes = random() % 8; changes-- > 0;) {
      const std::size_t at = first + random() % (mutant.size() - first);
      const auto kind = random() % 4;
      if (kind == 0)
        mutant.erase(at, 1 + random() % 4);
      else if (kind == 1)
        mutant.insert(at, 1 + random() % 4, static_cast<char>(random() % 256));
      else
        mutant[at] = static_cast<char>(random() % 256);
      if (mutant.size() <= first) break;
    }
    const auto file = check(mutant);
    if (!file) continue;
    ASSERT_NO_FATAL_FAILURE(give_to_octomap(*file)) << "round " << round;
  }
}

TEST_F(OctreeFileTest, KnowsTheDepthOfATree) {
  const std::string to_child = bytes({0x03, 0x00}), to_leaf = bytes({0x01, 0x00});
  const auto deepest = check(header(kBinary, 17) + repeated(to_child, 15) + to_leaf);
  ASSERT_TRUE(deepest) << complaint_;
  give_to_octomap(*deepest);
  refuses(header(kBinary, 18) + repeated(to_child, 16) + to_leaf, {"more than 16 levels", "byte"});

  const std::string inner = full_record(0.F, 1), leaf = full_record(0.F, 0);
  const auto deepest_full = check(header(kFull, 17) + repeated(inner, 16) + leaf);
  ASSERT_TRUE(deepest_full) << complaint_;
  give_to_octomap(*deepest_full);
  refuses(header(kFull, 18) + repeated(inner, 17) + leaf, {"more than 16 levels", "byte"});
}

TEST_F(OctreeFileTest, RefusesEndlessChains) {
  constexpr int kLinks = 3'000'000;
  refuses(header(kBinary, kLinks + 2) + repeated(bytes({0x03, 0x00}), kLinks) + bytes({0x01, 0x00}),
          {"more than 16 levels"});
  refuses(header(kFull, kLinks + 1) + repeated(full_record(1.F, 0x80), kLinks) + full_record(1.F, 0),
          {"more than 16 levels"});
}

TEST_F(OctreeFileTest, RefusesNodesWithoutTheChildrenTheyClaim) {
  refuses(header(kBinary, 2) + bytes({0x03, 0x00, 0x00, 0x00}), {"claims children and has none", "byte 63"});
  refuses(header(kBinary, 1) + bytes({0x00, 0x00}), {"root without children", ".ot"});
  const auto root_only = check(header(kFull, 1) + full_record(-1.F, 0));
  ASSERT_TRUE(root_only) << complaint_;
  EXPECT_EQ(root_only->node_count, 1U);
  give_to_octomap(*root_only);
}

TEST_F(OctreeFileTest, ComparesTheDeclaredSize) {
  const std::string two_nodes = bytes({0x01, 0x00});
  EXPECT_TRUE(check(header(kBinary, 2) + two_nodes));
  EXPECT_TRUE(check(header(kBinary, 2) + two_nodes + "more"));
  refuses(header(kBinary, 3) + two_nodes, {"declares 3 nodes and holds 2"});
  refuses(header(kBinary, 4294967295) + two_nodes, {"declares 4294967295 nodes and holds 2"});
  const std::string one_node = full_record(1.F, 0);
  const auto file = check(header(kFull, 9) + one_node);
  ASSERT_TRUE(file) << complaint_;
  EXPECT_EQ(file->node_count, 1U);
  give_to_octomap(*file);
  refuses(header(kFull, 9) + one_node + "more", {"declares 9 nodes and holds 1"});
  EXPECT_TRUE(check(header(kFull, 1) + one_node + "more"));
}

TEST_F(OctreeFileTest, AcceptsLogOddsThatAreNoNumbers) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float log_odds : {std::nanf(""), kInfinity, -kInfinity}) {
    const auto file = check(header(kFull, 2) + full_record(0.F, 1) + full_record(log_odds, 0));
    ASSERT_TRUE(file) << complaint_;
    octomap::OcTree tree(file->resolution);
    std::istringstream nodes(file->bytes.substr(file->data_offset));
    tree.readData(nodes);
    EXPECT_EQ(tree.isNodeOccupied(tree.search(octomap::OcTreeKey(0, 0, 0))), log_odds > 0.F);
    give_to_octomap(*file);
  }
}

TEST_F(OctreeFileTest, RefusesBadHeaders) {
  const std::string leaf = full_record(1.F, 0);
  const auto with = [&](const std::string& lines) { return std::string(kFull) + lines + "data\n" + leaf; };
  refuses(with("size 1\nres 0.1\n"), {"no 'id' line", "'id', 'size' and 'res'"});
  refuses(with("id OcTree\nres 0.1\n"), {"no 'size' line"});
  refuses(with("id OcTree\nsize 1\n"), {"no 'res' line"});
  refuses(with("id OcTree\nsize 1\nres\n"), {"no value for 'res'"});
  refuses(with("id OcTree\nsize 1\nsize 1\nres 0.1\n"), {"second 'size' line"});
  refuses(with("id OcTree\nsize 1\nres 0.1\nsighs 1\n"), {"unknown line", "'sighs 1'"});
  refuses(with("\x1b[2J\x01\n"), {"unknown line", "'?[2J?'"});
  refuses(with(std::string(1000, 'x') + "\n"), {"'" + std::string(40, 'x') + "...'"});
  refuses(std::string(kFull) + "id OcTree\nsize 1\nres 0.1\ndata 5\n" + leaf, {"'5' behind 'data'"});
  refuses(std::string(kFull) + "id OcTree\nsize 1\nres 0.1\n", {"before the 'data' line"});
  refuses(std::string(kFull) + std::string(100000, '#'), {"before the 'data' line"});
  for (const char* size :
       {"-1", "+1", "1.0", "1e0", "0x1", "1,000", "4294967296", "99999999999999999999", "one", "1 1"})
    refuses(with(std::string("id OcTree\nsize ") + size + "\nres 0.1\n"),
            {"declares 'size' '" + std::string(size) + "'", "whole number", "byte 32"});
  for (const char* res : {"0", "-0.1", "nan", "inf", "-inf", "1e999", "1e-999", "1e-10", "1e10", "0,1",
                          "0x1p-3", "1m", ".", "1e", "0.1 0.1"})
    refuses(with(std::string("id OcTree\nsize 1\nres ") + res + "\n"),
            {"declares 'res' '" + std::string(res) + "'", "1e-9 to 1e9", "byte 39"});
  for (const char* id : {"OcTreeStamped", "octree", "2", "OcTree2", "Color OcTree"})
    refuses(with(std::string("id ") + id + "\nsize 1\nres 0.1\n"),
            {"type '" + std::string(id) + "'", "only OcTree and ColorOcTree"});
}

TEST_F(OctreeFileTest, AcceptsHeadersThatOctoMapReads) {
  const std::string leaf = full_record(1.F, 0);
  const auto read_with = [&](const std::string& lines) {
    const auto file = check(std::string(kFull) + lines + "data\n" + leaf);
    EXPECT_TRUE(file) << complaint_;
    return file ? file->resolution : 0.;
  };
  EXPECT_EQ(read_with("res 0.05\nsize 1\nid OcTree\n"), 0.05);
  EXPECT_EQ(read_with("\n# id Nothing\n\n  id\tOcTree \nsize 001\nres 5e-2\n#"
                      "\n"),
            0.05);
  EXPECT_EQ(read_with("id OcTree\r\nsize 1\r\nres 25\r\n"), 25.);
  EXPECT_EQ(read_with("id 1\nsize 1\nres 1e9\n"), 1e9);
}

class CommaDecimals : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST_F(OctreeFileTest, ReadsTheSameInEveryLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaDecimals));
  const auto file = check(header(kFull, 1, "OcTree", "1234.5") + full_record(1.F, 0));
  std::locale::global(before);
  ASSERT_TRUE(file) << complaint_;
  EXPECT_EQ(file->resolution, 1234.5);
}

TEST_F(OctreeFileTest, RefusesForeignFiles) {
  refuses("", {"is empty"});
  refuses("PK\x03\x04", {"does not begin with", ".bt or .ot"});
  refuses("# Octomap OcTree\n", {"does not begin with"});
  refuses(bytes({3, 0, 0, 0}) + std::string(20, 'x'), {"before version 1.0", "convert_octree"});
  refuses(std::string(1 << 20, '\0'), {"does not begin with"});
}

TEST_F(OctreeFileTest, RefusesWhatIsNoReadableFile) {
  EXPECT_FALSE(read());
  says({"no such file"});
  std::ofstream(path()).close();
  EXPECT_FALSE(read());
  says({"is empty"});
  std::filesystem::remove(path());
  std::filesystem::create_directory(path());
  EXPECT_FALSE(read());
  says({"is a directory"});
  std::filesystem::remove(path());
  ASSERT_EQ(mkfifo(path().c_str(), 0600), 0);
  EXPECT_FALSE(read());  // and does not wait for a writer
  says({"not a regular file"});
  std::filesystem::remove(path());
  std::filesystem::create_symlink(path(), path());
  EXPECT_FALSE(read());
  says({"cannot be looked at"});
}

TEST_F(OctreeFileTest, RefusesWhatItMayNotRead) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  std::ofstream(path(), std::ios::binary) << saved_trees()[0].content;
  std::filesystem::permissions(path(), std::filesystem::perms::none);
  EXPECT_FALSE(read());
  says({"cannot be opened"});
}

TEST_F(OctreeFileTest, RefusesFilesBeyondItsLimitUnread) {
  std::ofstream(path(), std::ios::binary) << kFull;
  std::error_code error;
  std::filesystem::resize_file(path(), (std::uintmax_t{4} << 30) + 1, error);
  if (error) GTEST_SKIP() << "no sparse file of this size here: " << error.message();
  EXPECT_FALSE(read());
  says({"4294967297 bytes", "4294967296 that can be read"});
}

}  // namespace
}  // namespace frontlux::detail
