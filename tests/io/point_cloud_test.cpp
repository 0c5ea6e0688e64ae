#include "support/input_test.hpp"

#include <frontlux/io/point_cloud.hpp>

namespace frontlux::io {
namespace {

using test::bytes_of;
class PointCloud : public test::InputTest {
 protected:
  PointCloud() : InputTest([](const auto& file) { static_cast<void>(read_point_cloud(file)); }) {}
};

const std::vector<Eigen::Vector3f> kPoints = {{1.5F, -2.F, 0.25F}, {0.F, 1e-3F, -7.F}, {100.F, 3.F, 4.F}};

std::string pcd_header(const std::string& data, const std::string& points = "3") {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS intensity x y rgb z\nSIZE 2 4 8 1 4\nTYPE U F F U F\nCOUNT 1 1 1 "
         "3 1\nWIDTH " +
         points + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA " + data + "\n";
}
std::string pcd_binary() {
  std::string bytes = pcd_header("binary");
  for (const auto& p : kPoints)
    bytes += bytes_of<std::uint16_t>(7) + bytes_of(p.x()) + bytes_of(static_cast<double>(p.y())) + "rgb" +
             bytes_of(p.z());
  return bytes;
}
std::string pcd_ascii() {
  return pcd_header("ascii") + "7 1.5 -2 1 2 3 0.25\n7 0 +1e-3 1 2 3 -7\r\n\n7 1e2 3 1 2 3 4";
}

std::string ply() {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty uchar red\nproperty double z\n"
         "property float32 y\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "1.5 9 0.25 -2\n0 9 -7 0.001\n100 9 4 3\n3 0 1 2\n";
}

TEST_F(PointCloud, ReadsClouds) {
  EXPECT_EQ(read_point_cloud(save("a.pcd", pcd_ascii())), kPoints);
  EXPECT_EQ(read_point_cloud(save("a.PCD", pcd_binary())), kPoints);
  EXPECT_EQ(read_point_cloud(save("a.Ply", ply())), kPoints);
  EXPECT_TRUE(read_point_cloud(save("a.pcd", pcd_header("binary", "0"))).empty());
  const auto strange = read_point_cloud(
      save("a.pcd", std::string("FIELDS x y z\nSIZE 8 1 2\nTYPE F I I\nPOINTS 1\nDATA binary\n") +
                        bytes_of(-1e300) + bytes_of<std::int8_t>(-3) + bytes_of<std::int16_t>(-300)));
  ASSERT_EQ(strange.size(), 1U);
  EXPECT_EQ(strange[0], Eigen::Vector3f(-std::numeric_limits<float>::infinity(), -3.F, -300.F));
  const auto nothing = read_point_cloud(
      save("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\nnan nan inf\n"));
  ASSERT_EQ(nothing.size(), 1U);
  EXPECT_TRUE(std::isnan(nothing[0].x()) && std::isinf(nothing[0].z()));
}

TEST_F(PointCloud, RefusesTruncatedClouds) {
  const std::string binary = pcd_binary(), ascii = pcd_ascii();
  for (std::size_t size = 0; size < binary.size(); ++size)
    ASSERT_NE(complaint("a.pcd", binary.substr(0, size)), "") << size << " bytes";
  // Text that ends within the last line may be complete.
  for (std::size_t size = 0; size < ascii.size(); ++size)
    if (complaint("a.pcd", ascii.substr(0, size)).empty()) {
      ASSERT_EQ(read_point_cloud(folder_ / "a.pcd").size(), kPoints.size()) << size;
    }
}

TEST_F(PointCloud, RefusesBadClouds) {
  const auto bad_pcd = [&](const std::string& header, const std::string& part) {
    expect_refused("a.pcd", header, part);
  };
  const std::string xyz = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
  bad_pcd(pcd_header("binary_compressed"),
          "line 11: DATA is 'binary_compressed'; save the cloud as ascii or binary");
  bad_pcd(pcd_header("binary", "999999999999"), "bytes follow");
  bad_pcd(pcd_header("binary", "18446744073709551615"), "more points than can be");
  bad_pcd(pcd_ascii() + "\n\n7 1 1 1 2 3 4\n", "comes after all 3 points");
  bad_pcd(pcd_header("ascii", "999999999999"), "ends after 0 of 999999999999 points");
  bad_pcd(xyz + "WIDTH 4294967296\nHEIGHT 4294967296\nDATA binary\n", "more points than can be");
  bad_pcd(xyz + "WIDTH 2\nHEIGHT 2\nPOINTS 3\nDATA ascii\n", "POINTS is 3, but WIDTH times HEIGHT is 4");
  bad_pcd(xyz + "DATA ascii\n", "no line of POINTS");
  bad_pcd(xyz + "POINTS -1\nDATA ascii\n", "line 4: POINTS is not followed by one whole number");
  bad_pcd("FIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 0\nDATA ascii\n", "no fields x, y and z");
  bad_pcd("FIELDS x y z x\nSIZE 4 4 4 4\nTYPE F F F F\nPOINTS 0\nDATA ascii\n", "'x' comes twice");
  bad_pcd("FIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 0\nDATA ascii\n", "not of the same length");
  bad_pcd("FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 0\nDATA ascii\n", "size '3'");
  bad_pcd("FIELDS x y z\nSIZE 4 4 4\nTYPE F F Q\nPOINTS 0\nDATA ascii\n", "type 'Q'");
  bad_pcd("FIELDS x y z q\nSIZE 4 4 4 8\nTYPE F F F F\nCOUNT 1 1 1 99999999999\nPOINTS 0\nDATA ascii\n",
          "COUNT of '99999999999'");
  bad_pcd(xyz + "POINTS 1\nDATA ascii\n1 2\n", "line 6: has 2 numbers instead of 3");
  bad_pcd(xyz + "POINTS 1\nDATA ascii\n1 2 three\n", "line 6: 'three' is no number");
  bad_pcd("\x1b[31mFIELDS\n", "'?[31mFIELDS' belongs into no PCD header");
  expect_refused("a.xyz", "1 2 3\n", "give a .pcd or .ply file");
}

}  // namespace
}  // namespace frontlux::io
