#pragma once

#include <frontlux/planner/recording.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>

#include <span>
#include <string>
#include <vector>

namespace frontlux::app {

/// A run's map and paths at a moment, which only goes on. The recording has to outlive it.
class RunMap {
 public:
  /// At the end of step 0. @pre the recording has a step
  explicit RunMap(const planner::Recording& recording);

  /// The moment of the last step's end: [s] on the clock, or the step's number if pictures count steps.
  [[nodiscard]] double end() const;
  /// To a moment: the map at the end of the step before, and the robots on their paths in the step that goes
  /// on.
  void go_to(double moment);
  [[nodiscard]] bool at_end() const { return done_ == recording_.steps.size(); }

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }
  /// Of each robot: where it has been, in voxels.
  [[nodiscard]] std::span<const std::vector<Eigen::Vector3d>> paths() const { return paths_; }
  /// [m] that each robot has travelled.
  [[nodiscard]] std::span<const double> lengths() const { return lengths_; }
  /// "name: 61.7 % mapped after 20.0 s", with the world if the name does not say it.
  [[nodiscard]] std::string title(const std::string& name) const;

 private:
  [[nodiscard]] double end_of(std::size_t step) const;
  void finish_step();

  const planner::Recording& recording_;
  bool seconds_;
  std::size_t done_ = 0;  // steps
  double moment_ = 0.0;
  VoxelGrid grid_;
  std::vector<std::vector<Eigen::Vector3d>> finished_, paths_;  // up to the last finished step; up to now
  std::vector<double> lengths_;
};

}  // namespace frontlux::app
