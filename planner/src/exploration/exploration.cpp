#include "exploration/exploration_state.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

using State = detail::ExplorationState;

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("exploration: " + what); }

}  // namespace

Exploration::Exploration(ExplorationOptions options, Mapping mapping) {
  options.check();
  if (options.tours) refuse("tours are for robots in motion, see ContinuousExploration");
  state_ = std::make_unique<State>(std::move(options), std::move(mapping));
}
Exploration::~Exploration() = default;
Exploration::Exploration(Exploration&&) noexcept = default;
Exploration& Exploration::operator=(Exploration&&) noexcept = default;

ExplorationStep Exploration::begin(std::span<const ExplorationStart> starts, const Drive& drive) {
  State& state = *state_;
  if (state.selection) refuse("it has begun already");
  if (starts.size() != state.size())
    refuse(std::to_string(starts.size()) + " starts for " + std::to_string(state.size()) + " robots");
  std::vector<Pose> poses;
  for (const ExplorationStart& start : starts) poses.push_back(start.pose);
  check_finite(poses);

  state.start_from(starts);
  const VoxelGrid given = state.mapping.grid();
  ExplorationStep step = state.new_step();
  state.look_around(starts, drive, step);  // Alg. 1, lines 1 and 2
  state.advance_clock(step);
  state.update_frontiers(step);
  State::tell_of_given_map(given, step);
  state.number = 1;
  return step;
}

ExplorationStep Exploration::step(const Drive& drive) {
  State& state = *state_;
  if (!state.selection) refuse("a step before its beginning");

  ExplorationStep step = state.new_step();
  state.update_views(step);
  state.select_goals(step);  // Alg. 1, lines 4 and 5
  state.count_frontiers(step);
  state.plan_paths(step);                                 // Alg. 1, line 6
  const State::Gains gains = state.optimize_paths(step);  // Alg. 1, line 7
  state.execute_paths(gains, drive, step);                // Alg. 1, lines 8 to 11
  state.advance_clock(step);
  state.update_frontiers(step);
  state.end_step(step);  // Alg. 1, line 3
  return step;
}

bool Exploration::repeat(const ExplorationStep& recorded, const Drive& drive) {
  State& state = *state_;
  if (!state.selection) refuse("a step before its beginning");
  if (recorded.number != state.number || recorded.robots.size() != state.size()) return false;

  ExplorationStep step = state.new_step();
  state.update_views(step);
  state.select_goals(step);  // how many rays the next selection casts depends on this one
  if (!state.execute_again(recorded, drive, step)) return false;
  state.advance_clock(step);
  state.update_frontiers(step);
  state.end_step(step);
  return true;
}

// Alg. 1, line 3.
std::optional<ExplorationEnd> Exploration::end() const {
  const State& state = *state_;
  if (state.nothing_to_do || state.low_gain_steps >= state.options.low_gain_steps) {
    for (std::size_t r = 0; r < state.last_goals.size(); ++r)
      if (state.is_cut_off(r, state.last_goals[r])) return ExplorationEnd::kCutOff;
    return state.nothing_to_do ? ExplorationEnd::kNothingToDo : ExplorationEnd::kLowGain;
  }
  if (state.number > static_cast<std::uint64_t>(state.options.max_steps)) return ExplorationEnd::kStepLimit;
  return std::nullopt;
}

const ExplorationOptions& Exploration::options() const { return state_->options; }
const Mapping& Exploration::mapping() const { return state_->mapping; }
std::span<const Pose> Exploration::poses() const { return state_->poses; }
std::span<const VoxelKey> Exploration::frontiers() const { return state_->frontiers.keys(); }

}  // namespace frontlux::planner
