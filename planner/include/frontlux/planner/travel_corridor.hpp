#pragma once

#include <frontlux/map_change.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace frontlux::planner {

/// Where a robot can go at all.
enum class Motion : std::uint8_t {
  kPlane,  ///< on the layer of voxels that its sensor is in
  kSpace,  ///< anywhere above a minimum height
};

/// What a step from cell to cell costs.
enum class PathMetric : std::uint8_t {
  kEuclidean,  ///< also diagonal steps, of their own length, which cut no corner; right to 1 in 20,000
  kSteps,      ///< steps through faces only, each as long as a cell
};

/// What a robot needs to be somewhere.
///
/// Its collision box is measured in whole voxels and keeps to the lattice whatever the yaw: around the cell
/// it is the smallest odd number of voxels, along each axis, that covers `extents`. A box on a plane stands
/// on the lower face of a layer: the sensor's voxel is number floor(sensor_height / resolution) above that
/// face, and the box has the fewest layers that cover its height and hold the sensor.
struct TravelOptions {
  Motion motion = Motion::kSpace;
  Eigen::Vector3d extents = Eigen::Vector3d::Zero();  ///< [m] of the collision box along x, y and z
  PathMetric metric = PathMetric::kEuclidean;

  double sensor_height = 0.75;  ///< [m] on a plane: of the sensor above the floor
  /// On a plane: go only where no floor voxel under the box is known free, and one within `ground_reach`
  /// voxels of the cell's column is known occupied. The floor is the layer that the box stands on.
  bool require_ground = true;
  /// [m] Along x and y, the part of the floor that must not be known free, if not all that is under the box.
  std::optional<Eigen::Vector2d> ground_extents;
  int ground_reach = 1;                ///< [voxels] along x and y
  std::vector<KeyBox> without_ground;  ///< cells that need no ground: the start, whose floor no sensor sees

  double floor = 0.0;       ///< [m] in space: height of the floor in the world
  double min_height = 1.2;  ///< [m] in space: of the cell's centre above the floor
  /// [m] In space: not 0 makes cells of whole octree nodes, the smallest with at least this edge, that are
  /// known and free to the last voxel, instead of voxels with a free box around. A cell's key is then that of
  /// the voxel above the node's centre on all axes.
  double node_edge = 0.0;
};

/// The paper's robots: a UGV of 1.0 x 1.0 x 0.7 m, a UAV of 0.8 m, and the UAV on nodes of 1.2 m.
[[nodiscard]] TravelOptions ugv_travel();
[[nodiscard]] TravelOptions uav_travel();
[[nodiscard]] TravelOptions uav_node_travel();

/// The key of the cell that holds a voxel: itself, except among nodes.
[[nodiscard]] VoxelKey cell_of(const TravelOptions& options, const Lattice& lattice, const VoxelKey& voxel);

/// The voxels that have to be free for a robot in a cell: its collision box, or the cell's node. Cut off at
/// the end of the key range.
[[nodiscard]] KeyBox voxels_of_cell(const TravelOptions& options, const Lattice& lattice,
                                    const VoxelKey& cell);

/// How far a body that is not in the middle of a voxel may stick out of the collision box around the voxel,
/// along each axis [m]. The body fits at a position if all cells are passable that a box of this half width
/// around the position touches. 0 where the collision box has room for the body wherever in the voxel the
/// robot is, on a plane along z, and among nodes. A ten thousandth of a voxel is let go, so that a body as
/// wide as its collision box fits in the middle.
[[nodiscard]] Eigen::Vector3d reach_of(const TravelOptions& options, const Lattice& lattice);

/// Why there is a corridor, or none.
enum class CorridorState : std::uint8_t {
  kReady,
  kNotUpdated,     ///< no map has been seen
  kOutside,        ///< the robot is outside the bounds
  kTooLow,         ///< its cell is below the minimum height
  kUnknown,        ///< it is in an unknown voxel
  kOccupied,       ///< it is in an occupied voxel
  kBoxNotFree,     ///< its collision box, or its node, is not known free
  kWithoutGround,  ///< the floor under it does not satisfy `require_ground`
};

/// In words, as the end of a sentence about the robot.
[[nodiscard]] std::string_view describe(CorridorState state);

/// The cells that a robot can reach through what is known to be free, and how far they are.
///
/// A cell is passable where the whole collision box is known free; the corridor is what passable cells
/// connect with the robot's by faces. Diagonal steps shorten ways but reach nothing else. Follows a map by
/// its changed voxels: the result is the same as of a new corridor.
///
/// Takes memory for every voxel of the bounds, or of a layer of them. Thread safety: as a standard container.
class TravelCorridor {
 public:
  /// @param bounds  where the collision box has to be; of the plane only x and y are used
  /// @throws std::invalid_argument naming the option that cannot be, or if the bounds hold more than 2^29
  /// cells
  TravelCorridor(const TravelOptions& options, const Lattice& lattice, const KeyBox& bounds);
  ~TravelCorridor();
  TravelCorridor(TravelCorridor&&) noexcept;
  TravelCorridor& operator=(TravelCorridor&&) noexcept;

  /// The map has changed, or the robot has moved. The first update reads the whole map, and so does one with
  /// the robot on another plane.
  /// @param change  since the last update
  /// @param robot   the voxel of its sensor
  /// @throws std::invalid_argument if the grid has another resolution
  void update(const MapChange& change, const VoxelKey& robot);

  /// Takes these cells for impassable from the next update on, whatever the map says: something is there that
  /// no sensor has shown.
  void block(std::span<const VoxelKey> cells);

  /// If it is not `kReady`, there are no cells.
  [[nodiscard]] CorridorState state() const;

  /// All cells, sorted. Valid until the next update.
  [[nodiscard]] std::span<const VoxelKey> cells() const;
  [[nodiscard]] bool contains(const VoxelKey& key) const { return distance(key).has_value(); }

  /// Length of the shortest way from the robot [m]; nothing if the key is not that of a cell of the corridor.
  [[nodiscard]] std::optional<double> distance(const VoxelKey& key) const;

  /// The cells of a shortest way, from the robot's to this one, both included; empty if there is none.
  [[nodiscard]] std::vector<VoxelKey> path_to(const VoxelKey& key) const;

  /// Whether a cell is passable, connected or not. In constant time.
  [[nodiscard]] bool passable(const VoxelKey& key) const;

  /// `reach_of` the corridor's options.
  [[nodiscard]] const Eigen::Vector3d& reach() const;

  /// The key of the cell that holds a voxel: itself, except among nodes.
  [[nodiscard]] VoxelKey cell_of(const VoxelKey& voxel) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frontlux::planner
