#pragma once

#include <frontlux/planner/goal_selection.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace frontlux::planner {

/// How the robots of a team find their goals: by tours for all of them together, or each by a rule.
enum class GoalSearch : std::uint8_t { kTour, kRender, kCluster, kNearest };
/// As options and files call them.
inline constexpr std::array<std::pair<std::string_view, GoalSearch>, 4> kGoalSearchNames = {
    {{"tour", GoalSearch::kTour},
     {"render", GoalSearch::kRender},
     {"cluster", GoalSearch::kCluster},
     {"nearest", GoalSearch::kNearest}}};

[[nodiscard]] constexpr std::string_view name_of(GoalSearch search) {
  return kGoalSearchNames[static_cast<std::size_t>(search)].first;
}

/// The search with this name; none if there is no such search.
[[nodiscard]] constexpr std::optional<GoalSearch> goal_search(std::string_view name) {
  for (const auto& [known, search] : kGoalSearchNames)
    if (known == name) return search;
  return std::nullopt;
}

/// What `GoalOptions` have for it; nothing for tours.
[[nodiscard]] constexpr std::optional<GoalRule> rule_of(GoalSearch search) {
  switch (search) {
    case GoalSearch::kTour:
      break;
    case GoalSearch::kRender:
      return GoalRule::kViewQuality;
    case GoalSearch::kCluster:
      return GoalRule::kClusters;
    case GoalSearch::kNearest:
      return GoalRule::kNearest;
  }
  return std::nullopt;
}

}  // namespace frontlux::planner
