#include "sensing/keyed_random.hpp"

#include <frontlux/planner/segment_voxels.hpp>
#include <frontlux/planner/travel_corridor.hpp>
#include <frontlux/sim/moving_robots.hpp>
#include <frontlux/sim/swept_body.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::sim {
namespace {

using planner::Pose;

constexpr double kTick = 0.02;  // [s] bodies move straight in between
// [s] Of a robot that sways, along x, y and z, so that it does not go to and fro on one line.
constexpr std::array<double, 3> kSwayPeriods = {4.1, 5.3, 6.7};

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("moving robots: " + what); }

// The voxels that a sensor enters on a straight motion, but for that which it begins in.
std::vector<VoxelKey> cells_ahead(const Lattice& lattice, const Eigen::Vector3d& from,
                                  const Eigen::Vector3d& to) {
  const Eigen::Vector3d beyond = from + (to - from).normalized() * lattice.resolution();
  std::vector<VoxelKey> cells;
  static_cast<void>(planner::SegmentVoxels(lattice, from, beyond).all_of([&](const VoxelKey& key) {
    if (key != lattice.key(from)) cells.push_back(key);
    return true;
  }));
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace

MovingRobots::MovingRobots(const World& world, const GroundTruth& truth,
                           std::vector<planner::RobotDescription> robots, std::span<const Pose> starts,
                           const RangeErrors& errors, std::uint64_t seed, AtContact at_contact,
                           const PoseErrors& pose_errors)
    : truth_(&truth),
      surface_(world.mesh),
      solids_(world.mesh),
      robots_(std::move(robots)),
      records_(robots_.size()),
      seed_(seed),
      at_contact_(at_contact),
      pose_errors_(pose_errors) {
  if (!(pose_errors.drift >= 0.0 && pose_errors.drift <= 1.0))
    refuse("the drift is " + std::to_string(pose_errors.drift) +
           " of the path length, but has to lie between 0 and 1");
  if (!(pose_errors.fix_every >= 0.0 && std::isfinite(pose_errors.fix_every)))
    refuse("robots know their places every " + std::to_string(pose_errors.fix_every) +
           " s, but the time has to be finite and at least 0");
  if (!(pose_errors.tracking >= 0.0 && pose_errors.tracking <= PoseErrors::kMostTracking))
    refuse("the tracking error is " + std::to_string(pose_errors.tracking) +
           " m, but has to lie between 0 and 10");
  if (starts.size() != robots_.size())
    refuse(std::to_string(starts.size()) + " starts for " + std::to_string(robots_.size()) + " robots");
  for (std::size_t r = 0; r < robots_.size(); ++r) {
    constexpr double kLeastRate = 0.01;  // [Hz]
    if (!(std::isfinite(robots_[r].rate) && robots_[r].rate >= kLeastRate))
      refuse("robot '" + robots_[r].robot.name + "' takes " + std::to_string(robots_[r].rate) +
             " scans a second, but it has to be a number of at least 0.01");
    sensors_.push_back(sensor_of(robots_[r], errors));
    progress_.push_back({.pose = starts[r], .believed = starts[r], .path = PathRevisits(starts[r].position)});
    draw_direction(r);
    draw_phases(r);
    measure_clearance(r);
  }
  measure_separation();
}

double MovingRobots::next_time() const {
  double next = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < robots_.size(); ++r)
    next = std::min(next, static_cast<double>(progress_[r].scans) / robots_[r].rate);
  return next;
}

// The box around the body, smaller by a margin on all sides, so that it may touch.
Eigen::AlignedBox3d MovingRobots::body(std::size_t robot, const Eigen::Vector3d& at) const {
  const Eigen::AlignedBox3d box = planner::body_of(robots_[robot].robot.travel).translated(at);
  const Eigen::Vector3d margin = (box.sizes() / 4).cwiseMin(GroundTruth::kMargin);
  return {box.min() + margin, box.max() - margin};
}

