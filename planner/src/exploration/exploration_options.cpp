#include <frontlux/planner/exploration.hpp>

#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("exploration: " + what); }

}  // namespace

void ExplorationOptions::check() const {
  if (team.empty()) refuse("the team has no robot");
  if (caster > CasterKind::kOctomap) refuse("caster is none of the values of CasterKind");
  if (!(epsilon >= 0.0 && std::isfinite(epsilon)))
    refuse("epsilon is " + std::to_string(epsilon) + ", but has to be finite and 0 or more");
  const auto at_least = [](const char* name, int value, int low) {
    if (value < low)
      refuse(std::string(name) + " is " + std::to_string(value) + ", but has to be at least " +
             std::to_string(low));
  };
  at_least("quiet_steps", quiet_steps, 1);
  at_least("max_steps", max_steps, 0);
  at_least("max_visits", max_visits, 1);
  at_least("min_cluster_size", min_cluster_size, 1);
  optimizer.check();
}

ExplorationOptions exploration_options(Method method) {
  ExplorationOptions options;
  if (method == Method::kPaper)
    options.optimizer = paper_path_options();
  else
    options.path.search = PathSearch::kCorridor;
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
  switch (end) {
    case ExplorationEnd::kQuiet:
      return "quiet";
    case ExplorationEnd::kNothingToDo:
      return "nothing_to_do";
    case ExplorationEnd::kStepLimit:
      return "step_limit";
  }
  return "unknown";
}

std::string_view describe(ExplorationEnd end) {
  switch (end) {
    case ExplorationEnd::kQuiet:
      return "several steps in a row promised next to nothing new";
    case ExplorationEnd::kNothingToDo:
      return "no robot can see a frontier from anywhere it can go";
    case ExplorationEnd::kStepLimit:
      return "the limit on the number of steps is reached";
  }
  return "unknown";
}

}  // namespace frontlux::planner
