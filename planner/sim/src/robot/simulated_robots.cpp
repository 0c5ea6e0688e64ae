#include "sensing/keyed_random.hpp"

#include <frontlux/sim/simulated_robots.hpp>
#include <frontlux/sim/swept_body.hpp>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::sim {
namespace {

using planner::Motion, planner::TravelOptions;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("simulated robots: " + what);
}

VoxelKey key_of(const Lattice& lattice, const Eigen::Vector3d& point) {
  const auto key = lattice.key(point);
  if (!key)
    refuse("the viewpoint " + std::to_string(point.x()) + ", " + std::to_string(point.y()) + ", " +
           std::to_string(point.z()) + " m is not finite, or outside of the map's key range");
  return *key;
}

// The box around the body itself, smaller by a margin on all sides.
Eigen::AlignedBox3d body_at(const TravelOptions& travel, const Lattice& lattice,
                            const Eigen::Vector3d& sensor) {
  const Eigen::Vector3d half = travel.extents / 2;
  Eigen::AlignedBox3d body = planner::body_of(travel).translated(sensor);
  if (travel.motion == Motion::kPlane) {
    const KeyBox box = voxels_of_cell(travel, lattice, key_of(lattice, sensor));
    body.min().z() = (static_cast<int>(box.min.z) - Lattice::kOrigin) * lattice.resolution();
    body.max().z() = body.min().z() + travel.extents.z();
  }
  const Eigen::Vector3d margin = (half / 2).cwiseMin(GroundTruth::kMargin);
  return {body.min() + margin, body.max() - margin};
}

}  // namespace

SimulatedRobots::SimulatedRobots(const World& world, const GroundTruth& truth,
                                 std::vector<planner::RobotDescription> robots, const RangeErrors& errors,
                                 std::uint64_t seed, AtContact at_contact)
    : truth_(&truth),
      surface_(world.mesh),
      solids_(world.mesh),
      robots_(std::move(robots)),
      progress_(robots_.size()),
      seed_(seed),
      at_contact_(at_contact) {
  for (const planner::RobotDescription& robot : robots_) sensors_.push_back(sensor_of(robot, errors));
}

std::uint64_t SimulatedRobots::contacts_between(const TravelOptions& travel, const Eigen::Vector3d& from,
                                                const Eigen::Vector3d& to) const {
  TravelOptions body = travel;
  body.node_edge = 0.0;  // it has its own size, whatever it is planned with
  const Lattice& lattice = truth_->lattice();
  const Eigen::AlignedBox3d first = body_at(body, lattice, from), last = body_at(body, lattice, to);
  return solids_.count(SweptBody(body.planned_shape(), first, last.min() - first.min()));
}

std::optional<planner::Scan> SimulatedRobots::drive(std::size_t robot, const planner::Pose& viewpoint) {
  if (robot >= robots_.size())
    refuse("there is no robot " + std::to_string(robot) + ", but " + std::to_string(robots_.size()) +
           ", counted from 0");
  static_cast<void>(key_of(truth_->lattice(), viewpoint.position));
  if (!std::isfinite(viewpoint.yaw)) refuse("the viewpoint's yaw is not finite");
  Progress& now = progress_[robot];
  const Eigen::Vector3d from = now.pose ? now.pose->position : viewpoint.position;
  const std::uint64_t met = contacts_between(robots_[robot].robot.travel, from, viewpoint.position);
  if (at_contact_ == AtContact::kStay && now.pose && met > 0) return std::nullopt;
  contacts_ += met;
  now.pose = viewpoint;
  const std::uint64_t errors = random_of(random_of(seed_, robot).bits(), now.scans++).bits();
  return sense(surface_, sensors_[robot], viewpoint, errors);
}

}  // namespace frontlux::sim
