#include <frontlux/planner/exploration.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("exploration: " + what); }

}  // namespace

void ExplorationOptions::check() const {
  if (team.empty()) refuse("the team has no robot");
  if (caster > CasterKind::kOctomap) refuse("caster is none of the values of CasterKind");
  if (tours_without > TourPart::kTours) refuse("tours_without is none of the values of TourPart");
  if (tours_without != TourPart::kNone && !tours) refuse("tours_without is for tours, which are off");
  if (!(epsilon >= 0.0 && std::isfinite(epsilon)))
    refuse("epsilon is " + std::to_string(epsilon) + ", but has to be finite and 0 or more");
  for (const auto& [name, value] :
       {std::pair{"latency", latency}, {"period", period}, {"commitment", commitment}})
    if (!(value > 0.0 && std::isfinite(value)))
      refuse(std::string(name) + " is " + std::to_string(value) + " s, but has to be finite and positive");
  const auto at_least = [](const char* name, int value, int low) {
    if (value < low)
      refuse(std::string(name) + " is " + std::to_string(value) + ", but has to be at least " +
             std::to_string(low));
  };
  at_least("low_gain_steps", low_gain_steps, 1);
  at_least("max_steps", max_steps, 0);
  at_least("max_visits", max_visits, 1);
  at_least("min_cluster_size", min_cluster_size, 1);
  path.check();
  optimizer.check();
  for (const TeamMember& member : team) {
    member.robot.check();
    member.options.check();
  }
}

ExplorationOptions exploration_options(Method method) {
  ExplorationOptions options;
  if (method == Method::kPaper) {
    options.optimizer = paper_optimizer_options();
    options.epsilon = 1.0;  // the paper gives none: the method ends when it expects to see nothing
  } else {
    options.path.search = PathSearch::kCorridor;
  }
  return options;
}

ExplorationOptions motion_options(Method method) {
  ExplorationOptions options = exploration_options(method);
  options.max_visits = 1;
  options.max_steps = std::numeric_limits<int>::max();
  return options;
}

ExplorationOptions tour_options(double resolution) {
  // [m2] Ten frontiers of 0.1 m are no reason to go anywhere, and of 1 m they are more than many places show.
  constexpr double kLeast = 0.3, kMost = 0.9;
  ExplorationOptions options = motion_options();
  options.tours = true;
  const double face = resolution * resolution;
  options.epsilon =
      std::clamp(options.epsilon, std::round(kLeast / face), std::max(1.0, std::round(kMost / face)));
  return options;
}

double ExplorationStep::planning_seconds() const {
  static_assert(static_cast<std::size_t>(Phase::kMoving) + 1 == kPhases);
  return std::accumulate(seconds.begin(), seconds.end() - 1, 0.0);
}

std::string_view name_of(Phase phase) {
  constexpr std::array<std::string_view, kPhases> kNames = {"frontiers", "caster",       "goals",
                                                            "paths",     "optimization", "moving"};
  return kNames.at(static_cast<std::size_t>(phase));
}

std::string_view name_of(ExplorationEnd end) {
  constexpr std::array<std::string_view, 4> kNames = {"low_gain", "nothing_to_do", "step_limit", "cut_off"};
  return kNames.at(static_cast<std::size_t>(end));
}

std::string describe(ExplorationEnd end, const ExplorationOptions& options, std::string_view steps) {
  if (end == ExplorationEnd::kNothingToDo)
    return options.tours ? "no robot gets to where it would see a cluster of frontiers worth a stop"
                         : "no robot gets to where it would see a frontier";
  if (end == ExplorationEnd::kStepLimit)
    return "the limit of " + std::to_string(options.max_steps) + " " + std::string(steps) + " is reached";
  if (end == ExplorationEnd::kCutOff)
    return "a robot is where it cannot leave, and there is more to see from where it came from";
  std::ostringstream text;  // 10 without zeros behind it
  text << "expected gain stayed below " << options.epsilon << " frontiers " << options.low_gain_steps
       << " times in a row";
  return text.str();
}

}  // namespace frontlux::planner
