#include <frontlux/planner/goal_selection.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

void check_number(const char* name, double value, double low, const char* unit) {
  if (!(value >= low && std::isfinite(value)))
    throw std::invalid_argument(std::string("goal selection: ") + name + " is " + std::to_string(value) +
                                " " + unit + ", but has to be finite and at least " + std::to_string(low));
}

}  // namespace

double GoalOptions::discount(double length) const { return std::exp(-lambda * length); }

void GoalOptions::check() const {
  if (rule > GoalRule::kNearest)
    throw std::invalid_argument("goal selection: rule is " + std::to_string(static_cast<int>(rule)) +
                                ", which is none of the values of GoalRule");
  if (distance > DistanceMeasure::kStraight)
    throw std::invalid_argument("goal selection: distance is " + std::to_string(static_cast<int>(distance)) +
                                ", which is none of the values of DistanceMeasure");
  check_number("lambda", lambda, 0.0, "per metre");
  check_number("min_distance", min_distance, 0.0, "m");
  check_number("advance", advance, 0.0, "m");
  check_number("min_gain", min_gain, 0.0, "frontiers");
  check_number("viewpoint_spacing", viewpoint_spacing, 0.0, "m");
  check_number("cluster_edge", cluster_edge, 0.0, "m");
  if (surroundings < 0 || surroundings > 64)
    throw std::invalid_argument("goal selection: surroundings is " + std::to_string(surroundings) +
                                ", but has to be 0 to 64");
  if (refined < 0)
    throw std::invalid_argument("goal selection: refined is " + std::to_string(refined) +
                                ", but has to be 0 or more");
  rendering.check();
}

namespace {

// As many bins of azimuth as let one fit into a view, 36 or more.
int azimuth_bins(const FieldOfView& view) {
  constexpr int kEnough = 36;
  if (view.sees_all_around()) return kEnough;
  const double least = std::ceil(2 * std::numbers::pi / view.horizontal - 1e-6);
  return static_cast<int>(std::clamp(least, double{kEnough}, double{ViewQualityOptions::kMaxAzimuthBins}));
}

}  // namespace

GoalOptions goal_options(const Robot& robot, Method method, double epsilon) {
  const bool drives = robot.travel.drives();
  GoalOptions options;
  options.rendering.azimuth_bins = azimuth_bins(robot.view);
  if (method == Method::kPaper) {
    options.distance = DistanceMeasure::kStraight;
    options.rule = drives ? GoalRule::kViewQuality : GoalRule::kClusters;
    options.rendering.estimator = ViewQualityOptions::Estimator::kPaper;
    options.refined = drives ? 0 : 4096;  // all cells that see a frontier
  } else {
    options.advance = 4.0;
    options.min_gain = epsilon;
    if (drives) {
      options.rendering.renderer = ViewQualityOptions::Renderer::kExact;
    } else {
      // In space there are so many pairs that it is faster to sample some and to count only the best cells.
      options.rendering.sampling = ViewQualityOptions::Sampling::kBuckets;
      options.viewpoint_spacing = 0.6;
      options.rendering.samples = 32;
      options.refined = 64;
      options.prune = true;
    }
  }
  return options;
}

GoalOptions motion_goal_options(const Robot& robot, Method method, double epsilon) {
  GoalOptions options = goal_options(robot, method, epsilon);
  if (method == Method::kDefault) options.advance = 2.0;
  return options;
}

std::string_view name_of(GoalState state) {
  constexpr std::array<std::string_view, 7> kNames = {"assigned",       "received",     "uncovered",
                                                      "no_corridor",    "no_frontiers", "nothing_assigned",
                                                      "nothing_visible"};
  return kNames.at(static_cast<std::size_t>(state));
}

}  // namespace frontlux::planner
