#include "explore/continuous_loop.hpp"

#include "explore/csv_row.hpp"
#include "interrupt.hpp"

#include <frontlux/stopwatch.hpp>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

namespace frontlux::app {
namespace {

using planner::ExplorationStep, planner::Pose;

constexpr double kLongestStop = 2.0;  // [s] for the end of a step, when the run is to stop

std::vector<Pose> start_poses(const ExploreSetup& setup) {
  std::vector<Pose> poses;
  for (const planner::ExplorationStart& start : setup.head.starts) poses.push_back(start.pose);
  return poses;
}

// All but the times that it took.
bool same_step(const ExplorationStep& a, const ExplorationStep& b) {
  if (a.number != b.number || a.time != b.time || a.robots.size() != b.robots.size()) return false;
  for (std::size_t r = 0; r < a.robots.size(); ++r)
    if (a.robots[r].changed != b.robots[r].changed || a.robots[r].length != b.robots[r].length) return false;
  return true;
}

}  // namespace

ContinuousLoop::ContinuousLoop(const ExploreSetup& setup)
    : setup_(setup),
      robots_(setup.sourced.world, *setup.truth, setup.head.robots, start_poses(setup), setup.errors,
              setup.exploration.seed, setup.at_contact, setup.pose_errors),
      scans_(setup.message_errors, setup.exploration.seed),
      exploration_(setup.exploration, planner::Mapping({.resolution = setup.head.resolution,
                                                        .bounds = setup.head.bounds,
                                                        .sensor_model = setup.sensor_model})),
      known_(setup.head.resolution),
      judged_(setup.head.robots.size()) {
  numbers_.mapped.emplace_back();
  numbers_.robots.resize(setup.head.robots.size());
  numbers_.contacts_in_free = 0;
}

ExplorationStep ContinuousLoop::step() { return go_on(nullptr); }

bool ContinuousLoop::repeat(const ExplorationStep& recorded) { return same_step(go_on(&recorded), recorded); }

ExplorationStep ContinuousLoop::go_on(const ExplorationStep* recorded) {
  if (!begun_) {
    begun_ = true;
    ExplorationStep first = exploration_.begin(setup_.head.starts, 0.0);
    Mapped mapped;
    for (const planner::ExplorationStart& start : setup_.head.starts)
      count({exploration_.mapping().grid(), start.known_free}, mapped);
    note_numbers(mapped);
    note_end();  // with a limit of no plannings
    return first;
  }
  // Of a step that is lost nothing is told: that would be of another moment than the recording.
  const std::size_t moments = numbers_.mapped.size();
  std::vector<Mapped> mapped = std::move(numbers_.mapped);
  RunNumbers before = numbers_;
  numbers_.mapped = std::move(mapped);
  try {
    return plan_or_finish(recorded);
  } catch (const Interrupted&) {
    before.mapped = std::move(numbers_.mapped);
    before.mapped.resize(moments);
    numbers_ = std::move(before);
    throw;
  }
}

ExplorationStep ContinuousLoop::plan_or_finish(const ExplorationStep* recorded) {
  std::optional<Stopwatch> waiting;  // since somebody wants the run to stop
  for (;;) {
    if (InterruptNote::taken()) {
      if (!waiting) waiting.emplace();
      if (waiting->seconds() > kLongestStop) throw Interrupted();
    }
    if (note_attendance()) note_end();
    if (end_) return exploration_.finish(time_);
    // All scans of one moment come before the plannings.
    if (robots_.next_time() > time_)
      if (auto planned = exploration_.plan(time_)) {
        ++plannings_;
        note_plan(*planned, recorded != nullptr ? *recorded : planned->step);
        note_end();
        return std::move(planned->step);
      }
    move_and_sense();
    if (auto limit = limit_reached(setup_, numbers_.mapped.back())) {
      end_ = std::move(limit);
      return exploration_.finish(time_);
    }
  }
}

// While a robot is to come, the others do not end the run.
void ContinuousLoop::note_end() {
  auto end = exploration_.end();
  const auto is_to_come = [this](const Attendance& robot) { return robot.joins && *robot.joins > time_; };
  if (end && std::ranges::any_of(setup_.attendance, is_to_come)) {
    end.reset();
    if (plannings_ >= exploration_.options().max_steps) end = planner::ExplorationEnd::kStepLimit;
  }
  if (end)
    end_ = {std::string(planner::name_of(*end)),
            planner::describe(*end, exploration_.options(), "plannings")};
}

// Robots that take no part stay where they are.
// @return whether any has begun or ceased to take part
bool ContinuousLoop::note_attendance() {
  bool any = false;
  for (std::size_t r = 0; r < numbers_.robots.size(); ++r) {
    RobotNumbers& robot = numbers_.robots[r];
    const Attendance& attendance = setup_.attendance[r];
    const bool takes_part = attendance.at(time_);
    if (takes_part == robot.takes_part) continue;
    if (takes_part) {
      robots_.set_active(r, true);
      exploration_.join(r, {robots_.believed(r), {}}, time_);
      robot.joined = time_;
    } else {
      robots_.set_active(r, false);
      exploration_.lose(r, robots_.believed(r), time_);
      if (attendance.fails && *attendance.fails <= time_) robot.failed = time_;
    }
    robot.takes_part = takes_part;
    any = true;
  }
  return any;
}

// [s] That of the next scan, or before it of something that waits for none.
double ContinuousLoop::next_moment() const {
  constexpr double kRounding = 1e-9;
  double moment = robots_.next_time();
  const auto at_latest = [&](double time) {
    if (time > time_ + kRounding && time < moment - kRounding) moment = time;
  };
  at_latest(time_ + exploration_.options().period / 4);  // robots plan when a period is over
  if (const auto arrival = scans_.next_arrival()) at_latest(*arrival);
  if (setup_.stop_time) at_latest(*setup_.stop_time);
  for (const Attendance& robot : setup_.attendance)
    for (const std::optional<double>& time : {robot.fails, robot.joins})
      if (time) at_latest(*time);
  return moment;
}

void ContinuousLoop::move_and_sense() {
  std::vector<sim::MovingRobots::Stopped> stopped;
  const double moment = next_moment();
  const auto where = [this](std::size_t robot, double time) { return exploration_.at(robot, time); };
  std::optional<sim::MovingRobots::Sensed> sensed;
  if (moment < robots_.next_time())
    robots_.move_until(moment, where, stopped);
  else
    sensed = robots_.advance(where, stopped);
  time_ = moment;
  note_motion(stopped);
  judge_contacts();
  for (const auto& robot : stopped) exploration_.stopped(robot.robot, robot.pose, time_, robot.blocked);
  if (sensed && numbers_.robots[sensed->robot].takes_part) scans_.send(std::move(*sensed));
  Mapped mapped = numbers_.mapped.back();
  for (const auto& [taken, robot, pose, scan] : scans_.arrived(time_))
    count(exploration_.insert(robot, pose, scan), mapped);
  note_numbers(mapped);
}

// New ones, by the map that the robots had at the time.
void ContinuousLoop::judge_contacts() {
  const VoxelGrid& map = exploration_.mapping().grid();
  for (std::size_t r = 0; r < judged_.size(); ++r) {
    const std::vector<sim::Contact>& contacts = robots_.records()[r].contacts;
    for (; judged_[r] < contacts.size(); ++judged_[r]) {
      const Eigen::AlignedBox3d& body = contacts[judged_[r]].body;
      const auto low = map.lattice().key(Eigen::Vector3d(body.min())),
                 high = map.lattice().key(Eigen::Vector3d(body.max()));
      const auto is_free = [&](const VoxelKey& key) { return map.at(key) == Occupancy::kFree; };
      ++numbers_.contacts;
      if (low && high && all_of({*low, *high}, is_free)) ++*numbers_.contacts_in_free;
    }
  }
}

void ContinuousLoop::count(const MapChange& change, Mapped& mapped) {
  for (const VoxelKey& key : change.keys) {
    const Occupancy is = change.grid.at(key);
    if (is == Occupancy::kUnknown || known_.at(key) != Occupancy::kUnknown) continue;
    known_.set(key, is);
    ++mapped.bounding;
    mapped.observable += setup_.truth->contains(key) ? 1 : 0;
  }
}

// What is mapped now, and what the robots have done until now.
void ContinuousLoop::note_numbers(Mapped mapped) {
  mapped.time = time_;
  mapped.length = 0.0;
  double clearance = 1.0;
  for (std::size_t r = 0; r < robots_.records().size(); ++r) {
    const sim::MotionRecord& record = robots_.records()[r];
    RobotNumbers& robot = numbers_.robots[r];
    robot.length = record.length;
    robot.revisited = record.revisited;
    robot.idle = record.idle;
    robot.held_back = record.held_back;
    mapped.length += record.length;
    clearance = std::min(clearance, record.clearance);
  }
  numbers_.clearance = clearance;
  if (robots_.records().size() > 1) numbers_.separation = robots_.separation();
  numbers_.mapped.push_back(mapped);
}

// A hundred rows a second for each robot, up to now. The exploration has yet to learn who was stopped.
void ContinuousLoop::note_motion(std::span<const sim::MovingRobots::Stopped> stopped) {
  constexpr double kRate = 100.0;
  for (; static_cast<double>(samples_) / kRate <= time_; ++samples_) {
    const double time = static_cast<double>(samples_) / kRate;
    for (std::size_t r = 0; r < numbers_.robots.size(); ++r) {
      const auto stop = std::ranges::find(stopped, r, &sim::MovingRobots::Stopped::robot);
      const bool rests = stop != stopped.end() && time > stop->time;
      const planner::MotionState state =
          rests ? planner::MotionState{.pose = stop->pose} : exploration_.at(r, time);
      const Eigen::Vector3d &p = state.pose.position, &v = state.velocity;
      rows_.motion += csv_row(time, setup_.head.robots[r].robot.name, p.x(), p.y(), p.z(), state.pose.yaw,
                              v.x(), v.y(), v.z(), state.yaw_rate);
    }
  }
}

void ContinuousLoop::note_plan(const planner::PlannedMotion& planned, const ExplorationStep& measured) {
  const planner::RobotStep& robot = planned.step.robots[planned.robot];
  const std::string& name = setup_.head.robots[planned.robot].robot.name;
  numbers_.robots[planned.robot].goal = robot.goal.reason;
  rows_.events +=
      csv_row(planned.step.time, planned.step.number, name, planner::name_of(planned.reason),
              planner::name_of(robot.goal.state), robot.gain_predicted, planned.trajectory.begin(),
              planned.trajectory.end(), planned.trajectory.length(), measured.planning_seconds());
  for (std::size_t s = 0; s < robot.tour.size(); ++s) {
    const planner::PlannedStop& stop = robot.tour[s];
    const Eigen::Vector3d& p = stop.pose.position;
    rows_.tours += csv_row(planned.step.time, planned.step.number, name, s + 1, p.x(), p.y(), p.z(),
                           stop.pose.yaw, stop.clusters, stop.frontiers);
  }
}

}  // namespace frontlux::app
