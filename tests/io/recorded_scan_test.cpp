#include "support/quiet_octomap.hpp"
#include "support/random.hpp"

#include <frontlux/io/recorded_scan.hpp>

#include <gtest/gtest.h>
#include <octomap/ScanGraph.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace frontlux::planner {
namespace {

using test::Random;

class RecordedScanTest : public testing::Test {
 protected:
  RecordedScanTest()
      : folder_(std::filesystem::temp_directory_path() / ("frontlux_recorded_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~RecordedScanTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path save(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  // What it says when it refuses a file; empty if it does not.
  template <class Read>
  std::string complaint(const Read& read, const std::string& name, const std::string& bytes) const {
    const auto file = save(name, bytes);
    try {
      static_cast<void>(read(file));
    } catch (const std::runtime_error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(file.string() + ": ")) << error.what();
      return error.what();
    }
    return "";
  }

  template <class Read>
  void expect_refused(const Read& read, const std::string& name, const std::string& bytes,
                      const std::string& part) const {
    const std::string said = complaint(read, name, bytes);
    EXPECT_NE(said.find(part), std::string::npos) << "'" << said << "' does not say: " << part << "\n"
                                                  << bytes;
  }

  std::filesystem::path folder_;
};

std::vector<RecordedScan> graph(const std::filesystem::path& file) { return read_scan_graph(file); }
std::vector<Eigen::Vector3f> cloud(const std::filesystem::path& file) { return read_point_cloud(file); }
std::vector<RecordedPose> poses(const std::filesystem::path& file) { return read_pose_file(file); }

template <class Number>
std::string bytes_of(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

// A graph with edges, made and written by OctoMap.
struct Written {
  octomap::ScanGraph graph;
  std::string bytes;
  explicit Written(int points) {
    Random random(21);
    const auto number = [&] { return static_cast<float>(random.uniform(-9, 9)); };
    for (int node = 0; node < 3; ++node) {
      auto* scan = new octomap::Pointcloud;  // the graph deletes it
      for (int i = 0; i < points * node; ++i) scan->push_back(number(), number(), number());
      graph.addNode(scan, octomap::pose6d(number(), number(), number(), 0.3 * node, -0.2 * node, 1.1 + node));
    }
    graph.addEdge(0, 1);
    graph.addEdge(1, 2);
    std::ostringstream stream;
    graph.writeBinary(stream);
    bytes = stream.str();
  }
};

TEST_F(RecordedScanTest, ReadsGraphsThatOctomapWrites) {
  Written written(40);
  const auto scans = read_scan_graph(save("scans.graph", written.bytes));
  ASSERT_EQ(scans.size(), 3U);
  std::size_t n = 0;
  for (const auto* node : written.graph) {
    const RecordedScan& scan = scans[n++];
    ASSERT_EQ(scan.points.size(), node->scan->size());
    const auto in_world = points_in_world(scan);
    octomap::Pointcloud expected(*node->scan);
    expected.transform(node->pose);
    for (std::size_t i = 0; i < in_world.size(); ++i) {
      const auto p = (*node->scan)[static_cast<unsigned>(i)], q = expected[static_cast<unsigned>(i)];
      EXPECT_EQ(scan.points[i], Eigen::Vector3f(p.x(), p.y(), p.z()));
      EXPECT_LT((in_world[i] - Eigen::Vector3f(q.x(), q.y(), q.z())).norm(), 1e-5F);
    }
    const auto at = node->pose.trans();
    EXPECT_EQ(scan.T_world_sensor.translation(), Eigen::Vector3d(at.x(), at.y(), at.z()));
  }
}

TEST_F(RecordedScanTest, RefusesDamagedGraphs) {
  const Written written(2);
  for (std::size_t size = 0; size < written.bytes.size(); ++size)
    ASSERT_NE(complaint(graph, "a.graph", written.bytes.substr(0, size)), "") << size << " bytes";
  expect_refused(graph, "a.graph", written.bytes + "x", "1 bytes follow");
  expect_refused(graph, "a.graph", "# Octomap OcTree binary file\n", "more than the remaining");
  expect_refused(graph, "a.graph", bytes_of<std::uint32_t>(0xFFFFFFFF) + written.bytes.substr(4),
                 "4294967295 scans");

  // One scan of one point: 4 bytes of scans, 4 of points, 28 of the point, 28 and 36 of the pose, 4 of the
  // id.
  const auto replaced = [](std::string bytes, std::size_t at, const std::string& by) {
    return bytes.replace(at, by.size(), by);
  };
  octomap::ScanGraph small;
  auto* points = new octomap::Pointcloud;
  points->push_back(1.F, 2.F, 3.F);
  small.addNode(points, octomap::pose6d(1, 2, 3, 0, 0, 0));
  std::ostringstream stream;
  small.writeBinary(stream);
  const std::string one = stream.str();
  ASSERT_EQ(complaint(graph, "a.graph", one), "");
  expect_refused(graph, "a.graph", replaced(one, 4, bytes_of<std::uint32_t>(1 << 28)), "268435456 points");
  expect_refused(graph, "a.graph", replaced(one, 8, bytes_of<std::int32_t>(4)), "vector of 4 instead of 3");
  expect_refused(graph, "a.graph", replaced(one, 40, bytes_of(std::nan(""))), "pose that is not finite");
  expect_refused(graph, "a.graph", replaced(one, 40, bytes_of(std::numeric_limits<double>::infinity())),
                 "pose that is not finite");
  expect_refused(graph, "a.graph", replaced(one, 64, bytes_of<std::int32_t>(-4)),
                 "quaternion of -4 instead of 4");
  expect_refused(graph, "a.graph", replaced(one, 68, bytes_of(0.5)), "quaternion is not of length 1");
  const auto scans = graph(save("a.graph", replaced(one, 12, bytes_of(1e300))));
  EXPECT_EQ(scans[0].points[0], Eigen::Vector3f(std::numeric_limits<float>::infinity(), 2.F, 3.F));
  EXPECT_NE(complaint(graph, "nothing/a.graph", ""), "");
  EXPECT_THROW(graph(folder_), std::runtime_error);
}

TEST_F(RecordedScanTest, SurvivesFlippedBitsInGraphs) {
  const Written written(3);
  Random random(22);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = written.bytes;
    for (int flips = 1 + random.below(3); flips > 0; --flips) {
      char& byte = bytes[static_cast<std::size_t>(random.below(static_cast<int>(bytes.size())))];
      byte = static_cast<char>(byte ^ (1 << random.below(8)));
    }
    refused += complaint(graph, "a.graph", bytes) != "";
  }
  EXPECT_GT(refused, 100);
}

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

std::string ply_header(const std::string& format, const std::string& vertices = "3") {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " + vertices +
         "\nproperty float x\nproperty uchar red\nproperty double z\nproperty float32 y\nelement face "
         "1\nproperty list "
         "uchar int vertex_indices\nend_header\n";
}
std::string ply_binary() {
  std::string bytes = ply_header("binary_little_endian");
  for (const auto& p : kPoints)
    bytes += bytes_of(p.x()) + "r" + bytes_of(static_cast<double>(p.z())) + bytes_of(p.y());
  return bytes;
}
std::string ply_ascii() { return ply_header("ascii") + "1.5 9 0.25 -2\n0 9 -7 0.001\n100 9 4 3\n3 0 1 2\n"; }

TEST_F(RecordedScanTest, ReadsClouds) {
  EXPECT_EQ(cloud(save("a.pcd", pcd_ascii())), kPoints);
  EXPECT_EQ(cloud(save("a.PCD", pcd_binary())), kPoints);
  EXPECT_EQ(cloud(save("a.ply", ply_ascii())), kPoints);
  EXPECT_EQ(cloud(save("a.ply", ply_binary())), kPoints);
  EXPECT_TRUE(cloud(save("a.pcd", pcd_header("binary", "0"))).empty());
  const auto strange =
      cloud(save("a.pcd", "FIELDS x y z\nSIZE 8 1 2\nTYPE F I I\nPOINTS 1\nDATA binary\n" + bytes_of(-1e300) +
                              bytes_of<std::int8_t>(-3) + bytes_of<std::int16_t>(-300)));
  ASSERT_EQ(strange.size(), 1U);
  EXPECT_EQ(strange[0], Eigen::Vector3f(-std::numeric_limits<float>::infinity(), -3.F, -300.F));
  const auto nothing =
      cloud(save("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\nnan nan inf\n"));
  ASSERT_EQ(nothing.size(), 1U);
  EXPECT_TRUE(std::isnan(nothing[0].x()) && std::isinf(nothing[0].z()));
}

TEST_F(RecordedScanTest, RefusesTruncatedClouds) {
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>("a.pcd", pcd_binary()), {"a.ply", ply_binary()}})
    for (std::size_t size = 0; size < bytes.size(); ++size)
      ASSERT_NE(complaint(cloud, name, bytes.substr(0, size)), "") << name << ", " << size << " bytes";
  // Of text that breaks off in the last line nobody can tell.
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>("a.pcd", pcd_ascii()), {"a.ply", ply_ascii()}})
    for (std::size_t size = 0; size < bytes.size(); ++size)
      if (complaint(cloud, name, bytes.substr(0, size)).empty()) {
        ASSERT_EQ(cloud(save(name, bytes.substr(0, size))).size(), kPoints.size()) << size;
      }
}

