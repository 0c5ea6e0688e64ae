#include "parsing.hpp"
#include "rigid_pose.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/scan_graph.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace frontlux::io {
namespace {

constexpr const char* kAskForAnotherCopy =
    "the file is damaged or no binary scan graph: get another copy of it";

class GraphReader {
 public:
  GraphReader(const std::filesystem::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  std::vector<RecordedScan> read() {
    const auto nodes = take_count("scans", kMinNodeBytes);
    std::vector<RecordedScan> scans;
    scans.reserve(nodes);
    for (std::size_t i = 0; i < nodes; ++i) scans.push_back(take_node());
    const auto edges = take_count("edges", kEdgeBytes);
    for (std::size_t i = 0; i < edges; ++i) {
      take<std::uint32_t>();  // the ids of the two scans
      take<std::uint32_t>();
      take_pose();
      take<double>();  // weight
    }
    if (at_ != bytes_.size())
      fail_here("ends here, but " + std::to_string(bytes_.size() - at_) + " bytes follow");
    return scans;
  }

 private:
  // OctoMap writes vectors and quaternions as their size and then doubles.
  static constexpr std::size_t kVectorBytes = 4 + 3 * 8, kPoseBytes = kVectorBytes + 4 + 4 * 8;
  static constexpr std::size_t kMinNodeBytes = 4 + kPoseBytes + 4, kEdgeBytes = 4 + 4 + kPoseBytes + 8;

  [[noreturn]] void fail_here(const std::string& what) const {
    fail(file_, what + " (byte " + std::to_string(at_) + ")", kAskForAnotherCopy);
  }

  template <class Number>
  Number take() {
    if (bytes_.size() - at_ < sizeof(Number)) fail_here("ends in the middle of a number");
    const auto number = from_bytes<Number>(bytes_.data() + at_, std::endian::little);
    at_ += sizeof(Number);
    return number;
  }

  // A number of things of which each takes at least so many bytes.
  std::size_t take_count(const std::string& things, std::size_t bytes_each) {
    const std::size_t count = take<std::uint32_t>();
    if (count > (bytes_.size() - at_) / bytes_each)
      fail_here("announces " + std::to_string(count) + " " + things + ", more than the remaining " +
                std::to_string(bytes_.size() - at_) + " bytes can hold");
    return count;
  }

  void take_size(std::int32_t expected, const char* of) {
    const auto size = take<std::int32_t>();
    if (size != expected)
      fail_here("has a " + std::string(of) + " of " + std::to_string(size) + " instead of " +
                std::to_string(expected) + " numbers");
  }

  Eigen::Vector3d take_vector() {
    take_size(3, "vector");
    const auto x = take<double>(), y = take<double>(), z = take<double>();
    return {x, y, z};
  }

  SensorFrame take_pose() {
    const Eigen::Vector3d position = take_vector();
    take_size(4, "quaternion");
    const auto w = take<double>(), x = take<double>(), y = take<double>(), z = take<double>();
    const auto pose = rigid_pose(position, Eigen::Quaterniond(w, x, y, z));
    if (!pose) fail_here("has a pose that is not finite or whose quaternion is not of length 1");
    return *pose;
  }

  RecordedScan take_node() {
    RecordedScan scan;
    const auto points = take_count("points", kVectorBytes);
    scan.points.reserve(points);
    for (std::size_t i = 0; i < points; ++i) {
      const Eigen::Vector3d p = take_vector();
      scan.points.emplace_back(p.unaryExpr(&to_float));
    }
    scan.T_world_sensor = take_pose();
    take<std::uint32_t>();  // id
    return scan;
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<Eigen::Vector3f> points_in_world(const RecordedScan& scan) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(scan.points.size());
  for (const Eigen::Vector3f& point : scan.points)
    points.emplace_back((scan.T_world_sensor * point.cast<double>()).unaryExpr(&to_float));
  return points;
}

std::vector<RecordedScan> read_scan_graph(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  return GraphReader(file, bytes).read();
}

}  // namespace frontlux::io
