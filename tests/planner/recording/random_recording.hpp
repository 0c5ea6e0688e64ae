#pragma once

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/recording.hpp>

namespace frontlux::test {

inline planner::Pose random_pose(Random& random) {
  return {{random.uniform(-90, 90), random.uniform(-1e-3, 1e3), random.uniform(0, 3)}, random.uniform(-4, 4)};
}

inline planner::RecordingHead random_head(Random& random, int robots) {
  planner::RecordingHead head;
  head.world = "station \"\xC3\xA9\"";
  head.resolution = random.uniform(0.05, 0.5);
  head.bounds = {{100, 0, 32768}, {static_cast<std::uint16_t>(200 + random.below(60000)), 0xFFFF, 32800}};
  head.options = std::string("{\"seed\": 1}\n\0x", 14);
  head.observable = 1'000'000'000'000 + random.bits() % 1000;
  head.bounding = head.observable + random.bits() % 1000;
  for (int i = 0; i < robots; ++i) {
    planner::RobotDescription robot = planner::ugv_description();
    robot.robot.name = "ugv" + std::to_string(i);
    auto& travel = robot.robot.travel;
    if (i % 2 == 1) {
      robot = planner::uav_description();
      travel.metric = planner::PathMetric::kSteps;
      travel.ground_extents = Eigen::Vector2d(random.uniform(0, 1), random.uniform(0, 1));
      travel.require_ground = false;
      travel.node_edge = random.uniform(1, 2);
    }
    if (i % 3 == 2) {
      travel.motion = planner::Motion::kGround;
      travel.step = random.uniform(0.1, 1);
      travel.slope = random.uniform(0, 1);
    }
    travel.margin = random.uniform(0, 1);
    robot.robot.limits = {random.uniform(0.1, 9), random.uniform(0.1, 9), random.uniform(0.1, 9),
                          random.one_in(2)};
    robot.rate = random.uniform(0.1, 99);
    travel.extents = {random.uniform(0, 1), random.uniform(0, 2), random.uniform(0, 1)};
    travel.shape = static_cast<planner::BodyShape>(random.below(3));
    if (travel.shape != planner::BodyShape::kBox) travel.extents.y() = travel.extents.x();
    if (travel.shape == planner::BodyShape::kSphere) travel.extents.z() = travel.extents.x();
    travel.sensor_height = random.uniform(-1, 1);
    travel.ground_reach = random.below(65536);
    for (int box = random.below(3); box > 0; --box)
      travel.without_ground.push_back({random.key_in(head.bounds), random.key_in(head.bounds)});
    travel.floor = random.uniform(-9, 9);
    travel.min_height = random.uniform(-9, 9);
    head.robots.push_back(robot);
    planner::ExplorationStart start{random_pose(random), {}};
    for (int k = random.below(9); k > 0; --k) start.known_free.push_back(random.key_in(kAllVoxels));
    head.starts.push_back(start);
  }
  return head;
}

inline std::vector<planner::VoxelChange> random_changes(Random& random, const KeyBox& box, int count) {
  std::map<VoxelKey, planner::VoxelChange> changes;
  for (int i = 0; i < count; ++i) {
    const VoxelKey key = random.key_in(box);
    const int before = random.below(3), after = (before + 1 + random.below(2)) % 3;
    changes[key] = {key, static_cast<Occupancy>(before), static_cast<Occupancy>(after)};
  }
  std::vector<planner::VoxelChange> list;
  for (const auto& [key, change] : changes) list.push_back(change);
  return list;
}

/// @param size  0: all lists are empty
inline planner::RecordedStep random_step(Random& random, const planner::RecordingHead& head,
                                         std::uint64_t number, int size) {
  planner::RecordedStep recorded;
  auto& step = recorded.step;
  step.number = number;
  step.frontiers = 1000 + random.bits() % 100000;
  step.unassigned = random.bits() % 1000;
  step.abandoned = random.bits() % 1000;
  step.rays = random.bits();
  step.time = random.uniform(0, 1e4);
  recorded.contacts = random.bits() % 3;
  for (double& seconds : step.seconds) seconds = random.uniform(0, 10);
  for (std::size_t r = 0; r < head.robots.size(); ++r) {
    recorded.known.push_back({random.bits() % 100'000, random.bits() % 100'000});
    planner::RobotStep robot;
    robot.gain_tangent = random.bits() % 10000;
    robot.gain_predicted = random.bits() >> random.below(64);
    robot.gain_sum = random.bits() >> random.below(64);
    robot.gained = random.bits() % 10000;
    robot.length = random.uniform(0, 40);
    robot.path = static_cast<planner::PathOutcome>(random.below(7));
    robot.goal.state = static_cast<planner::GoalState>(random.below(7));
    if (robot.goal.state <= planner::GoalState::kUncovered) robot.goal.pose = random_pose(random);
    robot.goal.cell = random.key_in(kAllVoxels);
    robot.goal.reason = "goal " + std::to_string(random.bits());
    robot.goal.distance = random.uniform(0, 50);
    robot.goal.gain = random.uniform(0, 500);
    robot.goal.standard_error = random.uniform(0, 5);
    robot.goal.quality = random.uniform(0, 500);
    robot.goal.assigned = random.bits();
    robot.goal.released = random.bits() % 9;
    robot.goal.received = random.bits() % 9;
    robot.goal.uncovered = random.bits() % 9;
    if (size > 0) {
      for (int i = random.below(12); i > 0; --i) robot.planned.push_back(random_pose(random));
      robot.travelled = random.bits() % (robot.planned.size() + 1);
      robot.changed = random_changes(random, head.bounds, random.below(size));
      for (int i = random.below(size); i > 0; --i) robot.still_unknown.push_back(random.key_in(kAllVoxels));
      if (!robot.still_unknown.empty()) robot.blocked = {robot.still_unknown.front()};
      sort(robot.still_unknown);
      for (int i = random.below(size); i > 0; --i)
        robot.image.push_back({random.key_in(kAllVoxels), random.uniform(0, 9), random.uniform(0, 9),
                               random.uniform(0, 9), random.uniform(0, 9), random.uniform(-4, 4),
                               static_cast<std::uint32_t>(random.bits())});
      for (int i = random.below(5); i > 0; --i)
        robot.tour.push_back({random_pose(random), random.bits() % 9, random.bits() % 1000});
      for (int i = random.below(5); i > 0; --i) robot.trajectory.push_back(random_pose(random));
      for (int i = random.below(size); i > 0; --i) robot.reassigned.push_back(random.key_in(kAllVoxels));
      sort(robot.reassigned);
    }
    step.robots.push_back(robot);
  }
  return recorded;
}

/// Every field as text, numbers to the last bit.
class Listing {
 public:
  Listing() { out_ << std::hexfloat; }
  [[nodiscard]] std::string text() const { return out_.str(); }

