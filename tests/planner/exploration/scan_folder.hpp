#pragma once

#include "planner/exploration/team_in_world.hpp"
#include "support/command.hpp"

namespace frontlux::test {

/// A folder into which a robot puts its scans, for a program that knows the robot by files only.
class ScanFolder : public FolderTest {
 protected:
  /// @param program  started with the robot's file, the folder, a start and a time to wait
  explicit ScanFolder(std::string program) : program_(std::move(program)) {
    std::filesystem::create_directories(folder_ / "scans");
    write("robot.json", R"({"name": "uav", "motion": "space", "box_m": [0.8, 0.8, 0.8],
              "sensor": {"kind": "camera", "horizontal_deg": 90, "vertical_deg": 72, "range_m": 8,
                         "columns": 60, "rows": 45}})");
  }

  /// In the place of the one that flies.
  void use_ground_robot() {
    write("robot.json",
          R"({"name": "cart", "motion": "plane", "box_m": [0.8, 0.8, 0.6], "mount_height_m": 0.75,
              "ground_m": [0.3, 0.3],
              "sensor": {"kind": "spinning", "vertical_deg": 50, "range_m": 6, "columns": 360, "rows": 32}})");
  }

  [[nodiscard]] pid_t begin(const Pose& start, const std::string& seconds) const {
    std::vector<std::string> all = {program_, path("robot.json"), path("scans")};
    for (const double number : {start.position.x(), start.position.y(), start.position.z(), start.yaw})
      all.push_back(std::to_string(number));
    all.push_back(seconds);
    return test::start(all, folder_);
  }
  void expect_success(int status) const { EXPECT_EQ(exit_code(status), 0) << content_of(folder_ / "err"); }

  /// Writes what a robot measures as a file in the sensor's frame, and where it was.
  void answer(const std::string& name, const planner::Scan& scan, const Pose& at) {
    std::ofstream ply(folder_ / "scans" / name, std::ios::binary);
    ply << "ply\nformat binary_little_endian 1.0\nelement vertex " << scan.ranges.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    const Eigen::AngleAxisf turn(static_cast<float>(-at.yaw), Eigen::Vector3f::UnitZ());
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      const float range = std::isinf(scan.ranges[i]) ? 100.0F : scan.ranges[i];
      const Eigen::Vector3f point = turn * scan.directions[i] * range;
      ply.write(reinterpret_cast<const char*>(point.data()), 3 * sizeof(float));
    }
    ply.close();
    std::ostringstream line;
    line.precision(17);
    line << name << ',' << at.position.x() << ',' << at.position.y() << ',' << at.position.z() << ','
         << at.yaw << '\n';
    table_ += line.str();
    std::ofstream(folder_ / "scans/poses.new") << table_;
    std::filesystem::rename(folder_ / "scans/poses.new", folder_ / "scans/poses.csv");
  }

 private:
  std::string program_;
  std::string table_ = "file,x,y,z,yaw\n";
};

}  // namespace frontlux::test
