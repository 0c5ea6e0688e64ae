#pragma once

#include "routing/tour_search.hpp"
#include "tour/cluster_sights.hpp"
#include "tour/cluster_viewpoints.hpp"
#include "tour/frontier_clusters.hpp"
#include "tour/graph_distances.hpp"
#include "tour/joined_stops.hpp"
#include "tour/stop_groups.hpp"

#include <frontlux/planner/goal_selection.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/tour_part.hpp>
#include <frontlux/planner/trajectory.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// A place to which a robot's tour leads, to look at clusters of frontiers.
struct TourStop {
  std::vector<ClusterId> clusters;
  Pose pose;             ///< of the sensor
  VoxelKey cell;         ///< of the pose
  std::size_t seen = 0;  ///< frontiers of the clusters in view, about
};

/// Who looks at which cluster of frontiers, and in what order: tours for all robots together. They are kept
/// from planning to planning and shortened anew as the map changes.
class TourPlanning {
 public:
  struct Options {
    double near = 2.0;            ///< [own range] up to here each cluster is a stop of its own
    double least_gain = 10.0;     ///< [frontiers] least number in view from a stop
    std::size_t joined = 40;      ///< nearest clusters, which are seen from as few viewpoints as can be
    std::size_t refined = 5;      ///< first stops, whose viewpoints are chosen together
    std::size_t measured = 2500;  ///< nearest nodes of the graph to which the distances from a stop are known
    TourPart without = TourPart::kNone;
  };

  /// @param starts  of the robots; those on a plane stay on it
  TourPlanning(std::vector<Robot> robots, std::span<const Pose> starts, const Lattice& lattice,
               const KeyBox& bounds, const Options& options);

  /// What one robot plans with.
  struct Query {
    std::size_t robot = 0;
    const RayCaster& caster;              ///< of the map as it is now
    const VoxelGrid& grid;                ///< the same map
    const TravelCorridor& corridor;       ///< the robot's, up to date
    std::span<const VoxelKey> frontiers;  ///< worth a look; sorted
    std::span<const MotionState> starts;  ///< of all robots, when the trajectory begins
  };
  /// Shares the frontiers out anew, with the robot's part of it worked out.
  void update(const Query& query);

  /// A robot takes no more part: what it was to look at is left to the others.
  void lose(std::size_t robot);
  /// A robot that was lost takes part from a pose.
  void join(std::size_t robot, const Pose& pose);

  /// The robot may get to places that were closed to it, though the map is the same.
  void look_again(std::size_t robot) { members_[robot].sights.look_again(); }

  /// From the next planning on these voxels have changed.
  void note_changed_voxels(std::span<const VoxelKey> changed);
  /// The same for one robot: voxels, or cells that are closed to it from now on.
  void note_changed_voxels(std::size_t robot, std::span<const VoxelKey> changed);

  /// [frontiers] What a stop shows at least: `Options::least_gain`, or less for a sensor that sees little and
  /// for a map of few voxels in which nobody sees a cluster of the usual size any more.
  [[nodiscard]] double least_gain(std::size_t robot) const;

  /// The robot's tour as of the last update.
  [[nodiscard]] std::span<const TourStop> tour(std::size_t robot) const { return members_[robot].tour; }
  /// The places from which the robot that planned last sees clusters, one by one, and can get to: its stops
  /// are chosen among them. The gain is what it sees of the cluster, the quality is left out.
  [[nodiscard]] std::vector<RenderedCell> candidates(std::size_t robot) const;
  /// Frontiers that the robot will see from the first stop of its tour; sorted.
  [[nodiscard]] const std::vector<VoxelKey>& first_view(std::size_t robot) const {
    return members_[robot].first_view;
  }
  /// Whether the robot can get to a cell, wherever other robots are; as of its last update.
  [[nodiscard]] bool can_reach(std::size_t robot, const VoxelKey& cell) const;
  /// [m] from where the robot will be to the first stop of its tour, about; 0 if there is none.
  [[nodiscard]] double first_distance(std::size_t robot) const;
  /// On a short path of the robot to some cell, as far [m] beyond where it is by now; nothing if the path is
  /// no longer.
  [[nodiscard]] std::optional<VoxelKey> cell_on_path_to(std::size_t robot, const VoxelKey& cell,
                                                        const VoxelKey& here, double ahead) const {
    return members_[robot].distances.cell_on_path_to(cell, here, ahead);
  }
  /// Whether a cell is near a short path of the robot to some cell; for none if there is no path.
  [[nodiscard]] std::function<bool(const VoxelKey&)> around_path_to(std::size_t robot,
                                                                    const VoxelKey& cell) const;
  /// Where the robot would have a stop among some cells if it could get to them: it sees a cluster from there
  /// to which no other robot is going now. Nothing if there is no such place.
  [[nodiscard]] std::optional<VoxelKey> place_to_see_from(
      std::size_t robot, const RayCaster& caster, const VoxelGrid& grid,
      const std::function<bool(const VoxelKey&)>& among) const;
  /// Frontiers of the last update that are in no tour.
  struct Left {
    std::size_t small = 0;   ///< in clusters of too few
    std::size_t unseen = 0;  ///< in others: no robot sees enough of them from where it can get to
    /// How many a cluster has at least.
    std::size_t enough = 0;
  };
  [[nodiscard]] const Left& left() const { return left_; }