  void add(const planner::RecordingHead& head) {
    line("world", head.world, head.resolution, head.observable, head.bounding, head.options);
    add(head.bounds);
    for (const auto& description : head.robots) add(description);
    for (const auto& start : head.starts) {
      add(start.pose);
      for (const VoxelKey& key : start.known_free) add(key);
    }
  }

  void add(const planner::RobotDescription& description) {
    const auto& [robot, columns, rows, rate] = description;
    const auto& t = robot.travel;
    line("robot", robot.name, columns, rows, static_cast<int>(robot.view.shape), robot.view.horizontal,
         robot.view.vertical, robot.view.max_range, rate);
    line("limits", robot.limits.speed, robot.limits.acceleration, robot.limits.yaw_rate,
         robot.limits.per_axis);
    line("travel", static_cast<int>(t.motion), static_cast<int>(t.shape), t.extents.x(), t.extents.y(),
         t.extents.z(), t.margin, static_cast<int>(t.metric), t.sensor_height, t.require_ground,
         t.ground_extents.has_value());
    if (t.ground_extents) line("ground", t.ground_extents->x(), t.ground_extents->y());
    line(t.ground_reach, t.floor, t.min_height, t.node_edge, t.without_ground.size(), t.step, t.slope);
    for (const KeyBox& box : t.without_ground) add(box);
  }

  void add(const planner::Goal& g) {
    line("goal", static_cast<int>(g.state), g.reason, g.distance, g.gain, g.standard_error, g.quality,
         g.assigned, g.released, g.received, g.uncovered, g.pose.has_value());
    if (g.pose) add(*g.pose);
    add(g.cell);
  }

  void add(const planner::RecordedStep& recorded) {
    line("contacts", recorded.contacts);
    for (const double seconds : recorded.step.seconds) line("s", seconds);
    for (const auto& known : recorded.known) line("known", known.observable, known.bounding);
    add(recorded.step);
  }

  /// All but the times that it took.
  void add(const planner::ExplorationStep& s) {
    line("step", s.number, s.time, s.frontiers, s.unassigned, s.abandoned, s.rays);
    for (const auto& r : s.robots) {
      add(r.goal);
      line("path", static_cast<int>(r.path), r.gain_tangent, r.gain_predicted, r.gain_sum, r.travelled,
           r.length, r.gained);
      for (const auto& pose : r.planned) add(pose);
      for (const auto& c : r.changed) {
        add(c.key);
        line(static_cast<int>(c.before), static_cast<int>(c.after));
      }
      line("still_unknown", r.still_unknown.size());
      for (const auto& key : r.still_unknown) add(key);
      line("blocked", r.blocked.size());
      for (const auto& key : r.blocked) add(key);
      for (const auto& c : r.image) {
        add(c.cell);
        line("image", c.distance, c.gain, c.standard_error, c.quality, c.yaw, c.hits);
      }
      for (const auto& stop : r.tour) {
        add(stop.pose);
        line("stop", stop.clusters, stop.frontiers);
      }
      line("trajectory", r.trajectory.size());
      for (const auto& pose : r.trajectory) add(pose);
      line("reassigned", r.reassigned.size());
      for (const auto& key : r.reassigned) add(key);
    }
  }

 private:
  void add(const planner::Pose& pose) {
    line("pose", pose.position.x(), pose.position.y(), pose.position.z(), pose.yaw);
  }
  void add(const VoxelKey& key) { line("key", key.x, key.y, key.z); }
  void add(const KeyBox& box) {
    add(box.min);
    add(box.max);
  }
  template <class... Values>
  void line(const Values&... values) {
    ((out_ << values << ' '), ...) << '\n';
  }

  std::ostringstream out_;
};

template <class Recorded>
std::string listed(const Recorded& recorded) {
  Listing listing;
  listing.add(recorded);
  return listing.text();
}

/// The first lines in which two listings differ.
inline std::string first_difference(const std::string& a, const std::string& b) {
  std::istringstream in_a(a), in_b(b);
  std::string line_a, line_b;
  while (std::getline(in_a, line_a) && std::getline(in_b, line_b))
    if (line_a != line_b) return line_a + "\nis not\n" + line_b;
  return "one is shorter";
}

}  // namespace frontlux::test
