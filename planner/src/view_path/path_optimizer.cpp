#include "motion/yaw.hpp"
#include "view_path/gain_ascent.hpp"
#include "view_path/yaw_bins.hpp"
#include "view_path/yaw_limits.hpp"

#include <frontlux/planner/path_optimizer.hpp>

#include <optional>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

// The gains of the tangent, the start and the result are evaluated beside the ascent.
constexpr int kReports = 3;

void refuse(const std::string& what) { throw std::invalid_argument("path optimizer: " + what); }

void check_limit(const char* name, double value, const char* unit) {
  if (!(value >= 0.0))
    refuse(std::string(name) + " is " + std::to_string(value) + unit + ", but has to be 0 or more");
}

// Why there is nothing to climb, if so.
std::optional<OptimizationEnd> no_ascent(const InformationGain& gain, const PathOptimizerOptions& options) {
  if (gain.viewpoints() < 3) return OptimizationEnd::kNothingToTurn;
  if (gain.view().sees_all_around()) return OptimizationEnd::kYawHasNoEffect;
  bool visible = false;
  for (std::size_t i = 1; i + 1 < gain.viewpoints(); ++i) visible = visible || !gain.frontiers_of(i).empty();
  if (!visible) return OptimizationEnd::kNothingVisible;
  if (!options.ascend) return OptimizationEnd::kAscentOff;
  return std::nullopt;
}

std::vector<double> start_yaws(const InformationGain& gain, std::span<const double> tangent,
                               const YawLimits& limits, const PathOptimizerOptions& options) {
  if (options.start == YawStart::kTangent)
    return limits.allows(tangent) ? std::vector(tangent.begin(), tangent.end())
                                  : limits.even_turn(tangent.front(), tangent.back());
  const YawBins bins(gain, options.yaw_bins, tangent, limits);
  return options.start == YawStart::kGreedy ? bins.most_distinct() : bins.most_views();
}

}  // namespace

void PathOptimizerOptions::check() const {
  gain.check();
  if (yaw_bins < 1 || yaw_bins > YawBins::kMaxBins)
    refuse("yaw_bins is " + std::to_string(yaw_bins) + ", but has to be 1 to " +
           std::to_string(YawBins::kMaxBins));
  if (sharpness.empty()) refuse("sharpness has no stage");
  for (const double k : sharpness) check_sharpness(k);
  if (max_evaluations <= kReports)
    refuse("max_evaluations is " + std::to_string(max_evaluations) + ", but has to be at least " +
           std::to_string(kReports + 1));
  check_limit("max_yaw_rate", max_yaw_rate, " rad/m");
}

PathOptimizerOptions paper_optimizer_options() {
  PathOptimizerOptions options;
  options.gain.mode = GainMode::kSum;
  options.start = YawStart::kTangent;
  options.max_evaluations = 60;  // the tangent is farther from a maximum than the greedy start
  return options;
}

std::string_view describe(OptimizationEnd end) {
  constexpr std::array<std::string_view, 8> kTexts = {
      "converged",
      "the limit on evaluations was reached",
      "the solver could not go on",
      "the ascent is switched off",
      "no viewpoint between the first and the last",
      "no frontier is visible between the first and the last viewpoint",
      "the sensor sees all around",
      "the yaws of first and last viewpoint differ by more than the limits allow"};
  return kTexts.at(static_cast<std::size_t>(end));
}

OptimizedPath optimize_path(std::span<const Pose> viewpoints, std::span<const Eigen::Vector3d> frontiers,
                            const VisiblePairs& pairs, const FieldOfView& view,
                            const PathOptimizerOptions& options) {
  options.check();
  const InformationGain gain(viewpoints, frontiers, pairs, view, options.gain);
  OptimizedPath path;
  if (viewpoints.empty()) {
    path.end = OptimizationEnd::kNothingToTurn;
    return path;
  }
  const auto report = [&](std::span<const double> yaws) {
    ++path.evaluations;
    return PathGain{gain.value(yaws, options.sharpness.back()), gain.distinct(yaws)};
  };
  const auto tangent = tangent_yaws(viewpoints);
  path.tangent = report(tangent);
  const YawLimits limits(viewpoints, options.max_yaw_rate);
  const auto even = limits.even_turn(tangent.front(), tangent.back());
  const auto nothing_to_climb = no_ascent(gain, options);
  const bool reachable = limits.allows(even);
  // Where nothing is visible, too, if it cannot look along its path: as near to that as the limits allow.
  const bool turn = !nothing_to_climb || *nothing_to_climb == OptimizationEnd::kAscentOff ||
                    (*nothing_to_climb == OptimizationEnd::kNothingVisible && !limits.allows(tangent));

  if (!reachable)
    path.yaws = even;
  else if (turn)
    path.yaws = start_yaws(gain, tangent, limits, options);
  else
    path.yaws = limits.allows(tangent) ? tangent : even;
  for (std::size_t i = 1; i + 1 < path.yaws.size(); ++i) path.yaws[i] = detail::wrapped(path.yaws[i]);
  path.start = report(path.yaws);

  if (!reachable)
    path.end = OptimizationEnd::kLimitsUnreachable;
  else if (nothing_to_climb)
    path.end = *nothing_to_climb;
  else {
    auto ascent = ascend(gain, path.yaws, limits, options.sharpness, options.max_evaluations - kReports);
    path.evaluations += ascent.evaluations;
    path.end = ascent.end;
    path.yaws = std::move(ascent.yaws);
  }
  path.result = report(path.yaws);
  if (reachable && path.tangent.distinct > path.result.distinct && limits.allows(tangent)) {
    path.yaws = tangent;
    path.result = path.tangent;
  }
  return path;
}

std::vector<double> tangent_yaws(std::span<const Pose> viewpoints) {
  check_finite(viewpoints);
  std::vector<double> yaws;
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    if (i == 0 || i + 1 == viewpoints.size()) {
      yaws.push_back(viewpoints[i].yaw);
      continue;
    }
    const Eigen::Vector3d ahead = viewpoints[i + 1].position - viewpoints[i].position;
    yaws.push_back(yaw_along(ahead, detail::wrapped(yaws.back())));
  }
  return yaws;
}

}  // namespace frontlux::planner
