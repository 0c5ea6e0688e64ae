#include "support/complaint.hpp"
#include "support/input_test.hpp"

#include <frontlux/io/ply.hpp>

namespace frontlux::io {
namespace {

using test::bytes_of;
class Ply : public test::InputTest {
 protected:
  Ply() : InputTest([](const auto& file) { static_cast<void>(read_ply(file)); }) {}
};

// A triangle and a square, and an element and properties that nobody needs; as text.
const std::string kText =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 5\nproperty float x\nproperty double y\n"
    "property uchar red\nproperty float32 z\nelement camera 1\nproperty list uint8 short angles\n"
    "element face 2\nproperty list uint8 int32 vertex_index\nproperty uchar flag\nend_header\n"
    "0 0 7 0\n2 0 7 0\n2 3 7 nan\n0 3 7 0\n0 0 7 -5\n3 90 -45 0\n3 0 1 4 9\n4 0 1 2 3 9\n";

TEST_F(Ply, ReadsTextLineByLine) {
  std::string with_returns;
  for (const char c : kText) with_returns += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (const std::string& text : {kText, with_returns}) {
    const RawMesh mesh = read_ply(save("a.ply", text));
    ASSERT_EQ(mesh.vertices.size(), 5U);
    EXPECT_EQ(mesh.vertices[1], Eigen::Vector3d(2, 0, 0));
    EXPECT_TRUE(std::isnan(mesh.vertices[2].z()));
    EXPECT_EQ(mesh.vertices[4], Eigen::Vector3d(0, 0, -5));
    const std::vector<std::array<std::uint64_t, 3>> triangles = {{0, 1, 4}, {0, 1, 2}, {0, 2, 3}};
    EXPECT_EQ(mesh.triangles, triangles);
  }
}

TEST_F(Ply, ReadsBinaryOfEitherByteOrder) {
  for (const bool big : {false, true}) {
    std::string bytes =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement vertex 3\nproperty double x\nproperty float y\nproperty short z\n"
        "element face 1\nproperty uchar flag\nproperty list ushort uint vertex_indices\nend_header\n";
    const std::size_t header = bytes.size();
    const auto add = [&](auto value) {
      std::string raw = bytes_of(value);
      if (big != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
      bytes += raw;
    };
    for (const auto& [x, y, z] :
         {std::tuple(0.5, 1.25F, -3), std::tuple(2.0, 0.0F, 7), std::tuple(-1.0, 4.0F, 300)}) {
      add(x);
      add(y);
      add(static_cast<std::int16_t>(z));
    }
    add(std::uint8_t{9});
    add(std::uint16_t{3});
    for (const std::uint32_t i : {0U, 1U, 2U}) add(i);
    const RawMesh mesh = read_ply(save("b.ply", bytes));
    ASSERT_EQ(mesh.vertices.size(), 3U);
    EXPECT_EQ(mesh.vertices[0], Eigen::Vector3d(0.5, 1.25, -3));
    EXPECT_EQ(mesh.vertices[2], Eigen::Vector3d(-1, 4, 300));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint64_t, 3>>{{0, 1, 2}}));
    for (std::size_t size = 0; size < bytes.size(); ++size)
      ASSERT_NE(complaint("b.ply", bytes.substr(0, size)), "") << size << " bytes";
    // The list announces more than the file holds.
    std::string damaged = bytes;
    damaged.replace(header + 3 * 14 + 1, 2, "\xff\xff");
    expect_refused("b.ply", damaged,
                   "announces a list of 65535, but only 12 bytes follow (byte " +
                       std::to_string(header + 3 * 14 + 3) + ")");
  }
}

TEST_F(Ply, SaysWhatIsWrong) {
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& part) {
    expect_refused("a.ply", test::replaced(kText, from, to), part);
  };
  expect_refused("a.ply", "", "ends before its header does; a PLY header ends with a line of end_header");
  expect_refused("a.ply", "solid\n", "line 1: does not begin with the line 'ply'");
  expect_refused("a.ply", "ply\nformat ascii 1.0\nend_header\n", "no element 'vertex'");
  expect_refused("a.ply", "ply\nformat ascii 1.0\nproperty float x\n",
                 "line 3: the property is not of the form");
  refused("ascii", "ebcdic", "line 2: the format is 'ebcdic'");
  refused("ascii 1.0", "ascii 2.0", "of an unknown version");
  refused("format ascii 1.0\n", "", "no line of the format");
  refused("comment", "remark", "line 3: 'remark' belongs into no PLY header");
  refused("float x", "quaternion x", "line 5: the property is of the unknown type 'quaternion'");
  refused("float x", "list float x", "line 5: the property is not of the form");
  refused("float x", "list uchar float x", "the vertices have no x");
  refused("double y", "double why", "the vertices have no y");
  refused("double y", "double x", "line 6: the property 'x' comes twice");
  std::string elements, properties;
  for (int i = 0; i < 1000; ++i) {
    elements += "element e" + std::to_string(i) + " 0\n";
    properties += "property float p" + std::to_string(i) + "\n";
  }
  refused("element face", elements + "element face", "there are more than 1000 elements");
  refused("element camera", properties + "element camera", "there are more than 1000 properties");
  refused("element camera", "element vertex", "line 9: there is a second element 'vertex'");
  for (const char* count : {"eight", "-8", "99999999999999999999"})
    refused("vertex 5", std::string("vertex ") + count,
            "line 4: the element does not have a name and a number");
  refused("vertex 5", "vertex 18446744073709551615",
          "announces 18446744073709551615 of the element 'vertex'");
  refused("vertex 5", "vertex 4", "line 19: has more numbers than the header says");
  refused("vertex 5", "vertex 6", "line 21: has more numbers than the header says");
  refused("face 2", "face 3", "the file ends too early");
  refused("face 2", "face 99", "announces 99 of the element 'face'");
  refused("element face", "element nothing 9\nelement face", "announces 9 of the element 'nothing'");
  refused("3 0 1 4 9", "3 0 1 4", "line 21: has fewer numbers");
  refused("3 0 1 4 9", "3 0 1 4 9 9", "line 21: has more numbers");
  for (const char* index : {"-1", "1.5", "nan", "1e300"})
    refused("3 0 1 4", std::string("3 0 ") + index + " 4",
            "line 21: an index or a length is not a whole number");
  refused("3 0 1 4", "4000000000 0 1 4", "announces a list of 4000000000");
  refused("2 0 7 0", "2 two 7 0", "line 16: 'two' is no number; write a number");
  refused("2 0 7 0", "2 \x1b[31m 7 0", "'?[31m' is no number");
}

TEST_F(Ply, ReadsNoMoreBytesThanAllowed) {
  EXPECT_THROW(static_cast<void>(read_ply(save("a.ply", kText), kText.size() - 1)), std::runtime_error);
}

}  // namespace
}  // namespace frontlux::io
