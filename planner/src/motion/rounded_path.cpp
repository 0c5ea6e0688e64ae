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

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {  // of length 1
  return 2 * std::atan2((b - a).norm(), (b + a).norm());
}

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

// The widest arc before which a robot so far from the corner [m] and so fast can get slow enough; at most a
// radius [m].
double radius_after_braking(const Corner& corner, double distance, double speed, double radius,
                            const MotionLimits& limits) {
  constexpr double kReserve = 0.999;
  // Of squared speeds: what braking up to the corner takes away in excess, what each metre of the radius
  // takes from that since the arc begins before the corner, and what it allows on the arc.
  const double braking = kReserve * 2 * limits.acceleration_along(corner.before);
  const double excess = braking * distance - speed * speed;
  const double earlier = braking * std::tan(corner.angle / 2), allowed = kSideways * limits.acceleration;
  if (excess >= 0.0 && earlier > allowed) radius = std::min(radius, excess / (earlier - allowed));
  const double most = excess + limits.speed * limits.speed;
  return most >= 0.0 ? std::min(radius, most / earlier) : radius;
}

void round_corner(Corner& corner, double radius, const SegmentTest& is_free) {
  corner.radius = radius;
  while (corner.radius >= kLeastRadius && !is_arc_free(corner.arc(), is_free)) corner.radius /= 2;
  if (corner.radius < kLeastRadius) corner.radius = 0.0;
}

// A path's ends and bends, and where on it its viewpoints are.
struct Bends {
  struct Place {
    std::size_t segment;
    double along;  // [m]
  };
  std::vector<Eigen::Vector3d> at;  // [m]
  std::vector<double> lengths;      // [m] from each to the next
  std::vector<Place> of_path;       // of each viewpoint

  explicit Bends(std::span<const Pose> viewpoints) {
    for (std::size_t i = 0; i < viewpoints.size(); ++i) {
      const Eigen::Vector3d& place = viewpoints[i].position;
      const auto next = std::ranges::find_if(viewpoints.subspan(i), [&](const Pose& viewpoint) {
        return (viewpoint.position - place).norm() > kSamePlace;
      });
      add(place, next == viewpoints.end() ? nullptr : &next->position);
    }
  }

 private:
  void add(const Eigen::Vector3d& place, const Eigen::Vector3d* next) {
    if (at.empty()) {
      at.push_back(place);
      of_path.push_back({0, 0.0});
      return;
    }
    const double along = (place - at.back()).norm();
    if (along <= kSamePlace) {
      of_path.push_back(of_path.back());
      return;
    }
    of_path.push_back({at.size() - 1, along});
    if (next != nullptr &&
        angle_between((place - at.back()) / along, (*next - place).normalized()) < kStraight)
      return;
    lengths.push_back(along);
    at.push_back(place);
  }
};

// One for each bend; the path's ends are none.
std::vector<Corner> corners_at(const Bends& bends, double speed, const MotionLimits& limits,
                               const SegmentTest& is_free) {
  const std::vector<double>& lengths = bends.lengths;
  std::vector<Corner> corners(bends.at.size());
  for (std::size_t i = 1; i < lengths.size(); ++i) {
    Corner& corner = corners[i];
    corner.at = bends.at[i];
    corner.before = (bends.at[i] - bends.at[i - 1]) / lengths[i - 1];
    corner.after = (bends.at[i + 1] - bends.at[i]) / lengths[i];
    corner.angle = angle_between(corner.before, corner.after);
    const double before = i == 1 ? lengths[i - 1] : lengths[i - 1] / 2,
                 after = i + 1 == lengths.size() ? lengths[i] : lengths[i] / 2;
    double radius = std::min(std::min(before, after) / std::tan(corner.angle / 2), useful_radius(limits));
    if (i == 1) radius = radius_after_braking(corner, lengths[0], speed, radius, limits);
    round_corner(corner, radius, is_free);
  }
  return corners;
}

// The stretches of a path, which grow along it.
class Stretches {
 public:
  Stretches(std::span<const Pose> viewpoints, const Bends& bends) : viewpoints_(viewpoints), bends_(bends) {
    if (bends.lengths.empty())
      for (const Pose& viewpoint : viewpoints) stretches_.back().looks.push_back({0.0, viewpoint.yaw});
  }

  // A segment between two corners, and the arc in the place of the second.
  void add(std::size_t segment, const Corner& from, const Corner& to) {
    const Eigen::Vector3d& begin = bends_.at[segment];
    const double length = bends_.lengths[segment];
    const Eigen::Vector3d direction = (bends_.at[segment + 1] - begin) / length;
    const double line = length - from.cut() - to.cut();
    look_along(segment, from, line, to);
    add({begin + from.cut() * direction, direction, Eigen::Vector3d::Zero(), 0.0, line});
    if (to.radius > 0.0) {
      add(to.arc());
    } else if (segment + 1 < bends_.lengths.size()) {
      stretches_.emplace_back();
      along_ = 0.0;
    }
  }
  std::vector<PathStretch> take() { return std::move(stretches_); }

 private:
  void add(const PathPiece& piece) {
    if (piece.length <= kSamePlace) return;
    stretches_.back().pieces.push_back(piece);
    along_ += piece.length;
  }
  // The yaws of a segment's viewpoints, which arcs at its ends may cut off.
  void look_along(std::size_t segment, const Corner& from, double line, const Corner& to) {
    const auto half_arc = [](const Corner& corner) { return corner.radius * corner.angle / 2; };
    for (; next_ < viewpoints_.size() && bends_.of_path[next_].segment == segment; ++next_) {
      const double along = bends_.of_path[next_].along, left = bends_.lengths[segment] - along;
      double place = along_ + along - from.cut();
      if (along < from.cut())
        place = along_ - half_arc(from) * (1 - along / from.cut());
      else if (left < to.cut())
        place = along_ + line + half_arc(to) * (1 - left / to.cut());
      stretches_.back().looks.push_back({place, viewpoints_[next_].yaw});
    }
  }

  std::span<const Pose> viewpoints_;
  const Bends& bends_;
  std::vector<PathStretch> stretches_ = std::vector<PathStretch>(1);
  double along_ = 0.0;    // [m] the last stretch
  std::size_t next_ = 0;  // viewpoint
};

}  // namespace

std::vector<PathStretch> rounded_path(std::span<const Pose> viewpoints, double speed,
                                      const MotionLimits& limits, const SegmentTest& is_free) {
  const Bends bends(viewpoints);
  const std::vector<Corner> corners = corners_at(bends, speed, limits, is_free);
  Stretches stretches(viewpoints, bends);
  for (std::size_t i = 0; i < bends.lengths.size(); ++i) stretches.add(i, corners[i], corners[i + 1]);
  return stretches.take();
}

}  // namespace detail
}  // namespace frontlux::planner
