#include "engine/octomap/octree_bytes.hpp"

#include <octomap/OcTree.h>
#include <sys/stat.h>

#include <random>
#include <unistd.h>

namespace frontlux::test {
namespace {

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
    const OctreeFile file = accepted(content);
    EXPECT_EQ(file.node_count, 0U);
    EXPECT_EQ(file.resolution, 0.25);
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
  accepted(header(kBinary, 17) + repeated(to_child, 15) + to_leaf);
  refuses(header(kBinary, 18) + repeated(to_child, 16) + to_leaf, {"more than 16 levels", "byte"});

  const std::string inner = full_record(0.F, 1), leaf = full_record(0.F, 0);
  accepted(header(kFull, 17) + repeated(inner, 16) + leaf);
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
  EXPECT_EQ(accepted(header(kFull, 1) + full_record(-1.F, 0)).node_count, 1U);
}

TEST_F(OctreeFileTest, ComparesTheDeclaredSize) {
  const std::string two_nodes = bytes({0x01, 0x00});
  EXPECT_TRUE(check(header(kBinary, 2) + two_nodes));
  EXPECT_TRUE(check(header(kBinary, 2) + two_nodes + "more"));
  refuses(header(kBinary, 3) + two_nodes, {"declares 3 nodes and holds 2"});
  refuses(header(kBinary, 4294967295) + two_nodes, {"declares 4294967295 nodes and holds 2"});
  const std::string one_node = full_record(1.F, 0);
  EXPECT_EQ(accepted(header(kFull, 9) + one_node).node_count, 1U);
  refuses(header(kFull, 9) + one_node + "more", {"declares 9 nodes and holds 1"});
  EXPECT_TRUE(check(header(kFull, 1) + one_node + "more"));
}

TEST_F(OctreeFileTest, AcceptsLogOddsThatAreNoNumbers) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float log_odds : {std::nanf(""), kInfinity, -kInfinity}) {
    const OctreeFile file = accepted(header(kFull, 2) + full_record(0.F, 1) + full_record(log_odds, 0));
    octomap::OcTree tree(file.resolution);
    std::istringstream nodes(file.bytes.substr(file.data_offset));
    tree.readData(nodes);
    EXPECT_EQ(tree.isNodeOccupied(tree.search(octomap::OcTreeKey(0, 0, 0))), log_odds > 0.F);
  }
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
  says({"cannot be inspected"});
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
}  // namespace frontlux::test
