#include "recording/recording_head.hpp"

#include "recording/recording_parts.hpp"

#include <stdexcept>
#include <type_traits>

namespace frontlux::planner::detail {
namespace {

constexpr std::size_t kMostRays = 100'000'000;  // in a scan
constexpr int kMostReach = 0xFFFF;              // [voxels]

template <class Bytes, class Box>
void code_box(Bytes& bytes, Box& box) {
  bytes.key(box.min);
  bytes.key(box.max);
}

template <class Bytes, class View>
void code_view(Bytes& bytes, View& view) {
  bytes.choice(view.shape, 3, "shape of view");
  bytes.number(view.horizontal);
  bytes.number(view.vertical);
  bytes.number(view.max_range);
  bool good = std::isfinite(view.horizontal) && std::isfinite(view.vertical);
  try {
    view.check();
  } catch (const std::invalid_argument&) {
    good = false;
  }
  bytes.require(good, "the field of view is out of bounds");
}

template <class Bytes, class Travel>
void code_travel(Bytes& bytes, Travel& travel) {
  bytes.choice(travel.motion, 2, "motion");
  for (int axis = 0; axis < 3; ++axis)
    code_length(bytes, travel.extents[axis], "an extent of the collision box is no length");
  bytes.choice(travel.metric, 2, "path metric");
  code_finite(bytes, travel.sensor_height, "the sensor's height is not finite");
  bytes.flag(travel.require_ground);
  bytes.maybe(travel.ground_extents, [&](auto& extents) {
    for (int axis = 0; axis < 2; ++axis) code_length(bytes, extents[axis], "a ground extent is no length");
  });
  bytes.small(travel.ground_reach, kMostReach, "ground reach");
  bytes.length(travel.without_ground, 2 * kKeyBytes);
  for (auto& box : travel.without_ground) code_box(bytes, box);
  code_finite(bytes, travel.floor, "the floor's height is not finite");
  code_finite(bytes, travel.min_height, "the least height is not finite");
  code_length(bytes, travel.node_edge, "the edge of the nodes is no length");
}

template <class Bytes, class Description>
void code_robot(Bytes& bytes, Description& description) {
  bytes.text(description.robot.name);
  code_travel(bytes, description.robot.travel);
  code_view(bytes, description.robot.view);
  bytes.count(description.columns);
  bytes.count(description.rows);
  bytes.require(description.columns > 0 && description.rows > 0 && description.columns <= kMostRays &&
                    description.rows <= kMostRays / description.columns,
                "a scan has no rays, or more than 100 million");
}

template <class Bytes, class Head>
void code_head(Bytes& bytes, Head& head) {
  constexpr std::size_t kRobotBytes = 90, kStartBytes = 33;  // at least

  bytes.text(head.world);
  bytes.number(head.resolution);
  bool good = true;
  try {
    static_cast<void>(Lattice(head.resolution));
  } catch (const std::invalid_argument&) {
    good = false;
  }
  bytes.require(good, "the resolution is no edge of a voxel");
  code_box(bytes, head.bounds);
  bytes.require(head.bounds.contains(head.bounds.min) && head.bounds.contains(head.bounds.max),
                "the bounds are empty");
  bytes.count(head.observable);
  bytes.count(head.bounding);
  bytes.require(head.observable == 0 || head.bounding == 0 || head.observable <= head.bounding,
                "more voxels can be known than the bounds hold");
  bytes.text(head.options);
  bytes.length(head.robots, kRobotBytes);
  for (std::size_t i = 0; i < head.robots.size(); ++i) {
    bytes.part("robot " + std::to_string(i));
    code_robot(bytes, head.robots[i]);
  }
  bytes.part("starts");
  bytes.length(head.starts, kStartBytes);
  bytes.require(head.starts.size() == head.robots.size(), "there is not one for each robot");
  for (auto& start : head.starts) {
    code_pose(bytes, start.pose);
    code_keys(bytes, start.known_free);
  }
}

}  // namespace

std::string head_bytes(const RecordingHead& head) {
  RecordWriter writer;
  code_head(writer, head);
  return writer.bytes();
}

RecordingHead head_from(std::string_view bytes) {
  RecordReader reader(bytes);
  RecordingHead head;
  code_head(reader, head);
  reader.end();
  return head;
}

}  // namespace frontlux::planner::detail
