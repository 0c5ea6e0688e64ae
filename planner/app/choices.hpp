#pragma once

#include <frontlux/caster_kind.hpp>
#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/goal_search.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <array>
#include <string_view>
#include <utility>

namespace frontlux::app {

/// A value and its name in options, files and messages.
template <class Value>
struct Choice {
  std::string_view name;
  Value value;
};

/// Of a table of names and values.
template <class Value, std::size_t kSize>
constexpr std::array<Choice<Value>, kSize> choices_of(
    const std::array<std::pair<std::string_view, Value>, kSize>& names) {
  std::array<Choice<Value>, kSize> choices{};
  for (std::size_t i = 0; i < kSize; ++i) choices[i] = {names[i].first, names[i].second};
  return choices;
}

/// The values that an option of this type takes.
template <class Value>
inline constexpr std::array<Choice<Value>, 0> kChoices{};

template <>
inline constexpr std::array<Choice<bool>, 2> kChoices<bool>{{{"on", true}, {"off", false}}};

template <>
inline constexpr std::array<Choice<UnknownPolicy>, 2> kChoices<UnknownPolicy>{
    {{"block", UnknownPolicy::kBlock}, {"pass", UnknownPolicy::kPass}}};

template <>
inline constexpr std::array<Choice<ViewQualityOptions::Renderer>, 2> kChoices<ViewQualityOptions::Renderer>{
    {{"exact", ViewQualityOptions::Renderer::kExact}, {"rays", ViewQualityOptions::Renderer::kRays}}};

template <>
inline constexpr std::array<Choice<sim::UpAxis>, 3> kChoices<sim::UpAxis>{
    {{"x", sim::UpAxis::kX}, {"y", sim::UpAxis::kY}, {"z", sim::UpAxis::kZ}}};

template <>
inline constexpr std::array<Choice<planner::Method>, 2> kChoices<planner::Method>{
    {{"default", planner::Method::kDefault}, {"paper", planner::Method::kPaper}}};

template <>
inline constexpr auto kChoices<planner::GoalSearch> = choices_of(planner::kGoalSearchNames);

template <>
inline constexpr auto kChoices<planner::PathSearch> = choices_of(planner::kPathSearchNames);

template <>
inline constexpr auto kChoices<CasterKind> = choices_of(kCasterNames);

template <>
inline constexpr auto kChoices<planner::TourPart> = choices_of(planner::kTourPartNames);

template <>
inline constexpr auto kChoices<planner::SensorModel> = choices_of(planner::kSensorModelNames);

/// Has a table of choices.
template <class Value>
concept Chosen = !kChoices<Value>.empty();

template <Chosen Value>
[[nodiscard]] constexpr std::string_view choice_name(Value value) {
  for (const Choice<Value>& choice : kChoices<Value>)
    if (choice.value == value) return choice.name;
  return {};
}

}  // namespace frontlux::app
