#include "motion/speed_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace frontlux::planner::detail {
namespace {

constexpr double kLongest = 0.05;  // [m] between two nodes
constexpr double kWidest = 0.1;    // [rad]
constexpr int kFewest = 4;         // between rest and rest there is a node to be fast at

struct Interval {
  double length, curvature, acceleration;  // [m], [1/m], [m/s2]

  // The squared speed after the interval, or before it, with all the acceleration that the curve leaves: of
  // `a * a + (curvature * squared speed)^2 = acceleration^2` where the robot is faster.
  [[nodiscard]] double reachable(double squared) const {
    const double c = curvature * curvature, d = 2 * length;
    const double half = c * squared * d, whole = 1 + c * d * d;
    const double constant = c * squared * squared - acceleration * acceleration;
    if (constant >= 0.0) return squared;
    return squared + d * (std::sqrt(half * half - whole * constant) - half) / whole;
  }
};

double allowed_speed(const PathPiece& piece, const MotionLimits& limits) {
  if (piece.curvature == 0.0) return limits.speed_along(piece.direction);
  return std::min(limits.speed, std::sqrt(kSideways * limits.acceleration / piece.curvature));
}

double allowed_acceleration(const PathPiece& piece, const MotionLimits& limits) {
  return piece.curvature == 0.0 ? limits.acceleration_along(piece.direction) : limits.acceleration;
}

int intervals_of(const PathPiece& piece) {
  return std::max({kFewest, static_cast<int>(std::ceil(piece.length / kLongest)),
                   static_cast<int>(std::ceil(piece.length * piece.curvature / kWidest))});
}

}  // namespace

std::vector<SpeedNode> speed_profile(std::span<const PathPiece> pieces, double speed,
                                     const MotionLimits& limits) {
  std::vector<SpeedNode> nodes = {{0.0, speed}};
  if (pieces.empty()) return nodes;
  std::vector<Interval> intervals;
  std::vector<double> squared;  // the most at each node
  double begin = 0.0, before = allowed_speed(pieces.front(), limits);
  for (const PathPiece& piece : pieces) {
    const int count = intervals_of(piece);
    const double most = allowed_speed(piece, limits), least = std::min(before, most);
    before = most;
    squared.push_back(least * least);
    for (int i = 1; i <= count; ++i) {
      intervals.push_back({piece.length / count, piece.curvature, allowed_acceleration(piece, limits)});
      nodes.push_back({begin + piece.length * i / count, 0.0});
      if (i < count) squared.push_back(most * most);
    }
    begin += piece.length;
  }
  squared.push_back(0.0);  // it rests at the end

  for (std::size_t i = intervals.size(); i-- > 0;)
    squared[i] = std::min(squared[i], intervals[i].reachable(squared[i + 1]));
  constexpr double kRounding = 1e-9;
  if (speed * speed > squared.front() * (1 + kRounding) + kRounding) return {};
  squared.front() = speed * speed;
  for (std::size_t i = 0; i < intervals.size(); ++i)
    squared[i + 1] = std::min(squared[i + 1], intervals[i].reachable(squared[i]));
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].speed = std::sqrt(squared[i]);
  return nodes;
}

double braking_distance(std::span<const PathPiece> pieces, double speed, const MotionLimits& limits) {
  constexpr double kReserve = 0.995;  // the profile's nodes will lie elsewhere
  double distance = 0.0, squared = speed * speed;
  for (const PathPiece& piece : pieces) {
    const int count = intervals_of(piece);
    const double most = kReserve * allowed_acceleration(piece, limits), step = piece.length / count;
    for (int i = 0; i < count; ++i) {
      const double sideways = piece.curvature * squared;
      const double slowing = std::sqrt(std::max(most * most - sideways * sideways, 0.0));
      if (squared <= 2 * slowing * step) return distance + squared / (2 * slowing);
      squared -= 2 * slowing * step;
      distance += step;
    }
  }
  return distance;
}

}  // namespace frontlux::planner::detail
