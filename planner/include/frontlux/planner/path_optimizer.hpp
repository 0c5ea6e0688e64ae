#pragma once

#include <frontlux/field_of_view.hpp>
#include <frontlux/planner/information_gain.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/visible_pairs.hpp>

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace frontlux::planner {

/// Where the ascent along the gradient starts.
enum class YawStart : std::uint8_t {
  kGreedy,    ///< a bin for each viewpoint, chosen so that together they see most distinct frontiers
  kBestBins,  ///< the bin in which each viewpoint alone sees most: best for `GainMode::kSum`
  kTangent,   ///< along the path
};

/// Who computes the gradient.
enum class Differentiation : std::uint8_t { kClosedForm, kAutomatic };

struct PathOptimizerOptions {
  GainOptions gain;
  YawStart start = YawStart::kGreedy;
  int yaw_bins = 24;   ///< 1 to 63, around the full circle
  bool ascend = true;  ///< along the gradient, with Ipopt; else the start is all
  std::vector<double> sharpness = {8.0, 20.0, 40.0};  ///< one ascent after the other; not empty
  int max_evaluations = 30;  ///< of the differentiable gain, in all; at least 4. More help from poorer starts
  Differentiation differentiation = Differentiation::kClosedForm;
  double max_yaw_step = std::numeric_limits<double>::infinity();  ///< [rad] from one viewpoint to the next
  double max_yaw_rate = std::numeric_limits<double>::infinity();  ///< [rad/m] along the path

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// As printed in the paper: the sum of all views, from the path's tangent. The result is still never worse,
/// in distinct frontiers, than the tangent.
[[nodiscard]] PathOptimizerOptions paper_path_options();

/// A path's gain: the differentiable one at the last sharpness, and the number of distinct frontiers in view.
struct PathGain {
  double fuzzy = 0.0;
  std::uint64_t distinct = 0;
};

/// Why the optimisation ended.
enum class PathEnd : std::uint8_t {
  kConverged,
  kEvaluationLimit,   ///< the last ascent was cut short; the yaws are good all the same
  kSolverStopped,     ///< Ipopt could not go on; the yaws are the best it met, or the start's
  kAscentOff,         ///< not asked for
  kNothingToTurn,     ///< fewer than three viewpoints: the first and the last are fixed
  kNothingVisible,    ///< no viewpoint between the ends sees a frontier at any yaw
  kYawHasNoEffect,    ///< a spinning sensor
  kLimitsUnreachable  ///< first and last yaw differ by more than the limits allow: turned evenly, beyond them
};

/// In words.
[[nodiscard]] std::string_view describe(PathEnd end);

struct OptimizedPath {
  std::vector<double> yaws;  ///< [rad] in [-pi, pi], one for each viewpoint; first and last as they were
  PathGain tangent;          ///< before: each viewpoint looks to the next
  PathGain start;            ///< where the ascent began
  PathGain result;
  int evaluations = 0;  ///< of the differentiable gain
  PathEnd end = PathEnd::kConverged;
  [[nodiscard]] bool converged() const { return end == PathEnd::kConverged; }
};

/// Turns the viewpoints between the first and the last so that the path sees more frontiers. The yaws in
/// `viewpoints` matter at both ends only.
///
/// Of all yaws met (tangent, start, and every step of the ascent) those with most distinct frontiers in view
/// are returned: never fewer than at the start, nor, where it keeps the limits, along the tangent.
/// Deterministic. Limits on yaw hold to 1e-9 rad.
///
/// May be called from several threads; their ascents wait for each other, since Ipopt keeps global counters.
/// @param frontiers  centres [m]
/// @throws std::invalid_argument if a value is not finite, sizes do not match or an option is out of bounds
[[nodiscard]] OptimizedPath optimize_path(std::span<const Pose> viewpoints,
                                          std::span<const Eigen::Vector3d> frontiers,
                                          const VisiblePairs& pairs, const FieldOfView& view,
                                          const PathOptimizerOptions& options = {});

/// Yaws along a path: each viewpoint between the ends looks to the next; one exactly below or above the next
/// looks as the one before it [rad]. First and last keep theirs.
[[nodiscard]] std::vector<double> tangent_yaws(std::span<const Pose> viewpoints);

}  // namespace frontlux::planner