void MovingRobots::draw_direction(std::size_t robot) {
  constexpr std::uint64_t kDirections = 0x506F7365;  // a stream apart from that of the sensors
  Progress& now = progress_[robot];
  SplitMix64 random = random_of(random_of(seed_ + kDirections, robot).bits(), now.fixes);
  const bool level = robots_[robot].robot.travel.drives();
  const double azimuth = 2 * std::numbers::pi * random.unit(), z = level ? 0.0 : 2 * random.unit() - 1;
  now.direction = {std::sqrt(1 - z * z) * std::cos(azimuth), std::sqrt(1 - z * z) * std::sin(azimuth), z};
}

void MovingRobots::draw_phases(std::size_t robot) {
  constexpr std::uint64_t kPhases = 0x53776179;  // a stream apart from the others
  SplitMix64 random = random_of(seed_ + kPhases, robot);
  for (double& phase : progress_[robot].phases) phase = 2 * std::numbers::pi * random.unit();
}

// How far a robot is from where it believes to be [m]. What it has learnt of is gone after a second.
Eigen::Vector3d MovingRobots::error(std::size_t robot, double time) const {
  const Progress& now = progress_[robot];
  const double since = time - now.fixed_at;
  return pose_errors_.drift * now.since_fix * now.direction + std::max(0.0, 1.0 - since) * now.known_error;
}

// Where a robot that should be somewhere believes to be.
Pose MovingRobots::swayed(std::size_t robot, const planner::MotionState& to, double time) const {
  Pose pose = to.pose;
  if (pose_errors_.tracking == 0.0) return pose;
  const planner::Robot& of = robots_[robot].robot;
  const Eigen::Index axes = of.travel.drives() ? 2 : 3;
  const double part = std::min(1.0, to.velocity.norm() / of.limits.speed);
  for (Eigen::Index axis = 0; axis < axes; ++axis) {
    const double angle = 2 * std::numbers::pi * time / kSwayPeriods[static_cast<std::size_t>(axis)] +
                         progress_[robot].phases[axis];
    pose.position[axis] +=
        pose_errors_.tracking * part * std::sin(angle) / std::sqrt(static_cast<double>(axes));
  }
  return pose;
}

// It does not get back to where it believed to be, and knows it.
void MovingRobots::forget_known_error(Progress& progress) const {
  if (progress.known_error.isZero(0.0)) return;
  progress.believed.position =
      progress.pose.position - pose_errors_.drift * progress.since_fix * progress.direction;
  progress.known_error.setZero();
}

void MovingRobots::set_active(std::size_t robot, bool active) {
  progress_[robot].active = active;
  if (!active) forget_known_error(progress_[robot]);
}

// @param time  when it gets there
void MovingRobots::move(std::size_t robot, const planner::MotionState& to, double time,
                        std::vector<Stopped>& stopped) {
  Progress& now = progress_[robot];
  MotionRecord& record = records_[robot];
  const double seconds = time - time_;
  const double every = pose_errors_.fix_every;
  if (every > 0.0 && time >= static_cast<double>(now.fixes + 1) * every) {
    now.known_error = error(robot, time);
    now.since_fix = 0.0;
    // Of several that were due while it was held back it learns of the last one, and now.
    constexpr double kMost = 1e18;  // that fit into the number
    now.fixes = std::max(now.fixes + 1, static_cast<std::uint64_t>(std::min(time / every, kMost)));
    now.fixed_at = std::max(static_cast<double>(now.fixes) * every, time_);
    draw_direction(robot);
  }
  const Pose believed = swayed(robot, to, time);
  const double step = (believed.position - now.believed.position).norm();
  now.since_fix += step;
  const Eigen::Vector3d at = believed.position + error(robot, time);
  const Eigen::Vector3d from = now.pose.position, motion = at - from;
  const SweptBody swept(robots_[robot].robot.travel.planned_shape(), body(robot, from), motion);
  const bool contact = !motion.isZero(0.0) && solids_.count(swept) > 0;
  if (contact && at_contact_ == AtContact::kStay) {
    now.since_fix -= step;
    Eigen::Vector3d ahead = believed.position - now.believed.position;
    if (!now.known_error.isZero(0.0)) ahead = motion;
    forget_known_error(now);
    ++record.held_back;
    record.idle += seconds;
    now.halted = true;
    const Eigen::Vector3d& here = now.believed.position;
    stopped.push_back({robot, time_, now.believed, cells_ahead(truth_->lattice(), here, here + ahead)});
    return;
  }
  if (contact && !now.touching) record.contacts.push_back({time, swept.bounds()});
  if (!motion.isZero(0.0)) now.touching = contact;
  record.length += motion.norm();
  now.path.go_to(at);
  record.revisited = now.path.share();
  if (motion.isZero(0.0) && to.pose.yaw == now.pose.yaw) record.idle += seconds;
  now.pose = {at, to.pose.yaw};
  now.believed = believed;
  if (!motion.isZero(0.0)) measure_clearance(robot);
}

