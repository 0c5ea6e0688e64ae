// What is worth a stop, and a closer look at what is left when nothing is.

#include "tour/space_behind.hpp"
#include "tour/tour_planning.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace frontlux::planner::detail {
namespace {

// [frontiers] A sensor of short range never has many in view: a fifth of those that cover its view at half of
// the range.
double most_to_ask(const FieldOfView& view, double resolution) {
  const double away = view.max_range / 2;
  const double width =
      view.sees_all_around() ? 2 * std::numbers::pi * away : 2 * away * std::tan(view.horizontal / 2);
  const double height = 2 * away * view.slope();
  return std::max(1.0, width * height / (resolution * resolution) / 5);
}

}  // namespace

// [frontiers] Of a cluster.
std::size_t TourPlanning::least_frontiers(const Lattice& lattice) {
  constexpr double kLeastArea = 1.5;  // [m2] of a cluster with a stop
  const double face = lattice.resolution() * lattice.resolution();
  return static_cast<std::size_t>(std::ceil(kLeastArea / face - 1e-6));
}

double TourPlanning::least_gain(std::size_t robot) const {
  const double most = most_to_ask(members_[robot].robot.view, lattice_.resolution());
  return std::max(1.0, std::min({options_.least_gain, least_left_, most}));
}

// As far as they have planned. For one planning a robot that can get nowhere counts as seeing what it saw
// before.
bool TourPlanning::nobody_sees_any() const {
  return std::ranges::all_of(members_, [](const Member& member) {
    return member.lost || (member.planned && !member.sees_some && !member.sights.sees_any());
  });
}

// From the closer look on: frontiers in a narrow door or a hatch are fewer than those of many leftovers. That
// a wide space begins behind them tells them apart; cracks lead into walls. Of a few large voxels neither is
// certain, and doors of that size are narrow for robots.
FrontierClusters::Exceptions TourPlanning::openings(const VoxelGrid& grid) const {
  constexpr double kLeastArea = 0.5;  // [m2]
  constexpr double kFewest = 15;      // [frontiers]
  constexpr double kWide = 1.5;       // [m]
  constexpr double kWall = 0.4;       // [m] behind which it begins at once
  if (!looks_closer()) return {};
  const double edge = lattice_.resolution();
  const double least = std::max(kFewest, kLeastArea / (edge * edge) - 1e-6);
  const int half = std::max(1, static_cast<int>(kWide / 2 / edge + 1e-6));
  const int steps = half + static_cast<int>(std::lround(kWall / edge));
  return [this, &grid, least, half, steps](std::span<const VoxelKey> frontiers) {
    return static_cast<double>(frontiers.size()) >= least &&
           lead_to_space(grid, bounds_, frontiers, half, steps);
  };
}

// A small world has nothing larger than what is left to those who come by in a large one.
// @return whether less is asked for than before
bool TourPlanning::lower_least_sizes(const VoxelGrid& grid) {
  constexpr double kPart = 0.001;
  const auto [unknown, free, occupied] = grid.count();
  const double before = least_left_;
  least_left_ = std::max({1.0, kPart * static_cast<double>(free + occupied), options_.least_gain / 20});
  const std::size_t least = least_frontiers(lattice_);
  clusters_.set_least(std::min(least, static_cast<std::size_t>(least_left_)), openings(grid));
  return least_left_ < std::min(before, std::max(options_.least_gain, static_cast<double>(least)));
}

// At what is left when nobody sees a cluster of the usual size: at smaller ones and, if they are much of what
// is known, at those of which only the faces are seen.
void TourPlanning::look_closer(const Query& query,
                               const std::function<ClusterSights::Query(const ViewpointQuery&)>& sights) {
  ClusterSights& own = members_[query.robot].sights;
  const bool is_first = !looks_closer();  // from now on openings are clusters, too
  const bool asks_less = lower_least_sizes(query.grid);
  if (asks_less)
    for (Member& member : members_) member.sights.look_again();
  if (asks_less || is_first) {
    own.update(sights(sight_of(query.robot, query.caster, query.grid)));
    if (!nobody_sees_any()) return;
  }
  ViewpointQuery view = sight_of(query.robot, query.caster, query.grid);
  view.least_gain = std::max(view.least_gain, least_left_);
  own.look_at_faces(sights(view));
}

}  // namespace frontlux::planner::detail
