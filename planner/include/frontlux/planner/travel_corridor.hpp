#pragma once

#include <frontlux/export.hpp>
#include <frontlux/map_change.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace frontlux::planner {

class BodyStencil;

/// How a robot moves.
enum class Motion : std::uint8_t {
  kPlane,   ///< on the layer of voxels that its sensor is in
  kSpace,   ///< anywhere above a minimum height
  kGround,  ///< on the ground, up and down slopes and steps
};

/// As in robots' files: "plane", "space", "ground".
[[nodiscard]] FRONTLUX_EXPORT std::string_view name_of(Motion motion);
/// Nothing if there is no motion of this name.
[[nodiscard]] FRONTLUX_EXPORT std::optional<Motion> motion_named(std::string_view name);

/// The shape of a robot's body. It keeps to the axes whatever the yaw.
enum class BodyShape : std::uint8_t {
  kBox,       ///< its edges along the axes
  kCylinder,  ///< upright
  kSphere,
};

/// As in robots' files: "box", "cylinder", "sphere".
[[nodiscard]] FRONTLUX_EXPORT std::string_view name_of(BodyShape shape);
/// Nothing if there is no shape of this name.
[[nodiscard]] FRONTLUX_EXPORT std::optional<BodyShape> body_shape_named(std::string_view name);

/// What a step from cell to cell costs.
enum class PathMetric : std::uint8_t {
  kEuclidean,  ///< also diagonal steps that cut no corner, by their own length; right to 1 in 20,000
  kSteps,      ///< steps through faces only, each as long as a cell
};

/// Where a robot fits.
///
/// In a cell it fits if no voxel that is not known to be free is nearer to its body, in the middle of the
/// cell, than its margin. Those voxels are its `BodyStencil`. Of a box they are the collision box: along each
/// axis the smallest odd number of voxels, with the cell in the middle, that covers body and margin. A
/// cylinder is taken as one that is larger by the margin: it has the layers of its box, and of their columns
/// those that are nearer to its axis than radius and margin. Around a sphere the distance counts in all
/// directions.
///
/// On a plane a body stands on the lower face of a layer: the sensor's voxel is number
/// floor(sensor_height / resolution) above that face, and the body has the fewest layers that cover its
/// height and hold the sensor. On the ground it is the same, but for the lowest layers, which steps and
/// slopes may reach into. A sphere that drives counts as the cylinder around it.
struct FRONTLUX_EXPORT TravelOptions {
  /// On a plane, in space or on the ground.
  Motion motion = Motion::kSpace;
  BodyShape shape = BodyShape::kBox;  ///< of the body
  /// [m] Of the box around the body along x, y and z; of a cylinder x and y are equal, of a sphere all.
  Eigen::Vector3d extents = Eigen::Vector3d::Zero();
  double margin = 0.0;  ///< [m] kept free around the body; of a robot that drives to its sides
  /// How paths are measured.
  PathMetric metric = PathMetric::kEuclidean;

  double sensor_height = 0.75;  ///< [m] of a robot that drives: of the sensor above the floor
  /// On a plane: go only where no floor voxel under the box is known to be a hole, and one within
  /// `ground_reach` voxels of the cell's column is known to be occupied. The floor is below the box. A hole
  /// is known to be free, and those next to it along x, or along y, are not both known to be occupied.
  bool require_ground = true;
  /// [m] Along x and y: the part of the floor in which no hole may be known; if not given, all of it.
  std::optional<Eigen::Vector2d> ground_extents;
  int ground_reach = 1;  ///< [voxels] along x and y
  /// Cells that need no ground, as the start: no sensor sees its floor. Holes count there, too: on a plane
  /// if all floor within `ground_reach` is holes, on the ground holes of two voxels.
  std::vector<KeyBox> without_ground;

  /// [m] On the ground: the highest step, at least a voxel, which is rounded down to whole ones. Floor is an
  /// occupied voxel with none on top of it, from the lower face of the box down to one voxel less than a
  /// step. There is a hole where a floor voxel is known to be free, and none above or below it within a step
  /// and the rise of the steepest slope under half of the body, rounded up to whole voxels, is known to be
  /// occupied. A gap no wider than a step along x or y is no hole: such voxels are occupied on both sides.
  double step = 0.15;
  double slope = 20.0 * std::numbers::pi / 180.0;  ///< [rad] on the ground: the steepest, up to 80 degrees