void MovingRobots::measure_clearance(std::size_t robot) {
  constexpr int kHalvings = 12;
  double& clearance = records_[robot].clearance;
  const Eigen::Vector3d& at = progress_[robot].pose.position;
  const planner::TravelOptions& travel = robots_[robot].robot.travel;
  const bool stands = travel.drives();  // and touches the floor
  Eigen::AlignedBox3d box = planner::body_of(travel).translated(at);
  if (stands) {
    box.min().z() = body(robot, at).min().z();
    box.max().z() = body(robot, at).max().z();
  }
  const auto touches = [&](double by) {
    const Eigen::Vector3d around = by * Eigen::Vector3d(1.0, 1.0, stands ? 0.0 : 1.0);
    const Eigen::AlignedBox3d grown(box.min() - around, box.max() + around);
    return solids_.count(SweptBody(travel.planned_shape(), grown, Eigen::Vector3d::Zero())) > 0;
  };
  if (!touches(clearance)) return;
  double low = 0.0, high = clearance;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (touches(middle) ? high : low) = middle;
  }
  clearance = low;
}

void MovingRobots::measure_separation() {
  for (std::size_t a = 0; a < progress_.size(); ++a)
    for (std::size_t b = a + 1; b < progress_.size(); ++b) {
      const auto box = [&](std::size_t r) {
        return planner::body_of(robots_[r].robot.travel).translated(progress_[r].pose.position);
      };
      separation_ = std::min(separation_, box(a).exteriorDistance(box(b)));
    }
}

void MovingRobots::move_until(double until, const Where& where, std::vector<Stopped>& stopped) {
  const double begin = time_;
  const auto ticks = static_cast<std::int64_t>(std::ceil((until - begin) / kTick));
  for (Progress& robot : progress_) robot.halted = false;
  for (std::int64_t i = 1; i <= ticks; ++i) {
    const double time = begin + (until - begin) * static_cast<double>(i) / static_cast<double>(ticks);
    for (std::size_t r = 0; r < robots_.size(); ++r)
      if (progress_[r].halted || !progress_[r].active)
        records_[r].idle += time - time_;
      else
        move(r, where(r, time), time, stopped);
    measure_separation();
    time_ = time;
  }
}

MovingRobots::Sensed MovingRobots::advance(const Where& where, std::vector<Stopped>& stopped) {
  const double next = next_time();
  move_until(next, where, stopped);
  std::size_t robot = 0;
  while (static_cast<double>(progress_[robot].scans) / robots_[robot].rate != next) ++robot;
  Progress& now = progress_[robot];
  const std::uint64_t errors = random_of(random_of(seed_, robot).bits(), now.scans++).bits();
  planner::Scan scan = sense(surface_, sensors_[robot], now.pose, errors);
  if (now.pose.position != now.believed.position) scan.origin = now.believed.position.cast<float>();
  return {next, robot, now.believed, std::move(scan)};
}

}  // namespace frontlux::sim
