#include "engine/octomap/octree_bytes.hpp"
#include "support/maps.hpp"

#include <frontlux/octomap.hpp>

#include <locale>

namespace frontlux::test {
namespace {

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
  refuses(with(std::string(1000, 'x') + "\n"), {std::string("'").append(40, 'x').append("...'")});
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

TEST_F(OctreeFileTest, IsWrittenTheSameInEveryLocale) {
  const auto tree = make_random_tree(4, 1234.5);
  ASSERT_GE(tree->size(), 1000U) << "the least number that has a separator";
  for (const auto& [one, other] : {std::pair{"1.bt", "2.bt"}, {"1.ot", "2.ot"}}) {
    const auto here = folder_ / one, there = folder_ / other;
    write_octree(*tree, here);
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaDecimals));
    write_octree(*tree, there);
    std::locale::global(before);
    EXPECT_EQ(content_of(there), content_of(here));
  }
}

}  // namespace
}  // namespace frontlux::test
