#include "octomap/quiet_octomap.hpp"
#include "support/command_test.hpp"
#include "support/random.hpp"

#include <frontlux/io/scan_graph.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/planner/mapping.hpp>

#include <octomap/ScanGraph.h>

#include <variant>

namespace frontlux::planner {
namespace {

using test::content_of;

using octomap::OcTree;

class MapCommandTest : public test::CommandTest {
 protected:
  MapCommandTest() : CommandTest("map") {
    std::filesystem::create_directory(folder_ / "clouds");
    test::Random random(31);
    std::ofstream poses(path("clouds/poses.csv"));
    poses << "file,x,y,z,yaw\n";
    for (int node = 0; node < 3; ++node) {
      auto* cloud = new octomap::Pointcloud;  // the graph deletes it
      std::ostringstream text;
      text.precision(9);
      for (int i = 0; i < 300; ++i) {
        const auto along = [&] { return static_cast<float>(random.uniform(-4, 4)); };
        cloud->push_back(along(), along(), along());
        text << cloud->back().x() << ' ' << cloud->back().y() << ' ' << cloud->back().z() << '\n';
      }
      const float x = 0.5F * static_cast<float>(node) + 0.013F;
      graph_.addNode(cloud, octomap::pose6d(x, 0.21F, 1.07F, 0, 0, 0));
      const std::string name = node == 1 ? "b.ply" : node == 0 ? "a.pcd" : "c.pcd";
      std::ofstream(path("clouds/" + name))
          << (node == 1
                  ? "ply\nformat ascii 1.0\nelement vertex 300\nproperty float x\nproperty float y\nproperty "
                    "float z\nend_header\n"
                  : "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 300\nHEIGHT 1\nDATA ascii\n")
          << text.str();
      poses.precision(9);
      poses << name << ',' << x << ',' << 0.21F << ',' << 1.07F << ",0\n";
    }
    std::ofstream stream(path("scans.graph"), std::ios::binary);
    graph_.writeBinary(stream);
  }