TEST_F(RecordedScanTest, RefusesBadClouds) {
  const auto bad_pcd = [&](const std::string& header, const std::string& part) {
    expect_refused(cloud, "a.pcd", header, part);
  };
  const std::string xyz = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
  bad_pcd(pcd_header("binary_compressed"),
          "line 11: DATA is 'binary_compressed'; save the cloud as ascii or binary");
  bad_pcd(pcd_header("binary", "999999999999"), "bytes follow");
  bad_pcd(pcd_header("binary", "18446744073709551615"), "more points than can be");
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
  const auto bad_ply = [&](const std::string& bytes, const std::string& part) {
    expect_refused(cloud, "a.ply", bytes, part);
  };
  bad_ply("plx\n", "does not begin with the line 'ply'");
  bad_ply(ply_header("binary_big_endian"), "the format is 'binary_big_endian'");
  bad_ply(ply_header("binary_little_endian", "18446744073709551615"), "bytes follow");
  bad_ply(ply_header("ascii", "x"), "'vertex' has no number");
  bad_ply("ply\nformat ascii 1.0\nelement face 1\n", "line 3: the element 'face' comes before the vertices");
  bad_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\n", "property of type 'list'");
  bad_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\n",
          "line 5: the property 'x' comes twice");
  bad_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "no x, y and z");
  bad_ply("ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 2\n", "second element 'vertex'");
  bad_ply("ply\nformat ascii 1.0\nend_header\n", "no element 'vertex'");
  expect_refused(cloud, "a.xyz", "1 2 3\n", "give a .pcd or .ply file");
}

