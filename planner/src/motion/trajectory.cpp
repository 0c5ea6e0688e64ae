#include "motion/rounded_path.hpp"
#include "motion/speed_profile.hpp"
#include "motion/yaw.hpp"

#include <frontlux/planner/trajectory.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

// The part of some pieces up to a length.
std::vector<PathPiece> cut_off(std::vector<PathPiece> pieces, double length) {
  std::vector<PathPiece> part;
  for (PathPiece& piece : pieces) {
    if (length <= 0.0) break;
    piece.length = std::min(piece.length, length);
    length -= piece.length;
    part.push_back(piece);
  }
  return part;
}

}  // namespace

Trajectory::Trajectory(const Pose& pose, double time)
    : pieces_{{pose.position}}, ends_{0.0}, nodes_{{0.0, 0.0, time}}, yaws_{{time, pose.yaw}} {
  check_finite({&pose, 1});
  if (!std::isfinite(time)) throw std::invalid_argument("trajectory: the time is not finite");
}

std::optional<Trajectory> Trajectory::through(const MotionState& start, double time,
                                              std::span<const Pose> viewpoints, const MotionLimits& limits,
                                              const SegmentTest& is_free) {
  if (viewpoints.empty()) throw std::invalid_argument("trajectory: there is no viewpoint");
  check_finite(viewpoints);
  if (!start.velocity.allFinite()) throw std::invalid_argument("trajectory: the velocity is not finite");
  limits.check();
  if (path_length(viewpoints) > kLongestPath)
    throw std::length_error("trajectory: the path is longer than " +
                            std::to_string(static_cast<int>(kLongestPath)) + " m; take it in parts");

  Trajectory whole(start.pose, time);
  std::vector<Look> looks;
  double speed = start.velocity.norm();
  for (const detail::PathStretch& stretch : detail::rounded_path(viewpoints, speed, limits, is_free)) {
    const double begin = whole.length();
    if (!whole.extend(stretch.pieces, speed, limits)) return std::nullopt;
    for (const detail::PathLook& look : stretch.looks)
      looks.push_back({whole.time_at(begin + look.along), look.yaw});
    speed = 0.0;
  }
  whole.turn_to(looks, limits.yaw_rate);
  return whole;
}

Trajectory Trajectory::after_stop(double time, std::span<const Pose> viewpoints, const MotionLimits& limits,
                                  const SegmentTest& is_free) const {
  Trajectory whole = braking(time, limits);
  if (viewpoints.empty()) return whole;
  const MotionState rest{whole.end_pose()};
  if (const auto next = through(rest, whole.end(), viewpoints, limits, is_free)) whole.append(*next);
  return whole;
}

Pose Trajectory::stop(double time, const MotionLimits& limits) const {
  return braking(time, limits).end_pose();
}

// Appends pieces, taken as fast as the limits allow from a speed to rest. False if that is too fast.
bool Trajectory::extend(std::span<const PathPiece> pieces, double speed, const MotionLimits& limits) {
  constexpr double kRest = 1e-9;  // [m/s]
  if (pieces.empty()) return speed < kRest;
  const auto profile = detail::speed_profile(pieces, speed, limits);
  if (profile.empty()) return false;
  for (const PathPiece& piece : pieces) {
    pieces_.push_back(piece);
    ends_.push_back(ends_.back() + piece.length);
  }
  const double begin = length();
  nodes_.back().speed = speed;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const Node& before = nodes_.back();
    const double mean = (profile[i].speed + before.speed) / 2;
    nodes_.push_back({begin + profile[i].along, profile[i].speed,
                      before.time + (begin + profile[i].along - before.along) / mean});
  }
  yaws_.push_back({nodes_.back().time, yaws_.back().yaw});
  return true;
}

// Yaws as near to those wanted as the rate allows, and the last of them for certain.
void Trajectory::turn_to(std::span<const Look> looks, double rate) {
  yaws_.resize(1);
  const double begin = yaws_.front().time, arrival = nodes_.back().time, first = yaws_.front().yaw;
  double last = first;
  for (const Look& look : looks) last += detail::turn(last, look.yaw);
  // Without the time for all these turns it takes the shortest.
  if (std::abs(last - first) > rate * (arrival - begin)) last = first + detail::turn(first, last);
  const double end = std::max(arrival, begin + std::abs(last - first) / rate);
  double wanted = first;
  for (const Look& look : looks) {
    wanted += detail::turn(wanted, look.yaw);
    const YawNode before = yaws_.back();
    if (look.time <= before.time || look.time >= end) continue;
    const double now = rate * (look.time - before.time), later = rate * (end - look.time);
    const double low = std::max(before.yaw - now, last - later),
                 high = std::min(before.yaw + now, last + later);
    yaws_.push_back({look.time, low < high ? std::clamp(wanted, low, high) : (low + high) / 2});
  }
  if (end > yaws_.back().time) yaws_.push_back({end, last});
}

