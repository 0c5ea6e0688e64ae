#include "bindings.hpp"
#include "scans.hpp"
#include "team.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <filesystem>
#include <mutex>
#include <thread>

namespace frontlux::python {
namespace {

using planner::Drive, planner::Exploration, planner::ExplorationStep, planner::Mapping, planner::Pose;
using StepPointer = std::shared_ptr<ExplorationStep>;

/// An exploration whose steps call Python. What they call must not use the exploration itself, and when it
/// raises, the exploration is over: it keeps what it has mapped until then.
class LockStep {
 public:
  LockStep(Team team, Mapping mapping)
      : team_(std::move(team)), exploration_(team_.options, std::move(mapping)) {}

  [[nodiscard]] const Team& team() const { return team_; }

  /// What `use(exploration)` returns, without Python's lock.
  template <class Use>
  auto use(const Use& use) {
    if (user_ == std::this_thread::get_id())
      throw std::invalid_argument("the exploration is in a step: drive cannot use it");
    const OthersRun others_run;
    const std::lock_guard lock(mutex_);
    return use(exploration_);
  }

  /// Why it is over, in one word and in many; nothing while it goes on.
  [[nodiscard]] std::optional<std::pair<std::string, std::string>> end() {
    return use([this](const Exploration& exploration) -> std::optional<std::pair<std::string, std::string>> {
      if (broken_) return std::pair("interrupted", "drive raised an exception");
      const auto end = exploration.end();
      if (!end) return std::nullopt;
      return std::pair(std::string(name_of(*end)), describe(*end, exploration.options()));
    });
  }

  /// The same for what drives robots: `use(exploration, drive)`.
  template <class Use>
  auto drive(const py::object& function, const Use& work) {
    return use([&](Exploration& exploration) {
      if (broken_)
        throw std::runtime_error(
            "the exploration is unfinished, since drive raised an exception; its map can still be used");
      user_ = std::this_thread::get_id();
      bool driven = false;
      const Drive drive = [&](std::size_t robot, const Pose& viewpoint) {
        driven = true;
        return call(function, robot, viewpoint);
      };
      try {
        auto result = work(exploration, drive);
        user_ = std::thread::id();
        return result;
      } catch (...) {
        broken_ = driven;
        user_ = std::thread::id();
        throw;
      }
    });
  }

 private:
  [[nodiscard]] std::optional<planner::Scan> call(const py::object& function, std::size_t robot,
                                                  const Pose& viewpoint) const {
    const PythonRuns python;
    return rest_if_python_exits([&] { return measure(function, robot, viewpoint); });
  }

  [[nodiscard]] std::optional<planner::Scan> measure(const py::object& function, std::size_t robot,
                                                     const Pose& viewpoint) const {
    const py::tuple arguments = py::make_tuple(robot, to_array(viewpoint));
    PyObject* result = nullptr;
    // Rests before an object of Python's would be released.
    rest_if_python_exits([&] { result = PyObject_Call(function.ptr(), arguments.ptr(), nullptr); });
    if (result == nullptr) throw py::error_already_set();
    const auto answer = py::reinterpret_steal<py::object>(result);
    if (answer.is_none()) return std::nullopt;
    if (!py::isinstance<py::sequence>(answer) || py::len(answer) != 2)
      throw py::type_error("drive: has to return (directions, ranges), or None if the robot could not go");
    const auto scan = py::reinterpret_borrow<py::sequence>(answer);
    const SensorPose pose = sensor_pose("viewpoint", to_array(viewpoint), team_.lattice());
    return scan_of(pose, py::object(scan[0]), py::object(scan[1]), team_.robot(robot).robot.view.max_range);
  }

  Team team_;
  std::mutex mutex_;
  Exploration exploration_;
  std::atomic<std::thread::id> user_{};  // in a step
  bool broken_ = false;
};
using Self = std::shared_ptr<LockStep>;

}  // namespace
}  // namespace frontlux::python

template <>
class pybind11::detail::type_caster<std::shared_ptr<frontlux::python::LockStep>>
    : public SomeObject<frontlux::python::LockStep> {};

