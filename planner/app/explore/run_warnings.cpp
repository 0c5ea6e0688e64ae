#include "explore/run_warnings.hpp"

#include "text.hpp"

#include <frontlux/planner/exploration.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace frontlux::app {
namespace {

constexpr double kDone = 0.95;  // of the observable space, at an end that its user has not asked for

constexpr std::size_t kEnoughPlannings = 20;  // to judge the latency by

std::string late_planning(double planning, double latency) {
  constexpr double kUnit = 0.05;  // [s] of the latency that is advised
  return "99 % of the plannings took up to " + fixed(planning, 3) + " s, and the clock charges " +
         rounded(latency) +
         " s for each: on this machine robots would get their trajectories later than in this run; explore "
         "with --latency " +
         fixed(std::ceil(planning / kUnit) * kUnit, 2) + " or more";
}

// Why the rest was not seen, by the true world, as far as it is much.
std::string why_unseen(const sim::Unseen& unseen) {
  std::string text;
  if (unseen.in_view >= sim::kMuchUnseen)
    text +=
        "; " + percent(unseen.in_view) +
        " could have been seen from places where they fit, but they did not get there through what they "
        "knew to be free, or would have seen too little there (on tours less than some 1.5 m2 of "
        "frontiers in one place, or 0.5 m2 before a wide space, else fewer than --epsilon; --goal nearest or "
        "render goes to less)";
  if (unseen.hidden >= sim::kMuchUnseen)
    text += "; " + percent(unseen.hidden) +
            " are hidden from everywhere, or out of the reach of their sensors (range_m, vertical_deg)";
  return text;
}

// That only other robots would see much of the rest, and what keeps these out.
std::string why_narrow(const sim::Unseen& unseen, const ExploreSetup& setup) {
  const std::string openings = narrow_openings(unseen, setup.head.robots);
  std::string text = percent(unseen.narrow) + " of the observable space are where only " +
                     others_than(setup.head.robots) + " see them: ";
  text +=
      openings.empty()
          ? "no robot alone would see half of them with a smaller body; margins (margin_m), steps, slopes or "
            "the height of a sensor may keep them out"
          : openings + ", in voxels of " + rounded(setup.head.resolution) +
                " m; finer ones (--resolution) leave wider openings";
  for (std::size_t r = 0; r < unseen.robots.size(); ++r)
    if (const double part = unseen.robots[r].without_min_height; part >= sim::kMuchUnseen)
      text += "; " + percent(part) + " would be in view of " + setup.head.robots[r].robot.name +
              " without its minimum height (min_height_m)";
  return text;
}

bool all_failed(const RunNumbers& numbers) {
  return std::ranges::all_of(numbers.robots,
                             [](const auto& robot) { return robot.failed && !robot.takes_part; });
}

// What each robot that is still there had last.
std::string why_they_rest(const ExploreSetup& setup, const RunNumbers& numbers) {
  std::string text;
  for (std::size_t r = 0; r < numbers.robots.size(); ++r)
    if (numbers.robots[r].takes_part && !numbers.robots[r].goal.empty())
      text += "; " + setup.head.robots[r].robot.name + ": " + numbers.robots[r].goal;
  return text;
}

// That a robot starts far from where it was asked to, which may be behind a wall: it does not fit nearer.
// Those of a team stand beside each other.
std::optional<std::string> far_start(const ExploreSetup& setup, std::size_t robot) {
  const double far = 2.0 * static_cast<double>(setup.head.robots.size());  // [m]
  if (!setup.given_start || setup.given_starts[robot]) return std::nullopt;
  const Eigen::Vector3f asked = *setup.given_start,
                        start = setup.head.starts[robot].pose.position.cast<float>();
  const double away = static_cast<double>((start - asked).head<2>().norm());
  if (away <= far) return std::nullopt;
  return "the robot '" + setup.head.robots[robot].robot.name + "' has started at " + to_text(start) + " m, " +
         fixed(away, 1) + " m from the start that was given, as it does not fit nearer to that";
}

// [m] How far the rays of a scan are from each other at the sensor's range, along the axis where it is more.
double between_rays(const planner::RobotDescription& robot) {
  const FieldOfView& view = robot.robot.view;
  const auto columns = static_cast<double>(robot.columns), rows = static_cast<double>(robot.rows);
  double across = 0.0, up = 0.0;
  switch (view.shape) {
    case FieldOfView::Shape::kSpinning:
      across = 2.0 * std::numbers::pi / columns;
      up = view.vertical / rows;
      break;
    case FieldOfView::Shape::kPyramid:
      across = 2.0 * std::tan(view.horizontal / 2.0) / columns;
      up = 2.0 * std::tan(view.vertical / 2.0) / rows;
      break;
    case FieldOfView::Shape::kCone: {
      const double radius = view.horizontal / 2.0;
      across = std::sqrt(std::numbers::pi * radius * radius / (columns * rows));
      break;
    }
  }
  return std::max(across, up) * view.max_range;
}

// What few rays leave unknown looks like something to see, and comes back wherever the robot looks.
std::string by_holes(const ExploreSetup& setup) {
  constexpr double kFar = 2.0;  // [voxels]
  std::string text;
  for (const planner::RobotDescription& robot : setup.head.robots)
    if (const double apart = between_rays(robot); apart > kFar * setup.head.resolution)
      text += "; the rays of " + robot.robot.name + " are " + fixed(apart, 2) +
              " m apart at its range, and leave holes between them in voxels of " +
              rounded(setup.head.resolution) + " m (range_m, columns, rows, --resolution)";
  return text;
}

std::string by_stray_returns(const ExploreSetup& setup) {
  if (setup.errors.stray == 0.0) return "";
  return "; stray returns (--stray " + rounded(setup.errors.stray) +
         ") close space to robots until rays have passed there again, and more than some 0.0003 shut them in";
}

}  // namespace

