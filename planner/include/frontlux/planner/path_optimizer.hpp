#pragma once

#include <frontlux/export.hpp>
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
  kGreedy,    ///< a bin for each viewpoint, chosen greedily so that together they see many distinct frontiers
  kBestBins,  ///< for each viewpoint the bin in which it sees most by itself: best for `GainMode::kSum`
  kTangent,   ///< along the path
};

/// How the yaws of a path are optimised.
struct FRONTLUX_EXPORT PathOptimizerOptions {
  /// What is to become greater.
  GainOptions gain;
  /// From which yaws the ascent begins.
  YawStart start = YawStart::kGreedy;
  int yaw_bins = 24;   ///< 1 to 63, around the full circle
  bool ascend = true;  ///< along the gradient, with Ipopt; if false, the start is the result
  std::vector<double> sharpness = {8.0, 20.0, 40.0};  ///< one ascent after the other; not empty
  int max_evaluations = 30;  ///< of the differentiable gain, in all; at least 4. Poorer starts need more
  double max_yaw_rate = std::numeric_limits<double>::infinity();  ///< [rad/m] along the path

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// As printed in the paper: the sum of all views, from the path's tangent. The result still never has fewer
/// distinct frontiers in view than the tangent.
[[nodiscard]] FRONTLUX_EXPORT PathOptimizerOptions paper_optimizer_options();

/// A path's gain: the differentiable one at the last sharpness, and the number of distinct frontiers in view.
struct PathGain {
  /// The differentiable gain.
  double fuzzy = 0.0;
  /// Frontiers in view of at least one viewpoint.
  std::uint64_t distinct = 0;
};

/// Why the optimisation ended.
enum class OptimizationEnd : std::uint8_t {
  kConverged,
  kEvaluationLimit,   ///< the last ascent was cut short; the yaws are the best so far
  kSolverStopped,     ///< Ipopt could not go on; the yaws are the best so far
  kAscentOff,         ///< `PathOptimizerOptions::ascend` is false
  kNothingToTurn,     ///< fewer than three viewpoints: the first and the last are fixed
  kNothingVisible,    ///< no viewpoint between the ends sees a frontier at any yaw
  kYawHasNoEffect,    ///< a spinning sensor
  kLimitsUnreachable  ///< first and last yaw differ by more than the limits allow: turned evenly, beyond them
};

/// In words.
[[nodiscard]] FRONTLUX_EXPORT std::string_view describe(OptimizationEnd end);

/// A path with optimised yaws, and what they gain.
struct OptimizedPath {
  std::vector<double> yaws;  ///< [rad] in [-pi, pi], one for each viewpoint; first and last as they were
  PathGain tangent;          ///< before the optimisation: each viewpoint looks to the next
  PathGain start;            ///< where the ascent began
  /// Where the ascent ended.
  PathGain result;
  int evaluations = 0;  ///< of the differentiable gain
  /// Why it ended.
  OptimizationEnd end = OptimizationEnd::kConverged;
};

/// Turns the viewpoints between the first and the last so that the path sees more frontiers (the paper's
/// Sec. VII and Alg. 1, line 7). Of the yaws in `viewpoints`, only the first and the last are used.
///
/// Returns the yaws with most distinct frontiers in view among the tangent, the start and every step of the
/// ascent. A start from bins looks along the path, to the nearest of them, where nothing is to be seen. There
/// are never fewer than at the start, and never fewer than along the tangent if it keeps the limits.
/// Deterministic. Limits on yaw hold to 1e-9 rad.
///
/// May be called from several threads; their ascents wait for each other, since Ipopt keeps global counters.
/// @param frontiers  centres [m]
/// @throws std::invalid_argument if a value is not finite, sizes do not match or an option is out of bounds
[[nodiscard]] FRONTLUX_EXPORT OptimizedPath optimize_path(std::span<const Pose> viewpoints,
                                                          std::span<const Eigen::Vector3d> frontiers,
                                                          const VisiblePairs& pairs, const FieldOfView& view,
                                                          const PathOptimizerOptions& options = {});

/// Yaws along a path [rad]: each viewpoint between the ends looks to the next. A viewpoint straight below or
/// above the next one has the yaw of the one before it. The first and the last keep their yaws.
[[nodiscard]] FRONTLUX_EXPORT std::vector<double> tangent_yaws(std::span<const Pose> viewpoints);

}  // namespace frontlux::planner