namespace frontlux::python {
namespace {

Self make(const std::vector<std::shared_ptr<planner::RobotDescription>>& robots, const py::object& bounds,
          double resolution, const std::string& method, const std::optional<std::string>& goal,
          std::uint64_t seed, std::optional<double> epsilon, std::optional<int> max_steps,
          const std::optional<std::filesystem::path>& known) {
  if (method != "default" && method != "paper")
    throw py::value_error("method: '" + method + "', but has to be 'default' or 'paper'");
  const Team team =
      team_in_lockstep({robots, bounds, resolution, goal, seed, epsilon, max_steps}, method == "paper");
  const OthersRun others_run;
  return std::make_shared<LockStep>(team, mapping_of(team, known));
}

template <class Value>
auto property(Value value) {
  return [value](const Self& self) {
    return self->use([&](const Exploration& exploration) { return value(exploration); });
  };
}

}  // namespace

void bind_exploration(py::module_& module) {
  py::class_<LockStep, Self>(
      module, "Exploration",
      R"(The paper's Alg. 1, step by step: all robots plan, go from viewpoint to viewpoint, and measure at each.

It reaches the world through one function: drive(robot, pose) moves the sensor of robot number `robot` straight to a pose,
float64 (4,), x, y, z [m] and yaw [rad] in the map's frame, and returns what it measures there, a sequence of directions and
ranges as ContinuousExploration.insert takes them; or None if it could not go, and is where it was.

    exploration.begin(starts, drive)
    while exploration.end is None:
        exploration.step(drive)

The same robots and scans give the same steps, on any number of cores. drive must not use the exploration. An exception in it,
or a scan that is refused, ends the exploration: step and begin raise RuntimeError from then on, and the map and all else stay
as they are at that moment. Methods may be called from several threads; they wait for each other.)")
      .def(py::init(&make), py::arg("robots"), py::arg("bounds"), py::arg("resolution") = 0.3,
           py::arg("method") = "default", py::arg("goal") = py::none(), py::arg("seed") = 1,
           py::arg("epsilon") = py::none(), py::arg("max_steps") = py::none(), py::arg("known") = py::none(),
           R"(A team, in the order in which robots choose: those on the ground first.

robots, bounds, resolution, seed, known: as those of ContinuousExploration. method: 'default', what works best; 'paper', as printed.
goal: 'render', the best view quality; 'cluster'; 'nearest'; None: as the method has it. epsilon: steps that expect to see
fewer frontiers end it, three in a row; None: 10, with 'paper' and 'nearest' 1. max_steps: at most; None: 1000.)")
      .def(
          "begin",
          [](const Self& self, const py::object& starts, const py::function& drive, double free_radius) {
            const auto given = starts_of(self->team(), starts, free_radius);
            return self->drive(drive, [&](Exploration& exploration, const Drive& function) {
              return std::make_shared<ExplorationStep>(exploration.begin(given, function));
            });
          },
          py::arg("starts"), py::arg("drive"), py::arg("free_radius") = 0.0,
          "Each robot looks all around at its start. Returns Step 0. starts, free_radius: as those of "
          "ContinuousExploration.begin.")
      .def(
          "step",
          [](const Self& self, const py::function& drive) {
            return self->drive(drive, [&](Exploration& exploration, const Drive& function) {
              return std::make_shared<ExplorationStep>(exploration.step(function));
            });
          },
          py::arg("drive"), "All robots plan, move and measure. Returns a Step.")
      .def(
          "write",
          [](const Self& self, const std::filesystem::path& file) {
            self->use([&](const Exploration& exploration) { exploration.mapping().write(file); });
          },
          py::arg("file"),
          "Writes the map as an OctoMap file: all log-odds to .ot, free and occupied only to .bt.")
      .def_property_readonly(
          "robots", [](const Self& self) { return self->team().robots; }, "As given: list of Robot.")
      .def_property_readonly(
          "poses",
          [](const Self& self) {
            return to_array(self->use([](const Exploration& exploration) {
              return std::vector<Pose>(exploration.poses().begin(), exploration.poses().end());
            }));
          },
          "float64 (r, 4): where the robots' sensors are; empty before begin.")
      .def_property_readonly(
          "end",
          [](const Self& self) -> std::optional<std::string> {
            const auto end = self->end();
            return end ? std::optional(end->first) : std::nullopt;
          },
          "Why it is over: 'low_gain', 'nothing_to_do', 'step_limit' or 'cut_off'; "
          "'interrupted' if drive raised an exception; None while it goes on.")
      .def_property_readonly(
          "end_reason",
          [](const Self& self) -> std::optional<std::string> {
            const auto end = self->end();
            return end ? std::optional(end->second) : std::nullopt;
          },
          "The same in words.")
      .def_property_readonly("grid", property([](const Exploration& exploration) {
                               return std::make_shared<Guarded<VoxelGrid>>(exploration.mapping().grid());
                             }),
                             "VoxelGrid: a snapshot of the map.")
      .def_property_readonly("known_volume", property([](const Exploration& exploration) {
                               return known_volume(exploration.mapping().grid());
                             }),
                             "[m^3] of all free and occupied voxels.")
      .def_property_readonly(
          "frontiers",
          [](const Self& self) {
            return to_array(self->use([](const Exploration& exploration) {
              return std::vector<VoxelKey>(exploration.frontiers().begin(), exploration.frontiers().end());
            }));
          },
          "uint16 (n, 3), sorted: those of the map after the last step.");
}

}  // namespace frontlux::python
