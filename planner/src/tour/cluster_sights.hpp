#pragma once

#include "tour/cluster_viewpoints.hpp"
#include "tour/frontier_clusters.hpp"

#include <frontlux/key_box.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// From where one robot sees each cluster of frontiers, kept up with the map.
class ClusterSights {
 public:
  struct Query {
    const ViewpointQuery& view;
    std::span<const FrontierCluster> clusters;  ///< all that there are now
    /// Boxes that hold all voxels changed since the last update, and all cells in which the robot fits only
    /// now, or not any more.
    std::span<const KeyBox> changes;
    const std::function<bool(const VoxelKey&)>& reaches;   ///< whether the robot can get to a cell
    const std::function<bool(const VoxelKey&)>& connects;  ///< whether it could if there were no others
    bool can_move = true;                                  ///< whether it can get anywhere
  };
  /// Looks for the viewpoints of clusters that have changed, or near which something has. Where none of the
  /// usual places sees a cluster, cells all over the graph are tried, after each trial in vain with a pause
  /// twice as long; all of them once more before the robot sees no cluster at all.
  void update(const Query& query);

  /// Looks all over the graph for places that show the faces of the clusters that it does not see, once as
  /// long as nothing changes for them.
  void look_at_faces(const Query& query);

  /// From the next update on cells all over the graph are tried again for the clusters that it does not see.
  void look_again();

  /// Whether there is a cluster that the robot sees from where it can get to.
  [[nodiscard]] bool sees_any() const;
  /// Whether there is one that it would see from where it fits, but could not get to if there were no others.
  [[nodiscard]] bool would_see_any() const;

  /// Those of a cluster that the robot can get to, the best first.
  [[nodiscard]] std::span<const ClusterViewpoint> viewpoints(ClusterId cluster) const;

 private:
  struct Sight {
    std::uint64_t revision = 0;
    std::vector<ClusterViewpoint> found;       // wherever it fits
    std::optional<KeyBox> depend_on;           // as `FoundViewpoints` has it
    std::vector<ClusterViewpoint> viewpoints;  // those that it can get to
    bool stale = false;                        // since it was looked for all over the graph
    bool faces_stale = true;                   // since its faces were looked for
    // A cell of each node from which it might be seen, and which did not connect with the robot then, or was
    // kept closed by other robots.
    std::vector<VoxelKey> beyond, behind_others;
    bool found_beyond = false;  // where it has no viewpoints: some of what is found does not connect
    int in_vain = 0;            // that often, in a row
    int pause = 0;              // plannings until the next time
  };
  using Hidden = std::pair<const FrontierCluster*, Sight*>;

  struct Changes;
  static void note_unreached(const Query& query, const FrontierCluster& cluster, Sight& sight);
  [[nodiscard]] static bool needs_a_look(const Changes& changes, const FrontierCluster& cluster,
                                         const Sight& sight);
  [[nodiscard]] std::vector<Hidden> look_from_usual_places(const Query& query);
  static void find_reached(const Query& query, Sight& sight);
  static void look_from_anywhere(const Query& query, std::span<const Hidden> hidden);

  std::map<ClusterId, Sight> sights_;
  std::optional<KeyBox> extent_;  // of the graph
};

}  // namespace frontlux::planner::detail