  double floor = 0.0;       ///< [m] in space: height of the floor in the world
  double min_height = 1.2;  ///< [m] in space: of the cell's centre above the floor
  /// [m] In space: if not 0, cells are whole octree nodes, the smallest with at least this edge, and a cell
  /// is passable if all its voxels are free; no collision box is used. The key of a cell is then that of the
  /// voxel above the node's centre on all axes.
  double node_edge = 0.0;

  /// Whether it goes on a floor.
  [[nodiscard]] bool drives() const { return motion != Motion::kSpace; }

  /// What planning and the simulator take for the body's shape: of a sphere that drives the cylinder around.
  [[nodiscard]] BodyShape planned_shape() const {
    return shape == BodyShape::kSphere && drives() ? BodyShape::kCylinder : shape;
  }

  /// [m] the box around body and margin
  [[nodiscard]] Eigen::Vector3d box() const {
    return extents + 2 * Eigen::Vector3d(margin, margin, drives() ? 0.0 : margin);
  }

  /// [m] On the ground: how far into its box steps and slopes may reach from below.
  [[nodiscard]] double ground_intrusion() const {
    const double half = std::max(extents.x(), extents.y()) / 2;
    return motion == Motion::kGround ? std::max(step, std::tan(slope) * half) : 0.0;
  }
};

/// The paper's robots: a UGV of 1.0 x 1.0 x 0.7 m, a UAV of 0.8 m, and the UAV on nodes of 1.2 m.
[[nodiscard]] FRONTLUX_EXPORT TravelOptions ugv_travel();
[[nodiscard]] FRONTLUX_EXPORT TravelOptions uav_travel();
[[nodiscard]] FRONTLUX_EXPORT TravelOptions uav_node_travel();

/// [m] The box around the body of a robot whose sensor is at the origin; on the ground without what the
/// ground may reach into.
[[nodiscard]] FRONTLUX_EXPORT Eigen::AlignedBox3d body_of(const TravelOptions& travel);

/// The first axis, 1 for y or 2 for z, along which a body of this shape would have to be as long as along x,
/// but is not; nothing if there is none.
[[nodiscard]] FRONTLUX_EXPORT std::optional<int> axis_unlike_x(const TravelOptions& travel);

/// The key of the cell that holds a voxel: the voxel itself, unless cells are nodes.
[[nodiscard]] FRONTLUX_EXPORT VoxelKey cell_of(const TravelOptions& options, const Lattice& lattice,
                                               const VoxelKey& voxel);

/// The smallest box around the voxels that have to be free for a robot in a cell, its `BodyStencil`; of a box
/// or a node it is all of them. Cut off at the end of the key range.
[[nodiscard]] FRONTLUX_EXPORT KeyBox voxels_of_cell(const TravelOptions& options, const Lattice& lattice,
                                                    const VoxelKey& cell);

/// Why there is a corridor, or none.
enum class CorridorState : std::uint8_t {
  kReady,
  kNotUpdated,     ///< there was no update yet
  kOutside,        ///< the robot is outside the bounds
  kTooLow,         ///< its cell is below the minimum height
  kUnknown,        ///< it is in an unknown voxel
  kOccupied,       ///< it is in an occupied voxel
  kBoxNotFree,     ///< its stencil, or its node, is not known to be free, or its cell is blocked
  kWithoutGround,  ///< the floor under it is not known to carry it
};

/// In words, as the end of a sentence about the robot.
[[nodiscard]] FRONTLUX_EXPORT std::string_view describe(CorridorState state);

/// What an update of a corridor finds out.
enum class CorridorExtent : std::uint8_t {
  kAllCells,  ///< all cells and their distances, in time that grows with their number
  kNearby,    ///< distances up to some 40 cells away, in time that grows with what has changed: `cells` is
              ///< empty, `distance` and `contains` know cells near by only, `path_to` those and that of
              ///< `find_path`
};

