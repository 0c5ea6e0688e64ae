#include "bindings.hpp"
#include "motion_arrays.hpp"
#include "scans.hpp"
#include "team.hpp"

#include <frontlux/planner/continuous_exploration.hpp>
#include <frontlux/planner/exploration_start.hpp>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <filesystem>
#include <set>

namespace frontlux::python {
namespace {

using planner::ContinuousExploration, planner::ExplorationStep, planner::Mapping, planner::PlannedMotion;

struct Continuous {
  Team team;
  ContinuousExploration exploration;
  bool begun = false;
  double begin_time = 0.0;
  double time = 0.0;  // [s] the last that was given
  std::set<std::size_t> lost{};
  std::size_t frontiers = 0;  // at the last planning

  Continuous(Team given, Mapping mapping)
      : team(std::move(given)), exploration(team.options, std::move(mapping)) {}

  void expect_begun() const {
    if (!begun) throw std::invalid_argument("the exploration has not begun: call begin first");
  }

  /// The clock does not go back.
  void pass(double now) {
    constexpr double kLatest = 1e10;  // [s] beyond that doubles are too coarse
    if (!(std::abs(now) <= kLatest))
      throw std::invalid_argument("time: " + std::to_string(now) + " s, but has to be within 1e10 s of 0");
    if (begun && now < time)
      throw std::invalid_argument("time: " + std::to_string(now) + " s, but it was " + std::to_string(time) +
                                  " s already");
    time = now;
  }
};
using Self = Held<Continuous>;
using StepPointer = std::shared_ptr<ExplorationStep>;

using PlanPointer = std::shared_ptr<Plan>;

Self make(const std::vector<std::shared_ptr<planner::RobotDescription>>& robots, const py::object& bounds,
          double resolution, const std::string& goal, std::uint64_t seed, double latency, double period,
          std::optional<double> epsilon, std::optional<int> max_steps, const std::string& sensor_model,
          const std::optional<std::filesystem::path>& known) {
  const Team team = team_in_motion({robots, bounds, resolution, goal, seed, epsilon, max_steps, sensor_model},
                                   latency, period);
  const OthersRun others_run;
  return std::make_shared<Guarded<Continuous>>(team, mapping_of(team, known));
}

StepPointer begin(const Self& self, const py::object& object, double time, double free_radius) {
  const Team team = self->use([](const Continuous& state) { return state.team; });
  const auto starts = starts_of(team, object, free_radius);
  return self->use([&](Continuous& state) {
    if (state.begun) throw std::invalid_argument("the exploration has begun already");
    state.pass(time);
    auto step = std::make_shared<ExplorationStep>(state.exploration.begin(starts, time));
    state.begun = true;
    state.begin_time = time;
    return step;
  });
}

// Calls use(state, description) of a robot.
template <class Use>
auto with_robot(const Self& self, std::size_t robot, const Use& use) {
  return self->use([&](Continuous& state) {
    const planner::RobotDescription& description = state.team.robot(robot);
    state.expect_begun();
    return use(state, description);
  });
}

// What make_scan(pose, max_range) returns goes in.
template <class MakeScan>
std::shared_ptr<Change> insert(const Self& self, std::size_t robot, const py::object& pose_object,
                               const MakeScan& make_scan) {
  const auto [lattice, max_range] =
      with_robot(self, robot, [](const Continuous& state, const planner::RobotDescription& description) {
        return std::pair(state.team.lattice(), description.robot.view.max_range);
      });
  const SensorPose pose = sensor_pose("pose", pose_object, lattice);
  const planner::Scan scan = make_scan(pose, max_range);
  return self->use([&](Continuous& state) {
    return std::make_shared<Change>(state.exploration.insert(robot, pose.upright, scan));
  });
}

// Tells of a robot that it rests at a pose.
template <class Tell>
void at_rest(const Self& self, std::size_t robot, const py::object& pose_object, double time,
             const Tell& tell) {
  const Lattice lattice = with_robot(
      self, robot, [](const Continuous& state, const auto& /*robot*/) { return state.team.lattice(); });
  const SensorPose pose = sensor_pose("pose", pose_object, lattice);
  self->use([&](Continuous& state) {
    state.pass(time);
    tell(state, pose.upright);
  });
}

void stopped(const Self& self, std::size_t robot, const py::object& pose, double time,
             const py::object& blocked) {
  std::optional<Keys> cells;
  if (!blocked.is_none()) cells.emplace("blocked", blocked);
  at_rest(self, robot, pose, time, [&](Continuous& state, const planner::Pose& rests) {
    state.exploration.stopped(robot, rests, time, cells ? cells->span() : std::span<const VoxelKey>());
  });
}

void displaced(const Self& self, std::size_t robot, const py::object& pose, double time) {
  at_rest(self, robot, pose, time, [&](Continuous& state, const planner::Pose& rests) {
    state.exploration.displaced(robot, rests, time);
  });
}

void lose(const Self& self, std::size_t robot, const py::object& pose, double time) {
  at_rest(self, robot, pose, time, [&](Continuous& state, const planner::Pose& rests) {
    state.exploration.lose(robot, rests, time);
    state.lost.insert(robot);
  });
}

void join(const Self& self, std::size_t robot, const py::object& pose, double time, double free_radius) {
  at_rest(self, robot, pose, time, [&](Continuous& state, const planner::Pose& rests) {
    const planner::Robot& travels = state.team.options.team[robot].robot;
    state.exploration.join(robot, start_at(state.team.lattice(), travels, rests, free_radius), time);
    state.lost.erase(robot);
  });
}

PlanPointer plan(const Self& self, double time) {
  return self->use([&](Continuous& state) {
    state.expect_begun();
    state.pass(time);
    auto planned = state.exploration.plan(time);
    if (!planned) return PlanPointer();
    state.frontiers = planned->step.frontiers;
    return std::make_shared<Plan>(Plan{planned->robot, std::string(name_of(planned->reason)),
                                       std::make_shared<planner::Trajectory>(std::move(planned->trajectory)),
                                       std::make_shared<ExplorationStep>(std::move(planned->step))});
  });
}

// A property that `value(state)` is.
template <class Value>
auto property(Value value) {
  return
      [value](const Self& self) { return self->use([&](const Continuous& state) { return value(state); }); };
}

void bind_plan(py::module_& module) {
  py::class_<Plan, PlanPointer>(module, "Plan",
                                "One robot's planning, and what all robots have done since the one before.")
      .def("__repr__",
           [](const PlanPointer& self) {
             return py::str("<frontlux.planner.Plan of robot {}: {}, {:.2f} to {:.2f} s>")
                 .format(self->robot, self->reason, self->trajectory->begin(), self->trajectory->end());
           })
      .def_property_readonly(
          "robot", [](const PlanPointer& self) { return self->robot; },
          "Who planned: its number in the team.")
      .def_property_readonly(
          "reason", [](const PlanPointer& self) { return self->reason; },
          "Why: 'start', 'arrival', 'goal_seen', 'blocked', 'stopped' or 'period'.")
      .def_property_readonly(
          "trajectory", [](const PlanPointer& self) { return self->trajectory; },
          "To be followed from its begin on; until then, the one before.")
      .def_property_readonly(
          "step", [](const PlanPointer& self) { return self->step; },
          "The Step since the planning before. Of its goals that of the robot that planned is new, and it "
          "has a "
          "tour if it chose that anew.");
}

}  // namespace

void bind_continuous_exploration(py::module_& module) {
  bind_plan(module);
  py::class_<Guarded<Continuous>, Self>(
      module, "ContinuousExploration",
      R"(Robots that explore without stops: scans go in when they are taken, trajectories come out.

Nothing in here waits, reads a clock or starts a thread of its own. Each robot plans for itself: when it has looked from its goal,
when what it was going for has been mapped, when it is blocked, and at least every `period`. Robots know each other's plans.
The same robots, scans and times give the same trajectories, on any number of cores.

    exploration.begin(starts, time)
    while exploration.end is None:
        exploration.insert(robot, pose, directions, ranges)     # as scans come
        while exploration.end is None and (plan := exploration.plan(time)):
            send(plan.robot, plan.trajectory)

Poses are those of sensors in the map's frame: x, y, z [m] and yaw [rad], shape (4,). Times are in seconds on any clock that
does not go back. Methods may be called from several threads; they wait for each other, and let other threads run.)")
      .def(py::init(&make), py::arg("robots"), py::arg("bounds"), py::arg("resolution") = 0.3,
           py::arg("goal") = "tour", py::arg("seed") = 1, py::arg("latency") = 0.1, py::arg("period") = 1.0,
           py::arg("epsilon") = py::none(), py::arg("max_steps") = py::none(),
           py::arg("sensor_model") = "octomap", py::arg("known") = py::none(),
           R"(A team, in the order in which robots choose: those on the ground first.

robots: list of Robot. bounds: (2, 3) [m], lower and upper corner of what is explored, bottom included; memory grows with it.
resolution: [m] edge of a voxel. goal: 'tour', through clusters of frontiers for all robots together; 'render', the best view
quality; 'cluster'; 'nearest'. seed: of all that is random. latency: [s] from a planning to its trajectory's begin.
period: [s] after which a robot plans anew at the latest. epsilon: frontiers that a stop of a
tour shows at least; without tours, that a goal has to show, else the end is near. None: 10, with 'nearest' 1, with 'tour' not
less than 0.3 m2 nor more than 0.9 m2 of them. max_steps: plannings at most; None: any number.
sensor_model: what a scan says of a voxel: 'octomap', its own weights; 'cautious', a ray that ends in it outweighs five scans
that pass it: fewer walls are freed at grazing angles, but stray returns close more of the space.
known: an OctoMap file of this resolution with what is known already, as write makes it; None: nothing is.)")
      .def("begin", &begin, py::arg("starts"), py::arg("time") = 0.0, py::arg("free_radius") = 0.0,
           R"(All robots rest at their starts. Returns Step 0.

starts: (r, 4), x, y, z [m] and yaw [rad] of each sensor. free_radius: [m] around each start, at the heights of a ground
robot's body, all is taken as free, beside the voxels of the body. A ground robot needs some 2 m: its sensor does not see the
floor on which it stands.)")
      .def(
          "insert",
          [](const Self& self, std::size_t robot, const py::object& pose, const py::object& directions,
             const py::object& ranges) {
            return insert(self, robot, pose, [&](const SensorPose& at, double max_range) {
              return scan_of(at, directions, ranges, max_range);
            });
          },
          py::arg("robot"), py::arg("pose"), py::arg("directions"), py::arg("ranges"),
          R"(A scan that a robot took, as directions and ranges. Returns a MapChange.

robot: number in the team. pose: (4,), or (4, 4), which maps the sensor's frame into the map's. directions: float32 or float64
(..., 3), of unit length, in the sensor's frame: x forward, y left, z up. Of an optical frame, z forward, turn directions and pose
first (docs/python.md), or the robot's yaw is wrong. ranges: (...) [m], one for each. Infinity, or more than the sensor's max_range:
nothing was met up to max_range, and all is free up to there. NaN: not measured.)")
      .def(
          "insert_points",
          [](const Self& self, std::size_t robot, const py::object& pose, const py::object& points) {
            return insert(self, robot, pose, [&](const SensorPose& at, double max_range) {
              return scan_of(at, points, max_range);
            });
          },
          py::arg("robot"), py::arg("pose"), py::arg("points"),
          R"(The same for a scan of points (..., 3) [m] in the sensor's frame: x forward, y left, z up, not an optical frame.

Points beyond the sensor's max_range stand for rays that met nothing. Those that are not finite, or the sensor's own position,
were not measured.)")
      .def("plan", &plan, py::arg("time"),
           R"(Plans for the robot whose turn it is, and returns a Plan; None if none has a reason to plan.

Call it until it returns None, after all scans of that moment. First come robots that have waited for four periods, that are
blocked or were stopped, and that have waited for two; else the team's order counts.)")
      .def("stopped", &stopped, py::arg("robot"), py::arg("pose"), py::arg("time"),
           py::arg("blocked") = py::none(),
           R"(A robot rests at a pose since it could not go on: something that no sensor saw blocks its path.

blocked: uint16 (..., 3), cells that it could not enter; None: the one that it is in will not be entered again.)")
      .def("displaced", &displaced, py::arg("robot"), py::arg("pose"), py::arg("time"),
           R"(A robot rests at a pose that is not the one of its trajectory, and nothing blocks its path.

Its controller lagged behind, it was halted, or its localization has jumped: the poses of scans tell the planner nothing of
that. It plans anew from there.)")
      .def("lose", &lose, py::arg("robot"), py::arg("pose"), py::arg("time"),
           "A robot takes no more part, since it has failed or nobody hears of it any more. It rests at a "
           "pose, "
           "where the others keep apart from it, and what it was to see becomes theirs, unless it joins them "
           "again.")
      .def(
          "join", &join, py::arg("robot"), py::arg("pose"), py::arg("time"), py::arg("free_radius") = 0.0,
          R"(A robot that was lost takes part again, from where it rests. Cells that were closed by `stopped` are open to it.

One that comes later is in the team from the begin on, and lost before the first planning. `end` does not wait for it, nor does
`run`; when it has joined, the exploration goes on. free_radius: as that of `begin`.)")
      .def(
          "finish",
          [](const Self& self, double time) {
            return self->use([&](Continuous& state) {
              state.expect_begun();
              state.pass(time);
              auto step = std::make_shared<ExplorationStep>(state.exploration.finish(time));
              state.frontiers = step->frontiers;
              return step;
            });
          },
          py::arg("time"),
          "A Step of what the robots have done since the last planning, when nobody will plan any more.")
      .def(
          "at",
          [](const Self& self, std::size_t robot, const py::object& times) {
            return motion_arrays(times, [&](const auto& fill) {
              with_robot(self, robot, [&](const Continuous& state, const auto& /*robot*/) {
                fill([&](double time) { return state.exploration.at(robot, time); });
              });
            });
          },
          py::arg("robot"), py::arg("times"),
          "Where a robot is by its trajectories at some times [s], as Trajectory.at.")
      .def(
          "write",
          [](const Self& self, const std::filesystem::path& file) {
            self->use([&](const Continuous& state) { state.exploration.mapping().write(file); });
          },
          py::arg("file"),
          "Writes the map as an OctoMap file: all log-odds to .ot, free and occupied only to .bt.")
      .def_property_readonly("robots", property([](const Continuous& state) { return state.team.robots; }),
                             "As given: list of Robot.")
      .def_property_readonly("lost", property([](const Continuous& state) {
                               return std::vector<std::size_t>(state.lost.begin(), state.lost.end());
                             }),
                             "Numbers of the robots that take no part now, sorted: list of int.")
      .def_property_readonly("begin_time", property([](const Continuous& state) {
                               return state.begun ? std::optional(state.begin_time) : std::nullopt;
                             }),
                             "[s] That was given to begin; None before.")
      .def_property_readonly("period",
                             property([](const Continuous& state) { return state.team.options.period; }),
                             "[s] After which a robot plans anew at the latest.")
      .def_property_readonly("time", property([](const Continuous& state) { return state.time; }),
                             "[s] The latest time that was given.")
      .def_property_readonly(
          "end", property([](const Continuous& state) -> std::optional<std::string> {
            const auto end = state.exploration.end();
            return end ? std::optional(std::string(name_of(*end))) : std::nullopt;
          }),
          "Why it is over: 'nothing_to_do', 'low_gain', 'step_limit' or 'cut_off'; None while it goes on.")
      .def_property_readonly("end_reason",
                             property([](const Continuous& state) -> std::optional<std::string> {
                               const auto end = state.exploration.end();
                               if (!end) return std::nullopt;
                               return describe(*end, state.exploration.options(), "plannings");
                             }),
                             "The same in words.")
      .def_property_readonly(
          "grid", property([](const Continuous& state) {
            return std::make_shared<Guarded<VoxelGrid>>(state.exploration.mapping().grid());
          }),
          "VoxelGrid: a snapshot of the map.")
      .def_property_readonly("known_volume", property([](const Continuous& state) {
                               return known_volume(state.exploration.mapping().grid());
                             }),
                             "[m^3] of all free and occupied voxels.")
      .def_property_readonly("frontiers", property([](const Continuous& state) { return state.frontiers; }),
                             "How many the map had at the last planning.");
}

}  // namespace frontlux::python