std::string others_than(std::span<const planner::RobotDescription> robots) {
  const bool all_drive = std::ranges::all_of(
      robots, [](const planner::RobotDescription& robot) { return robot.robot.travel.drives(); });
  return all_drive ? "smaller robots, or those that fly," : "smaller robots";
}

std::string narrow_openings(const sim::Unseen& unseen, std::span<const planner::RobotDescription> robots) {
  std::string text;
  for (std::size_t r = 0; r < unseen.robots.size(); ++r)
    if (const auto& [by, part, low] = unseen.robots[r]; by)
      text += (text.empty() ? "" : ", ") + percent(part) + " behind openings that are " + rounded(*by) +
              " m too narrow for " + robots[r].robot.name;
  return text;
}

bool ends_badly(const RunSums& sums, const RunEnd& end) {
  const auto is = [&](planner::ExplorationEnd reason) { return end.word == planner::name_of(reason); };
  return is(planner::ExplorationEnd::kCutOff) ||
         (sums.observable < kDone &&
          (is(planner::ExplorationEnd::kLowGain) || is(planner::ExplorationEnd::kNothingToDo)));
}

std::vector<std::string> run_warnings(const ExploreSetup& setup, const RunSums& sums,
                                      const RunNumbers& numbers, const std::optional<RunEnd>& end,
                                      const std::optional<sim::Unseen>& unseen) {
  std::vector<std::string> warnings;
  if (end && end->word == planner::name_of(planner::ExplorationEnd::kCutOff))
    warnings.push_back(end->text + by_stray_returns(setup));
  else if (end && ends_badly(sums, *end))
    warnings.push_back("the run has ended with " + percent(sums.observable) +
                       " of the observable space mapped" +
                       (all_failed(numbers) ? ": all robots have failed"
                        : unseen            ? why_unseen(*unseen)
                                            : "") +
                       why_they_rest(setup, numbers) +
                       (all_failed(numbers) ? "" : by_holes(setup) + by_stray_returns(setup)));
  if (unseen && unseen->narrow >= sim::kMuchUnseen && !all_failed(numbers))
    warnings.push_back(why_narrow(*unseen, setup));
  for (std::size_t r = 0; r < numbers.robots.size(); ++r) {
    const RobotNumbers& robot = numbers.robots[r];
    const std::string name = "the robot '" + setup.head.robots[r].robot.name + "'";
    if (const auto far = far_start(setup, r)) warnings.push_back(*far);
    if (robot.failed)
      warnings.push_back(name + " failed after " + rounded(*robot.failed) + " s, as --fail says" +
                         (robot.takes_part ? ", and joined the others again, as --join says" : ""));
    else if (!robot.takes_part)
      warnings.push_back(name + " had not joined the others by the end, as --join says");
  }
  const double planning = sums.planning_percentile(0.99), latency = setup.exploration.latency;
  if (!setup.lockstep && planning > latency && sums.planning.size() >= kEnoughPlannings)
    warnings.push_back(late_planning(planning, latency));
  return warnings;
}

}  // namespace frontlux::app