/// The cells that a robot can reach through what is known to be free, and how far they are.
///
/// A cell is passable if its whole stencil is known to be free. The corridor is all cells that passable
/// cells connect with the robot's by faces. Diagonal steps shorten paths but reach no other cells. After an
/// update the result is the same as that of a new corridor.
///
/// Takes memory for each voxel of the bounds, or of one layer; of a sphere for each height of its columns.
/// Thread safety: as a standard container.
class FRONTLUX_EXPORT TravelCorridor {
 public:
  /// @param bounds  of the stencil; on a plane only x and y are used
  /// @throws std::invalid_argument naming the option that is not valid, or if the bounds hold over 2^29 cells
  TravelCorridor(const TravelOptions& options, const Lattice& lattice, const KeyBox& bounds);
  ~TravelCorridor();
  TravelCorridor(TravelCorridor&&) noexcept;
  TravelCorridor& operator=(TravelCorridor&&) noexcept;

  /// Takes the changes of the map and the robot's new position. The first update reads the whole map, and so
  /// does one with the robot on another plane.
  /// @param change  since the last update
  /// @param robot   the voxel of its sensor
  /// @throws std::invalid_argument if the grid has another resolution
  void update(const MapChange& change, const VoxelKey& robot,
              CorridorExtent extent = CorridorExtent::kAllCells);

  /// Searches a path to one cell, wherever it is. Until the next update `path_to` returns it.
  /// @param through  cells that it may lead through, as far as they are passable; to a cell whose `distance`
  ///                 is known it leads through any
  /// @return whether there is one
  bool find_path(const VoxelKey& cell, const std::function<bool(const VoxelKey&)>& through);

  /// Makes these cells impassable from the next update on at the latest, whatever the map says: there is
  /// something that no sensor has seen.
  void block(std::span<const VoxelKey> cells);
  /// All of these so far, sorted. Valid until the next call of `block`.
  [[nodiscard]] std::span<const VoxelKey> blocked() const;

  /// Makes the cells in these boxes impassable from the next update on at the latest, in the place of those
  /// of the call before: other robots are there, or will be. If a box holds the robot's own cell, the part
  /// from the box's nearest face up to that cell stays passable, so that the robot can leave. For a robot
  /// that drives only the four sides count.
  void keep_out_of(std::vector<KeyBox> boxes);

  /// If it is not `kReady`, there are no cells.
  [[nodiscard]] CorridorState state() const;
  /// Of the last update.
  [[nodiscard]] CorridorExtent extent() const;

  /// All cells, sorted. Valid until the next update.
  [[nodiscard]] std::span<const VoxelKey> cells() const;
  /// Whether a cell belongs to the corridor.
  [[nodiscard]] bool contains(const VoxelKey& key) const { return distance(key).has_value(); }

  /// Length of the shortest path from the robot [m]; nothing if the key is not a cell of the corridor.
  [[nodiscard]] std::optional<double> distance(const VoxelKey& key) const;

  /// The cells of a shortest path, from the robot's to this one, both included; empty if there is none.
  [[nodiscard]] std::vector<VoxelKey> path_to(const VoxelKey& key) const;

  /// Whether a cell is passable, connected or not. Searches no path.
  [[nodiscard]] bool passable(const VoxelKey& key) const;

  /// Whether a cell would be passable, wherever other robots are. Searches no path.
  [[nodiscard]] bool fits(const VoxelKey& key) const;

  /// Where the robot's sensor is in a cell: in the middle, but of a robot that drives as high above the
  /// cell's lower face as its `sensor_height` has it.
  [[nodiscard]] Eigen::Vector3d place_in(const VoxelKey& cell) const;

  /// The voxels around a cell that have to be free.
  [[nodiscard]] const BodyStencil& stencil() const;
  /// `BodyStencil::reach` of the robot.
  [[nodiscard]] const Eigen::Vector3d& reach() const;

  /// The key of the cell that holds a voxel: the voxel itself, unless cells are nodes.
  [[nodiscard]] VoxelKey cell_of(const VoxelKey& voxel) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux::planner
