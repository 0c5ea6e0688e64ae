#pragma once

#include "mapping/box_array.hpp"
#include "routing/tour_problem.hpp"

#include <frontlux/lattice.hpp>
#include <frontlux/planner/travel_corridor.hpp>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// Where a robot fits, in the large: its cells in cubes, and in each cube the parts that connect. It knows
/// exactly which cells are connected, and about how far they are from each other.
class TravelGraph {
 public:
  /// @param bounds  of the cells
  /// @param edge    [voxels] of a cube, at most 40
  /// @param spacing [voxels] of the cells that `spread_cells` returns
  TravelGraph(const Lattice& lattice, const KeyBox& bounds, int edge, int spacing);

  /// @param corridor  of the map as it is now; where other robots are does not matter
  /// @param changed   boxes of cells outside of which nothing has changed since the last update; at first,
  ///                  outside of which the robot does not fit
  void update(const TravelCorridor& corridor, std::span<const KeyBox> changed);

  /// Whether the robot fits in a cell.
  [[nodiscard]] bool fits(const VoxelKey& cell) const {
    return part_.box().contains(cell) && part_[cell] != 0;
  }
  /// The node that holds a cell; nothing if the robot does not fit there.
  [[nodiscard]] std::optional<std::uint32_t> node(const VoxelKey& cell) const;
  /// The lowest and the highest cell in which the robot fits; none if it fits nowhere.
  [[nodiscard]] std::optional<KeyBox> extent() const { return extent_; }
  [[nodiscard]] std::size_t size() const { return names_.size(); }
  /// Cells in a box in which the robot fits: of each part of a cube one in each smaller cube.
  [[nodiscard]] std::vector<VoxelKey> spread_cells(const KeyBox& box) const;

  /// [m] from a node to others, from middle to middle; `kNever` where there is no path.
  [[nodiscard]] std::vector<double> distances(std::uint32_t from) const;

  /// What a node is called until its cells change, whatever its number.
  using Name = std::uint64_t;
  [[nodiscard]] Name name_of(std::uint32_t node) const { return names_[node]; }
  struct Distance {
    Name to;
    double length;  ///< [m]
    auto operator<=>(const Distance&) const = default;
  };
  /// A node, and of `distances` from it those to the nearest nodes, sorted by name. Whatever has changed
  /// elsewhere, they are the same as long as none of these nodes `has_changed`.
  struct Near {
    std::uint32_t from;
    std::vector<Distance> distances;
  };
  /// Finds the distances of some nodes.
  /// @param places  with the distances before the last update, found for the same `count`, or with none: of
  ///                those before only what has changed is found anew
  /// @param count   how many are enough; there may be somewhat more
  void measure(std::span<Near> places, std::size_t count) const;
  /// Whether the last update has changed the node's cells or its edges.
  [[nodiscard]] bool has_changed(Name name) const { return changed_[name >> kPartBits] != 0; }

  /// The nodes of a shortest path to a node, from its end to its begin.
  /// @param lengths  `distances` from where the path begins; that to the node is not `kNever`
  [[nodiscard]] std::vector<std::uint32_t> path_back(const std::vector<double>& lengths,
                                                     std::uint32_t to) const;
  /// The cell of a node that is nearest to its middle, of those that `spread_cells` returns.
  [[nodiscard]] VoxelKey middle_cell(std::uint32_t node) const;
  /// The nodes of a shortest path to a node and those next to them, sorted: their cells connect.
  /// @param lengths  `distances` from where the path begins; that to the node is not `kNever`
  [[nodiscard]] std::vector<std::uint32_t> around_path(const std::vector<double>& lengths,
                                                       std::uint32_t to) const;

 private:
  struct Cube {
    KeyBox cells;
    std::vector<Eigen::Vector3d> centers;               // of its parts
    std::vector<VoxelKey> spread;                       // some of its cells
    std::vector<std::pair<std::uint32_t, Name>> links;  // from a part to a part of a later cube
    struct Edge {
      std::uint32_t from;  // part
      Name to;
      float length;  // [m]
      bool operator==(const Edge&) const = default;
    };
    std::vector<Edge> edges;  // sorted
  };
  class Search;

  static constexpr int kPartBits = 16;
  [[nodiscard]] static Name name_of(std::size_t cube, std::uint32_t part) {
    return (Name{cube} << kPartBits) | part;
  }
  [[nodiscard]] static std::size_t cube_of(Name name) { return name >> kPartBits; }
  [[nodiscard]] static std::uint32_t part_of(Name name) {
    return static_cast<std::uint32_t>(name & ((1u << kPartBits) - 1));
  }
  [[nodiscard]] const Eigen::Vector3d& center_of(Name name) const {
    return cubes_[cube_of(name)].centers[part_of(name)];
  }

  [[nodiscard]] std::size_t cube_of(const VoxelKey& cell) const;
  template <class Visit>
  void for_each_cube(const KeyBox& box, const Visit& visit) const;
  bool read(Cube& cube, const TravelCorridor& corridor);
  void spread(Cube& cube) const;
  void link(std::size_t index);
  template <class Visit>
  void for_each_touching(Name name, const Visit& visit) const;
  bool connect(std::size_t index);
  template <class Visit>
  void for_each_as_near_as_two(std::size_t index, const Visit& visit) const;
  void number_nodes();

  Lattice lattice_;
  int edge_, spacing_;
  std::array<std::size_t, 3> count_{};  // of cubes
  // For each key along an axis what it adds to the number of its cube: a division would take longer.
  std::array<std::vector<std::uint32_t>, 3> number_of_;
  std::vector<Cube> cubes_;
  std::vector<std::uint32_t> first_;  // node of the first part of each cube
  BoxArray<std::uint16_t> part_;      // of each cell in its cube, from 1 on; 0 where the robot does not fit
  std::optional<KeyBox> extent_;
  std::vector<std::uint8_t> changed_;  // cubes whose cells or edges the last update has changed
  std::vector<Name> names_;            // of the nodes, in this order
  std::vector<std::size_t> begin_;     // of each node's edges
  struct Edge {
    std::uint32_t to;
    float length;  // [m]
  };
  std::vector<Edge> edges_;
  [[nodiscard]] std::span<const Edge> edges_of(std::uint32_t node) const {
    return std::span(edges_).subspan(begin_[node], begin_[node + 1] - begin_[node]);
  }
};

}  // namespace frontlux::planner::detail
