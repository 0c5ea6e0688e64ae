#pragma once

#include "routing/number_table.hpp"
#include "tour/travel_graph.hpp"

#include <frontlux/planner/travel_corridor.hpp>

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Lengths of one robot's paths: from where it starts to everywhere, and between places that are not far from
/// each other.
class GraphDistances {
 public:
  /// @param measured  nearest nodes of the graph to which the distances from a place are known
  GraphDistances(const Lattice& lattice, TravelGraph graph, std::size_t measured);

  [[nodiscard]] const TravelGraph& graph() const { return graph_; }

  /// As `TravelGraph::update`. The start stays.
  void update(const TravelCorridor& corridor, std::span<const KeyBox> changed);
  /// Where the robot will be; none if it is not in the map, or does not fit there.
  void start_from(const std::optional<VoxelKey>& cell);
  [[nodiscard]] bool has_start() const { return start_.has_value(); }
  /// Finds the distances from some cells, until the next update. Of those found before only what it has
  /// changed is found anew.
  void measure_from(std::span<const VoxelKey> cells);

  /// Whether the robot can get to a cell from its start.
  [[nodiscard]] bool reaches(const VoxelKey& cell) const;
  /// [m] from the start; `kNever` if there is no path.
  [[nodiscard]] double from_start(const VoxelKey& cell) const;
  /// [m] `kNever` if the cells are far from each other, or there is no path.
  /// @param from  has been measured from
  [[nodiscard]] double between(const VoxelKey& from, const VoxelKey& to) const;
  /// The same from each of some cells to those before it.
  /// @param cells  `kNever` from and to those that are left out; the others have been measured from
  [[nodiscard]] NumberTable between(std::span<const std::optional<VoxelKey>> cells) const;
  /// On a short path from the start to some cell, as far [m] beyond where the robot is by now; nothing if the
  /// path is no longer.
  [[nodiscard]] std::optional<VoxelKey> cell_on_path_to(const VoxelKey& to, const VoxelKey& robot,
                                                        double ahead) const;
  /// Whether a cell is near a short path from the start to some cell; for none if there is no path.
  [[nodiscard]] std::function<bool(const VoxelKey&)> around_path_to(const VoxelKey& to) const;

 private:
  [[nodiscard]] double straightened(const VoxelKey& from, const VoxelKey& to, double distance) const;

  Lattice lattice_;
  TravelGraph graph_;
  std::size_t measured_;
  std::optional<VoxelKey> start_;
  std::vector<double> from_start_;  // [m] to each node; empty before they are found
  struct Near {
    std::vector<TravelGraph::Distance> distances;
    bool asked = true;  // for, since the last update
    bool stale = true;  // that update has changed what they depend on
  };
  std::map<TravelGraph::Name, Near> near_;  // from other nodes
};

}  // namespace frontlux::planner::detail
