#include "motion/rounded_path.hpp"

#include "motion/speed_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace frontlux::planner {

Eigen::Vector3d PathPiece::position(double along) const {
  if (curvature == 0.0) return begin + along * direction;
  const double angle = curvature * along, half = std::sin(angle / 2);
  return begin + (std::sin(angle) * direction + 2 * half * half * inwards) / curvature;
}

Eigen::Vector3d PathPiece::direction_at(double along) const {
  if (curvature == 0.0) return direction;
  return std::cos(curvature * along) * direction + std::sin(curvature * along) * inwards;
}

PathPiece PathPiece::from(double along) const {
  PathPiece rest = *this;
  rest.begin = position(along);
  rest.direction = direction_at(along);
  if (curvature != 0.0)
    rest.inwards = std::cos(curvature * along) * inwards - std::sin(curvature * along) * direction;
  rest.length = length - along;
  return rest;
}

namespace detail {
namespace {

constexpr double kSamePlace = 1e-9;     // [m]
constexpr double kStraight = 1e-6;      // [rad] no corner
constexpr double kLeastRadius = 0.005;  // [m] a robot that takes a tighter corner has all but stopped
constexpr double kChordAngle = 0.1;     // [rad]

struct Corner {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();      // [m]
  Eigen::Vector3d before = Eigen::Vector3d::Zero();  // direction to it
  Eigen::Vector3d after = Eigen::Vector3d::Zero();   // direction from it
  double angle = 0.0;                                // [rad]
  double radius = 0.0;                               // [m] 0: the robot stops

  [[nodiscard]] double cut() const { return radius * std::tan(angle / 2); }  // [m] of both sides
  [[nodiscard]] PathPiece arc() const {
    const Eigen::Vector3d inwards = (after - after.dot(before) * before).normalized();
    return {at - cut() * before, before, inwards, 1.0 / radius, radius * angle};
  }
};

bool is_arc_free(const PathPiece& arc, const SegmentTest& is_free) {
  const double angle = arc.curvature * arc.length;
  const int chords = std::max(1, static_cast<int>(std::ceil(angle / kChordAngle)));
  // Between its ends the arc is this far from a chord, in the arc's plane.
  const double rise = (1.0 - std::cos(angle / chords / 2)) / arc.curvature;
  const Eigen::Vector3d deviation = rise * (arc.direction.cwiseAbs2() + arc.inwards.cwiseAbs2()).cwiseSqrt();
  Eigen::Vector3d from = arc.begin;
  for (int i = 1; i <= chords; ++i) {
    const Eigen::Vector3d to = arc.position(arc.length * i / chords);
    if (!is_free(from, to, deviation)) return false;
    from = to;
  }
  return true;
}

// The widest arc that helps: on a wider one the robot would not be faster.
double useful_radius(const MotionLimits& limits) {
  return limits.speed * limits.speed / (kSideways * limits.acceleration);
}

void round_corner(Corner& corner, double room, const MotionLimits& limits, const SegmentTest& is_free) {
  corner.radius = std::min(room / std::tan(corner.angle / 2), useful_radius(limits));
  while (corner.radius >= kLeastRadius && !is_arc_free(corner.arc(), is_free)) corner.radius /= 2;
  if (corner.radius < kLeastRadius) corner.radius = 0.0;
}

// A path's distinct places.
struct Places {
  std::vector<Eigen::Vector3d> at;   // [m]
  std::vector<double> lengths;       // [m] from each place to the next
  std::vector<std::size_t> of_path;  // of each viewpoint

  explicit Places(std::span<const Pose> viewpoints) {
    for (const Pose& viewpoint : viewpoints) {
      if (at.empty() || (viewpoint.position - at.back()).norm() > kSamePlace)
        at.push_back(viewpoint.position);
      of_path.push_back(at.size() - 1);
    }
    for (std::size_t i = 1; i < at.size(); ++i) lengths.push_back((at[i] - at[i - 1]).norm());
  }
};

// One for each place; those at the ends are none.
std::vector<Corner> corners_at(const Places& places, const MotionLimits& limits, const SegmentTest& is_free) {
  const auto& [at, lengths, of_path] = places;
  std::vector<Corner> corners(at.size());
  for (std::size_t i = 1; i + 1 < at.size(); ++i) {
    Corner& corner = corners[i];
    corner.at = at[i];
    corner.before = (at[i] - at[i - 1]) / lengths[i - 1];
    corner.after = (at[i + 1] - at[i]) / lengths[i];
    corner.angle =
        2 * std::atan2((corner.after - corner.before).norm(), (corner.after + corner.before).norm());
    if (corner.angle < kStraight) continue;
    const double before = i == 1 ? lengths[i - 1] : lengths[i - 1] / 2,
                 after = i + 2 == at.size() ? lengths[i] : lengths[i] / 2;
    round_corner(corner, std::min(before, after), limits, is_free);
  }
  return corners;
}

// The stretches of a path, which grow along it.
class Stretches {
 public:
  Stretches(std::span<const Pose> viewpoints, const Places& places)
      : viewpoints_(viewpoints), places_(places) {}

  void add(const PathPiece& piece) {
    if (piece.length <= kSamePlace) return;
    stretches_.back().pieces.push_back(piece);
    along_ += piece.length;
  }
  // The yaws of the viewpoints up to a place, so far [m] beyond the end of what is added.
  void look_up_to(std::size_t place, double ahead) {
    for (; next_ < viewpoints_.size() && places_.of_path[next_] <= place; ++next_)
      stretches_.back().looks.push_back({along_ + ahead, viewpoints_[next_].yaw});
  }
  void stop() {
    stretches_.emplace_back();
    along_ = 0.0;
  }
  std::vector<PathStretch> take() { return std::move(stretches_); }

 private:
  std::span<const Pose> viewpoints_;
  const Places& places_;
  std::vector<PathStretch> stretches_ = std::vector<PathStretch>(1);
  double along_ = 0.0;    // [m] the last stretch
  std::size_t next_ = 0;  // viewpoint
};

}  // namespace

std::vector<PathStretch> rounded_path(std::span<const Pose> viewpoints, const MotionLimits& limits,
                                      const SegmentTest& is_free) {
  const Places places(viewpoints);
  const std::vector<Corner> corners = corners_at(places, limits, is_free);
  Stretches stretches(viewpoints, places);
  stretches.look_up_to(0, 0.0);
  for (std::size_t i = 0; i + 1 < places.at.size(); ++i) {
    const Corner &from = corners[i], &to = corners[i + 1];
    const double length = places.lengths[i];
    const Eigen::Vector3d direction = (places.at[i + 1] - places.at[i]) / length;
    stretches.add({places.at[i] + from.cut() * direction, direction, Eigen::Vector3d::Zero(), 0.0,
                   length - from.cut() - to.cut()});
    if (to.radius > 0.0) {
      const PathPiece arc = to.arc();
      stretches.look_up_to(i + 1, arc.length / 2);
      stretches.add(arc);
      continue;
    }
    stretches.look_up_to(i + 1, 0.0);
    if (to.angle >= kStraight) stretches.stop();
  }
  return stretches.take();
}

}  // namespace detail
}  // namespace frontlux::planner