TEST_F(RecordedScanTest, ReadsPoses) {
  const auto table = poses(save("poses.csv",
                                "file,x,y,z,qx,qy,qz,qw\r\n# a comment\n\n a.pcd , 1, -2.5,3e0, "
                                "0,0,0.70710678,0.70710678\r\nb.ply,0,0,0.5,1.5"));
  ASSERT_EQ(table.size(), 2U);
  EXPECT_EQ(table[0].file, "a.pcd");
  EXPECT_EQ(table[0].line, 4U);
  EXPECT_LT((table[0].T_world_sensor * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, -1.5, 3)).norm(), 1e-7);
  EXPECT_EQ(table[1].file, "b.ply");
  EXPECT_LT((table[1].T_world_sensor * Eigen::Vector3d(2, 0, 0) -
             Eigen::Vector3d(2 * std::cos(1.5), 2 * std::sin(1.5), 0.5))
                .norm(),
            1e-12);
}

TEST_F(RecordedScanTest, RefusesBadPoses) {
  const auto bad = [&](const std::string& bytes, const std::string& part) {
    expect_refused(poses, "poses.csv", bytes, part);
  };
  bad("", "holds no pose");
  bad("file,x,y,z,yaw\n", "holds no pose");
  bad("a.pcd,1,2,3\n", "line 1: has 4 fields");
  bad("a.pcd,1,2,3,0\nb.pcd,1,2,3,0,0\n", "line 2: has 6 fields");
  bad(",1,2,3,0\n", "line 1: names no file");
  bad("a.pcd,1,2,three,0\n", "line 1: 'three' is no finite number");
  bad("a.pcd,1,2,nan,0\n", "line 1: 'nan' is no finite number");
  bad("a.pcd,1,2,inf,0\n", "line 1: 'inf' is no finite number");
  bad("a.pcd,1,2,,0\n", "line 1: '' is no finite number");
  bad("a.pcd,1,2,1e999,0\n", "'1e999' is no finite number");
  bad("file,x,y,z,yaw\nfile,x,y,z,yaw\n", "line 2: 'x' is no finite number");
  bad("a.pcd,1,2,3,0,0,0,0.5\n", "line 1: the quaternion is not of length 1");
  EXPECT_THROW(poses(folder_ / "none.csv"), std::runtime_error);
}

}  // namespace
}  // namespace frontlux::planner
