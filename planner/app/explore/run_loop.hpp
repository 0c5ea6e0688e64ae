#pragma once

#include "setup/explore_setup.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/mapping.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::app {

/// Why a run is over.
struct RunEnd {
  std::string word;  ///< in files: "low_gain", ...
  std::string text;  ///< for people
};

/// How much is mapped at a moment.
struct Mapped {
  double time = 0.0;                           ///< [s]
  std::uint64_t observable = 0, bounding = 0;  ///< voxels
  double length = 0.0;                         ///< [m] travelled by all robots
};

/// What one robot did, up to now.
struct RobotNumbers {
  double length = 0.0;                ///< [m]
  double revisited = 0.0;             ///< the part of that, 0 to 1, which led to where it had been
  double idle = 0.0;                  ///< [s] at rest without turning
  std::uint64_t held_back = 0;        ///< times that its bumper stopped it
  bool takes_part = true;             ///< now
  std::optional<double> failed = {};  ///< [s] when it did
  std::optional<double> joined = {};  ///< [s] the others: later than they began, or again
  std::string goal = {};              ///< why it had the goal that it was given last, or none
};

/// What a run comes to in seconds and metres, up to now.
struct RunNumbers {
  std::vector<Mapped> mapped;  ///< whenever it became more, by time
  std::vector<RobotNumbers> robots;
  std::uint64_t contacts = 0;  ///< of bodies with surfaces
  /// Those where the map had all voxels around the body as free: the surface is in some that beams have
  /// passed.
  std::optional<std::uint64_t> contacts_in_free;
  std::optional<double> clearance, separation;  ///< [m] if measured, and of more than one robot
};

/// A part of a whole, 0 to 1; 0 of nothing.
[[nodiscard]] double fraction(std::uint64_t part, std::uint64_t whole);

/// [s] when this part of the observable voxels was mapped; nothing if it was not.
[[nodiscard]] std::optional<double> time_to(const RunNumbers& numbers, std::uint64_t observable, double part);

/// The mapped part of the observable voxels, 0 to 1, on average over the run's time.
[[nodiscard]] double mean_coverage(const RunNumbers& numbers, std::uint64_t observable);

/// Rows of the tables that only runs in motion have, named after their files.
struct MotionRows {
  std::string events, motion, tours;
};

/// A simulated team and the exploration that moves it, step by step.
class RunLoop {
 public:
  virtual ~RunLoop() = default;

  /// The next step, from step 0 on. @pre there is no `end` yet
  /// @throws Interrupted if an interrupt is noted and the step has long not ended; so does `repeat`. The step
  /// is lost then, and there is no next one
  [[nodiscard]] virtual planner::ExplorationStep step() = 0;
  /// Takes a recorded step again, so that the next ones are as then.
  /// @return false if the robots did not map what they mapped then
  [[nodiscard]] virtual bool repeat(const planner::ExplorationStep& recorded) = 0;
  [[nodiscard]] virtual std::optional<RunEnd> end() const = 0;
  [[nodiscard]] virtual const planner::Mapping& mapping() const = 0;
  [[nodiscard]] virtual const RunNumbers& numbers() const = 0;
  /// The rows since the last call; empty in lock-step.
  [[nodiscard]] virtual MotionRows take_rows() { return {}; }
};

/// Whether the run has come to what its user wants it to end at.
[[nodiscard]] std::optional<RunEnd> limit_reached(const ExploreSetup& setup, const Mapped& mapped);

/// @param setup  lives as long as the loop
[[nodiscard]] std::unique_ptr<RunLoop> make_run_loop(const ExploreSetup& setup);

}  // namespace frontlux::app
