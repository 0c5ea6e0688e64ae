#include "support/input_test.hpp"

#include <frontlux/io/pose_file.hpp>

namespace frontlux::io {
namespace {

class PoseFile : public test::InputTest {
 protected:
  PoseFile() : InputTest([](const auto& file) { static_cast<void>(read_pose_file(file)); }) {}
};

TEST_F(PoseFile, ReadsPoses) {
  const auto table = read_pose_file(save("poses.csv",
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

// As spreadsheets write them.
TEST_F(PoseFile, TakesAByteOrderMarkAtTheBegin) {
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string names : {"", "file,x,y,z,yaw\n"}) {
    const auto table = read_pose_file(save("poses.csv", mark + names + "a.pcd,1,2,3,0\n"));
    ASSERT_EQ(table.size(), 1U);
    EXPECT_EQ(table[0].file, "a.pcd");
  }
  for (const std::string names : {"", "x,y,z,yaw\n"})
    EXPECT_EQ(read_pose_list(save("list.csv", mark + names + "1,2,3,0\n")).at(0).pose.position,
              Eigen::Vector3d(1, 2, 3));
  expect_refused("poses.csv", "a.pcd,1,2,3,0\n" + mark + "b.pcd,1,2,3,zero\n", "line 2: 'zero'");
}

// As spreadsheets write them.
TEST_F(PoseFile, TakesFieldsInQuotes) {
  const auto table = read_pose_file(
      save("poses.csv", "\"file\",\"x\",\"y\",\"z\",\"yaw\"\n \"a, \"\"b\"\".pcd\" ,\"1\",2,3,\"0\"\n"));
  ASSERT_EQ(table.size(), 1U);
  EXPECT_EQ(table[0].file, "a, \"b\".pcd");
  EXPECT_EQ(table[0].T_world_sensor.translation(), Eigen::Vector3d(1, 2, 3));
  for (const std::string row : {"\"a.pcd,1,2,3,0\n", "\"a\".pcd,1,2,3,0\n", "a.pcd,1,2,3,\"0\n"})
    expect_refused("poses.csv", row, "line 1: has a quote that does not end where a field does");
}

TEST_F(PoseFile, RefusesBadPoses) {
  const auto bad = [&](const std::string& bytes, const std::string& part) {
    expect_refused("poses.csv", bytes, part);
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
  bad("file,x,y,z,qw,qx,qy,qz\na.pcd,1,2,3,1,0,0,0\n", "line 1: names other columns, or in another order");
  bad("file,x,y,yaw,z\na.pcd,1,2,0,3\n", "line 1: names other columns");
  bad("a.pcd,1,2,3,0,0,0,0.5\n", "line 1: the quaternion is not of length 1");
  EXPECT_THROW(static_cast<void>(read_pose_file(folder_ / "none.csv")), std::runtime_error);
}

TEST_F(PoseFile, ReadsListsOfPoses) {
  const auto list = read_pose_list(save("poses.csv", "x,y,z,yaw\n# a comment\n1, -2.5,3e0,+0.5\r\n"));
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].line, 3U);
  EXPECT_EQ(list[0].pose.position, Eigen::Vector3d(1, -2.5, 3));
  EXPECT_EQ(list[0].pose.yaw, 0.5);
  read_ = [](const auto& file) { static_cast<void>(read_pose_list(file)); };
  expect_refused("poses.csv", "x,y,z,yaw\n", "holds no pose; write x,y,z,yaw");
  expect_refused("poses.csv", "x,y,yaw,z\n1,2,0,3\n", "line 1: names other columns");
  expect_refused("poses.csv", "1,2,3,4\n1,2,3\n", "line 2: has 3 fields instead of 4");
  expect_refused("poses.csv", "1,2,3,inf\n", "line 1: 'inf' is no finite number");
  expect_refused("poses.csv", "1,2,3,90\n", "line 1: has a yaw of 90, more than a turn");
}

}  // namespace
}  // namespace frontlux::io