  octomap::ScanGraph graph_;
};

std::shared_ptr<OcTree> tree_in(const std::string& file) {
  return std::get<std::shared_ptr<OcTree>>(read_octree(file));
}

TEST_F(MapCommandTest, MapsAGraphAsOctomapDoes) {
  const auto expect_map = [&](const std::vector<std::string>& words, OcTree expected) {
    expect_answer(
        test::joined({path("scans.graph"), "-o", path("map.ot"), "--resolution", "0.2", "--max-range", "3.5"},
                     words),
        {"scans        3\npoints       900\n"});
    for (const auto& scan : io::read_scan_graph(path("scans.graph"))) {
      octomap::Pointcloud cloud;
      for (const auto& p : io::points_in_world(scan)) cloud.push_back(p.x(), p.y(), p.z());
      const Eigen::Vector3f at = scan.T_world_sensor.translation().cast<float>();
      expected.insertPointCloud(cloud, {at.x(), at.y(), at.z()}, 3.5);
    }
    EXPECT_TRUE(*tree_in(path("map.ot")) == expected);
  };
  expect_map({}, OcTree(0.2));
  OcTree cautious(0.2);
  cautious.setProbMiss(kCautiousSensorModel.miss);
  cautious.setClampingThresMin(kCautiousSensorModel.least);
  expect_map({"--sensor-model", "cautious"}, cautious);
}

TEST_F(MapCommandTest, AFolderGivesTheMapOfTheGraph) {
  expect_answer({path("scans.graph"), "-o", path("graph.ot"), "--bounds", "-2,-2,0,3,2,2.5"});
  expect_answer({path("clouds"), "-o", path("folder.ot"), "--bounds=-2,-2,0,3,2,2.5"});
  EXPECT_EQ(content_of(path("folder.ot")), content_of(path("graph.ot")));
  const auto known = make_voxel_grid(*tree_in(path("folder.ot"))).known_bounds();
  ASSERT_TRUE(known.has_value());
  const KeyBox bounds = voxels_of(Lattice(0.1), {Eigen::Vector3d(-2, -2, 0), Eigen::Vector3d(3, 2, 2.5)});
  EXPECT_TRUE(bounds.contains(known->min) && bounds.contains(known->max));

  std::filesystem::rename(path("clouds/poses.csv"), path("elsewhere.csv"));
  expect_answer({path("clouds"), "--poses", path("elsewhere.csv"), "-o", path("folder.bt")});
  EXPECT_GT(tree_in(path("folder.bt"))->size(), 100U);
}

TEST_F(MapCommandTest, TellsOfCloudsAndPointsThatItLeavesOut) {
  // A folder that its poses fit to is mapped without a word.
  const std::string whole =
      expect_answer({path("clouds"), "-o", path("whole.bt")}, {"points       900\nfree "});
  const std::string begin = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 4\nHEIGHT 1\nDATA ascii\n";
  write("clouds/more.PCD", begin + "1 0 0\nnan 0 0\n9 0 0\n0 8 0\n");
  write("clouds/other.ply", "not read");
  std::ofstream(path("clouds/poses.csv"), std::ios::app) << "more.PCD,0,0,1,0\n./a.pcd,0,0,1,0\n";
  const test::Answer answer = run({path("clouds"), "-o", path("map.bt"), "--max-range", "7.5"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(answer.err, "frontlux: warning: " + path("clouds/poses.csv") +
                            ": clouds of the folder without a line are left out: 1, the first is other.ply; "
                            "clouds with several lines are mapped with each: 1, the first is a.pcd\n");
  test::expect_parts(answer.out, {"points       1204\n", "beyond       2 of them beyond 7.5 m",
                                  "left out     1 of them, which are not finite\n"});
}

TEST_F(MapCommandTest, RefusesACloudWithManyLines) {
  std::ofstream poses(path("clouds/poses.csv"), std::ios::app);
  std::filesystem::create_symlink(path("clouds/a.pcd"), path("clouds/link.pcd"));
  for (int i = 0; i < 3; ++i) poses << "./a.pcd,0,0,1,0\n../clouds/a.pcd,0,0,1,0\nlink.pcd,0,0,1,0\n";
  poses.close();
  EXPECT_EQ(run({path("clouds"), "-o", path("map.bt")}).code, 0);
  std::ofstream(path("clouds/poses.csv"), std::ios::app) << "a.pcd,0,0,1,0\n";
  expect_refused({path("clouds"), "-o", path("more.bt")}, "'a.pcd' has more than 10 lines");
}

TEST_F(MapCommandTest, TellsOfPointsThatNoMapHolds) {
  const std::string begin = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n";
  std::filesystem::create_directory(path("far"));
  write("far/poses.csv", "far.pcd,0,0,1,0\n");
  write("far/far.pcd", begin + "1 0 0\n4000 0 0\n");
  const std::vector<std::string> words{path("far"), "-o", path("far.bt")};
  expect_refused(words, path("far/far.pcd") +
                            ": a point is 4000 m from the sensor, more than 5000 voxels; check its unit");
  const test::Answer answer = run(test::joined(words, {"--max-range", "5"}));
  EXPECT_EQ(answer.code, 0);
  test::expect_parts(answer.out, {"left out     1 of them, which lie beyond the map's key range\n"});
  write("far/far.pcd", begin + "nan 0 0\nnan 0 0\n");
  expect_refused(words, ": its 2 points make no voxel known; they have to be there, in metres");
}

// A file of 40 kB, in scans of 40 rays each, whose map would take gigabytes.
TEST_F(MapCommandTest, RefusesRaysThatSpreadOutTooFarForTheirNumber) {
  const std::string begin = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 40\nHEIGHT 1\nDATA ascii\n";
  std::filesystem::create_directory(path("far"));
  std::string poses;
  test::Random random(1);
  for (int scan = 0; scan < 30; ++scan) {
    std::ostringstream cloud;
    cloud << begin;
    for (int i = 0; i < 40; ++i) cloud << (490 * random.point(-1, 1).normalized()).transpose() << '\n';
    const std::string name = std::to_string(scan) + ".pcd";
    write("far/" + name, cloud.str());
    poses += name + ",0,0,0,0\n";
  }
  write("far/poses.csv", poses);
  const std::vector<std::string> words{path("far"), "-o", path("far.bt")};
  expect_refused(words, "rays spread out too far for their number");
  EXPECT_EQ(run(test::joined(words, {"--max-range", "20"})).code, 0);
  EXPECT_EQ(run(test::joined(words, {"--bounds", "-10,-10,-10,10,10,10"})).code, 0);
}

// Three bytes a point: a file of 100 kB, whose rays go through 260,000 cubes of eight voxels.
TEST_F(MapCommandTest, RefusesManyRaysOfASmallFile) {
  std::filesystem::create_directory(path("far"));
  std::string cloud =
      "ply\nformat binary_little_endian 1.0\nelement vertex 33000\nproperty uchar x\nproperty uchar y\n"
      "property uchar z\nend_header\n";
  test::Random random(2);
  for (int i = 0; i < 3 * 33'000; ++i) cloud += static_cast<char>(random.below(256));
  write("far/far.ply", cloud);
  write("far/poses.csv", "far.ply,-128,-128,-128,0\n");
  expect_refused({path("far"), "-o", path("far.bt"), "--resolution", "0.5"},
                 "rays spread out too far for their number");
}

TEST_F(MapCommandTest, RefusesBadInputAndWritesNothing) {
  const std::string graph = path("scans.graph"), map = path("new.bt");
  expect_refused({path("none.graph"), "-o", map}, "no such file");
  expect_refused({path("clouds/b.ply"), "-o", map}, "b.ply is a single cloud; name the folder");
  expect_refused({write("old.bt", "# Octomap OcTree binary file\n"), "-o", map}, "old.bt is a map");
  expect_refused({graph}, "--output");
  expect_refused({graph, "-o", path("map.pcd")}, "does not end in .bt or .ot");
  expect_refused({graph, "-o", path("no/map.bt")}, "there is no folder");
  expect_refused({graph, "-o", map, "--resolution", "0"},
                 "--resolution: '0' is not a number from 0.001 to 1000");
  expect_refused({graph, "-o", map, "--resolution", "nan"}, "--resolution: 'nan' is not a number from");
  expect_refused({graph, "-o", map, "--resolution", "1e-300"}, "--resolution: '1e-300' is not a number from");
  expect_refused({graph, "-o", map, "--max-range", "-3"}, "--max-range");
  expect_refused({graph, "-o", map, "--bounds", "0,0,0,1,1"}, "is not six finite numbers");
  expect_refused({graph, "-o", map, "--bounds", "0,0,0,1,1,-1"}, "--bounds: the box");
  expect_refused({graph, "-o", map, "--bounds", "90,90,90,91,91,91"},
                 "make no voxel within the bounds known");
  expect_refused({graph, "-o", map, "--poses", path("clouds/poses.csv")}, "has its own poses");
  const auto with_poses = [&](const std::string& table) {
    return std::vector<std::string>{path("clouds"), "-o", map, "--poses", write("bad.csv", table)};
  };
  expect_refused(with_poses("a.pcd,0,0,0,0\nb.ply,0,zero,0,0\n"),
                 path("bad.csv") + ": line 2: 'zero' is no finite number");
  expect_refused(with_poses("a.pcd,0,0,0,0\nd.ply,0,0,0,0\n"), "d.ply: there is no such file");
  expect_refused(with_poses("a.pcd,9e9,0,0,0\n"), "a.pcd: its pose lies outside the map's key range");
  std::filesystem::resize_file(graph, std::filesystem::file_size(graph) - 1);
  expect_refused({graph, "-o", map}, "scans.graph: ");
  expect_refused({path(""), "-o", map}, "poses.csv: there is no such file");
}

}  // namespace
}  // namespace frontlux::planner