  /// Frontiers of the clusters in a robot's tour; sorted.
  [[nodiscard]] const std::vector<VoxelKey>& frontiers_of(std::size_t robot) const {
    return members_[robot].frontiers;
  }

 private:
  struct Member {
    Robot robot;
    ViewRegion region;
    GraphDistances distances;  // from where it is when its trajectory begins
    bool planned = false;      // before
    bool lost = false;
    bool stuck = false;      // it could get nowhere, when it planned last
    bool sees_some = false;  // clusters: when it planned last, or before if it has been stuck only since then
    std::vector<VoxelKey> changed = {};  // since its distances were updated
    ClusterSights sights = {};
    std::vector<TourStop> tour = {};
    std::vector<ClusterId> going_for = {};  // the clusters of its first stop, when it planned last
    std::vector<VoxelKey> frontiers = {};   // of the clusters in the tour
    std::vector<VoxelKey> first_view = {};
  };

  [[nodiscard]] Member new_member(Robot robot, const Pose& start) const;
  [[nodiscard]] double own_distance_to(const Query& query, const VoxelKey& cell) const;
  [[nodiscard]] bool reaches(const Query& query, const VoxelKey& cell) const;
  [[nodiscard]] std::vector<KeyBox> take_changes(Member& member) const;
  std::vector<KeyBox> update_distances(const Query& query, std::span<const KeyBox> changes);
  [[nodiscard]] bool nobody_sees_any() const;
  bool lower_least_sizes(const VoxelGrid& grid);
  [[nodiscard]] bool looks_closer() const { return least_left_ < std::numeric_limits<double>::infinity(); }
  [[nodiscard]] FrontierClusters::Exceptions openings(const VoxelGrid& grid) const;
  [[nodiscard]] static std::size_t least_frontiers(const Lattice& lattice);
  [[nodiscard]] ViewpointQuery sight_of(std::size_t robot, const RayCaster& caster,
                                        const VoxelGrid& grid) const;
  [[nodiscard]] std::vector<SeenCluster> seen_clusters(std::span<const MotionState> starts) const;
  [[nodiscard]] std::vector<StopClusters> stop_places(const Query& query) const;
  /// @param cluster  its place among all
  [[nodiscard]] const ClusterViewpoint* best_viewpoint(const Member& member, std::uint32_t cluster) const;
  [[nodiscard]] TourProblem problem(const Query& query, std::span<const StopClusters> stops);
  [[nodiscard]] TourProblem::Robot travel_times(const Query& query, std::size_t robot,
                                                std::span<const StopClusters> stops);
  [[nodiscard]] StopClusters in_order(const Member& member, const StopClusters& stop,
                                      Eigen::Vector3d from) const;
  // The stages of `update`.
  void update_map(const Query& query);
  void look_closer(const Query& query,
                   const std::function<ClusterSights::Query(const ViewpointQuery&)>& sights);
  [[nodiscard]] Tours tours_before(const Query& query, std::span<const StopClusters> stops,
                                   TourProblem& problem) const;
  [[nodiscard]] static Tours shared_out(const TourProblem& problem, const Tours& before);
  [[nodiscard]] static Tours nearest_stop(const TourProblem& problem, const Tours& before, std::size_t robot);
  void set_tours(const Query& query, std::span<const StopClusters> stops, const Tours& tours);
  void join_next_stops(const Query& query);
  void note_frontiers(const Query& query);
  // The stages of `join_next_stops` (next_stops.cpp).
  struct NextStops {
    std::vector<const FrontierCluster*> clusters = {};
    std::vector<ClusterViewpoint> viewpoints = {};  // of the clusters
    std::vector<double> distances = {};             // [m] to the viewpoints
    SharedViews views = {};                         // of the clusters from the viewpoints
    std::vector<JoinedStop> stops = {};
  };
  void put_nearest_first(const Query& query);
  [[nodiscard]] NextStops next_stops(const Query& query) const;
  void put_in_order(const Query& query, NextStops& next);
  [[nodiscard]] std::vector<std::size_t> chosen_viewpoints(const Query& query, const NextStops& next);
  [[nodiscard]] TourStop stop_at(const Query& query, const NextStops& next, const JoinedStop& joined,
                                 std::size_t viewpoint) const;
  [[nodiscard]] double seconds_to_first(const Query& query, const NextStops& next,
                                        std::size_t viewpoint) const;
  [[nodiscard]] double seconds_between(const Query& query, const NextStops& next, std::size_t a,
                                       std::size_t b) const;
  [[nodiscard]] double seconds_to(const Robot& robot, const MotionState& start,
                                  const ClusterViewpoint& viewpoint, double distance) const;

  Lattice lattice_;
  KeyBox bounds_;
  Options options_;
  int graph_edge_, zone_edge_;  // [voxels]
  FrontierClusters clusters_;
  Left left_;
  // [frontiers] What is worth a stop by what is known; it counts from when nobody sees a cluster of the usual
  // size.
  double least_left_ = std::numeric_limits<double>::infinity();
  std::vector<Member> members_;
};

}  // namespace frontlux::planner::detail
