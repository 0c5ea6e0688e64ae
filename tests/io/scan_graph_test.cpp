#include "octomap/quiet_octomap.hpp"
#include "support/input_test.hpp"
#include "support/random.hpp"

#include <frontlux/io/scan_graph.hpp>

#include <octomap/ScanGraph.h>

namespace frontlux::io {
namespace {

using test::bytes_of;
using test::Random;

class ScanGraph : public test::InputTest {
 protected:
  ScanGraph() : InputTest([](const auto& file) { static_cast<void>(read_scan_graph(file)); }) {}
};

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

TEST_F(ScanGraph, ReadsGraphsThatOctomapWrites) {
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

TEST_F(ScanGraph, RefusesDamagedGraphs) {
  const Written written(2);
  for (std::size_t size = 0; size < written.bytes.size(); ++size)
    ASSERT_NE(complaint("a.graph", written.bytes.substr(0, size)), "") << size << " bytes";
  expect_refused("a.graph", written.bytes + "x", "1 bytes follow");
  expect_refused("a.graph", "# Octomap OcTree binary file\n", "more than the remaining");
  expect_refused("a.graph", bytes_of<std::uint32_t>(0xFFFFFFFF) + written.bytes.substr(4),
                 "4294967295 scans");

  // One scan of one point: 4 bytes of scans, 4 of points, 28 of the point, 28 and 36 of the pose, 4 of the
  // id.
  octomap::ScanGraph small;
  auto* points = new octomap::Pointcloud;
  points->push_back(1.F, 2.F, 3.F);
  small.addNode(points, octomap::pose6d(1, 2, 3, 0, 0, 0));
  std::ostringstream stream;
  small.writeBinary(stream);
  const std::string one = stream.str();
  ASSERT_EQ(complaint("a.graph", one), "");
  const auto refuses = [&](std::size_t at, const std::string& by, const std::string& part) {
    expect_refused("a.graph", std::string(one).replace(at, by.size(), by), part);
  };
  refuses(4, bytes_of<std::uint32_t>(1 << 28), "268435456 points");
  refuses(8, bytes_of<std::int32_t>(4), "vector of 4 instead of 3");
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    refuses(40, bytes_of(bad), "pose that is not finite");
  refuses(64, bytes_of<std::int32_t>(-4), "quaternion of -4 instead of 4");
  refuses(68, bytes_of(0.5), "quaternion is not of length 1");
  const auto scans = read_scan_graph(save("a.graph", std::string(one).replace(12, 8, bytes_of(1e300))));
  EXPECT_EQ(scans[0].points[0], Eigen::Vector3f(std::numeric_limits<float>::infinity(), 2.F, 3.F));
  EXPECT_NE(complaint("nothing/a.graph", ""), "");
  EXPECT_THROW(static_cast<void>(read_scan_graph(folder_)), std::runtime_error);
}

TEST_F(ScanGraph, SurvivesFlippedBitsInGraphs) {
  const Written written(3);
  Random random(22);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = written.bytes;
    for (int flips = 1 + random.below(3); flips > 0; --flips) {
      char& byte = bytes[static_cast<std::size_t>(random.below(static_cast<int>(bytes.size())))];
      byte = static_cast<char>(byte ^ (1 << random.below(8)));
    }
    refused += complaint("a.graph", bytes) != "";
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace frontlux::io