void Trajectory::append(const Trajectory& next) {
  const double before = length(), turned = yaws_.back().yaw - next.yaws_.front().yaw;
  pieces_.insert(pieces_.end(), next.pieces_.begin() + 1, next.pieces_.end());
  for (std::size_t i = 1; i < next.ends_.size(); ++i) ends_.push_back(before + next.ends_[i]);
  nodes_.back().time = next.begin();
  for (std::size_t i = 1; i < next.nodes_.size(); ++i)
    nodes_.push_back({before + next.nodes_[i].along, next.nodes_[i].speed, next.nodes_[i].time});
  for (std::size_t i = 1; i < next.yaws_.size(); ++i)
    yaws_.push_back({next.yaws_[i].time, turned + next.yaws_[i].yaw});
}

// It keeps its yaw, and goes no farther than to the next place where it was to rest: there the path may turn.
// Where braking sooner than planned is not possible it stops as planned.
Trajectory Trajectory::braking(double time, const MotionLimits& limits) const {
  const Node now = node_at(time);
  const auto next = std::find_if(nodes_.begin(), nodes_.end(), [&](const Node& n) { return n.time > time; });
  const auto rest = std::find_if(next, nodes_.end(), [](const Node& node) { return node.speed == 0.0; });
  Trajectory stopping(at(time).pose, time);
  if (rest == nodes_.end() || now.speed == 0.0) return stopping;
  const std::vector<PathPiece> pieces = cut_off(pieces_from(now.along), rest->along - now.along);
  const double distance = detail::braking_distance(pieces, now.speed, limits);
  if (Trajectory sooner = stopping;
      sooner.extend(cut_off(pieces, distance), now.speed, limits) && sooner.nodes_.back().time <= rest->time)
    return sooner;
  stopping.nodes_.back().speed = now.speed;
  for (const PathPiece& piece : pieces) {
    stopping.pieces_.push_back(piece);
    stopping.ends_.push_back(stopping.ends_.back() + piece.length);
  }
  for (auto node = next; node != rest + 1; ++node)
    stopping.nodes_.push_back({node->along - now.along, node->speed, node->time});
  stopping.yaws_.push_back({stopping.nodes_.back().time, stopping.yaws_.back().yaw});
  return stopping;
}

std::vector<PathPiece> Trajectory::pieces_from(double along) const {
  std::vector<PathPiece> pieces;
  for (std::size_t i = piece_at(along); i < pieces_.size(); ++i) {
    const double begin = ends_[i] - pieces_[i].length;
    pieces.push_back(along > begin ? pieces_[i].from(along - begin) : pieces_[i]);
    if (pieces.back().length <= 0.0) pieces.pop_back();
  }
  return pieces;
}

std::size_t Trajectory::piece_at(double along) const {
  const auto piece = std::upper_bound(ends_.begin(), ends_.end(), along);
  return std::min(static_cast<std::size_t>(piece - ends_.begin()), pieces_.size() - 1);
}

Trajectory::Node Trajectory::node_at(double time) const {
  const auto next = std::upper_bound(nodes_.begin(), nodes_.end(), time,
                                     [](double t, const Node& node) { return t < node.time; });
  if (next == nodes_.begin()) return {0.0, 0.0, time};
  if (next == nodes_.end()) return {nodes_.back().along, 0.0, time};
  const Node& before = *(next - 1);
  const double passed = time - before.time;
  const double acceleration = (next->speed - before.speed) / (next->time - before.time);
  return {std::min(before.along + (before.speed + acceleration * passed / 2) * passed, next->along),
          before.speed + acceleration * passed, time};
}

double Trajectory::time_at(double along) const {
  const auto next = std::lower_bound(nodes_.begin(), nodes_.end(), along,
                                     [](const Node& node, double at) { return node.along < at; });
  if (next == nodes_.begin()) return begin();
  if (next == nodes_.end()) return nodes_.back().time;
  const Node& before = *(next - 1);
  const double part = along - before.along, step = next->along - before.along;
  const double squared =
      before.speed * before.speed + (next->speed * next->speed - before.speed * before.speed) * part / step;
  return before.time + 2 * part / (before.speed + std::sqrt(std::max(squared, 0.0)));
}

MotionState Trajectory::at(double time) const {
  const Node node = node_at(time);
  const std::size_t piece = piece_at(node.along);
  const double within = node.along - (ends_[piece] - pieces_[piece].length);
  MotionState state;
  state.pose.position = pieces_[piece].position(within);
  state.velocity = node.speed * pieces_[piece].direction_at(within);
  const auto next = std::upper_bound(yaws_.begin(), yaws_.end(), time,
                                     [](double t, const YawNode& yaw) { return t < yaw.time; });
  const YawNode& before = next == yaws_.begin() ? *next : *(next - 1);
  double yaw = before.yaw;
  if (next != yaws_.begin() && next != yaws_.end()) {
    state.yaw_rate = (next->yaw - before.yaw) / (next->time - before.time);
    yaw += state.yaw_rate * (time - before.time);
  }
  state.pose.yaw = detail::wrapped(yaw);
  return state;
}

double stop_and_go_time(std::span<const Pose> viewpoints, const MotionLimits& limits) {
  double time = 0.0;
  for (std::size_t i = 1; i < viewpoints.size(); ++i)
    time += Trajectory::through({viewpoints[i - 1]}, 0.0, viewpoints.subspan(i - 1, 2), limits, {})->end();
  return time;
}

}  // namespace frontlux::planner
