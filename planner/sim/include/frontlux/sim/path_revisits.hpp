#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace frontlux::sim {

/// How much of a robot's path leads to where the robot has been: within a metre of its own earlier path, but
/// for the last six metres of it.
///
/// The path is judged in pieces of at most a decimetre, by where they end. Takes time and memory that grow
/// with its length.
class PathRevisits {
 public:
  static constexpr double kNear = 1.0;    ///< [m] so near to its earlier path
  static constexpr double kBefore = 6.0;  ///< [m] so much of its path ago, or more
  static constexpr double kPiece = 0.1;   ///< [m] the longest

  /// @param start  where the path begins [m]
  explicit PathRevisits(const Eigen::Vector3d& start) : at_(start), recent_{{start, 0.0}} {}

  /// Goes straight on to a place [m].
  void go_to(const Eigen::Vector3d& place);

  /// The part of the path so far, 0 to 1; 0 before it has a length.
  [[nodiscard]] double share() const { return length_ > 0.0 ? revisited_ / length_ : 0.0; }

 private:
  struct PieceEnd {
    Eigen::Vector3d place;
    double along = 0.0;  // [m] of the path up to there
  };

  void add(const Eigen::Vector3d& end, double length);
  [[nodiscard]] bool was_near(const Eigen::Vector3d& place) const;

  Eigen::Vector3d at_;
  double length_ = 0.0, revisited_ = 0.0;                                // [m]
  std::deque<PieceEnd> recent_;                                          // not long enough ago
  std::unordered_map<std::uint64_t, std::vector<Eigen::Vector3d>> old_;  // the others, by cell
};

}  // namespace frontlux::sim
